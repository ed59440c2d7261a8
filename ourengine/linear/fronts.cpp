#include "ourengine/linear/fronts.hpp"

#include <algorithm>
#include <map>

namespace ourengine {
namespace {

// Zeros that a front may store, over all its blocks: 0.05 to 0.2 cost the same on walls.

constexpr double kZeros = 0.1;

// Subtrees with no more than this part of the work are not divided further: few enough to leave
// little of the work to the fronts above them, many enough to share.
constexpr double kSubtree = 0.2;
// Factorisations with less work are done in one piece: a millisecond or so.
constexpr double kLeastFlops = 2e7;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::size_t round_up(std::size_t n) { return (n + 7) / 8 * 8; }

// First columns and numbers of columns: a column joins the front of its child that comes just
// before it as long as few zeros have to be stored for that.
std::vector<Front> join_columns(const std::vector<std::vector<int>>& below) {
  std::vector<Front> fronts;
  const int n = static_cast<int>(below.size());
  double filled = 0.0;  // blocks of the factor among those of the current front
  for (int j = 0; j < n; ++j) {
    const double own = static_cast<double>(below[at(j)].size()) + 1.0;
    if (j > 0 && !below[at(j - 1)].empty() && below[at(j - 1)].front() == j) {
      Front& last = fronts.back();
      const double columns = last.columns + 1.0;
      const double stored = columns * (columns - 1.0) / 2.0 + columns * own;
      if (stored - (filled + own) <= kZeros * stored) {
        ++last.columns;
        filled += own;
        continue;
      }
    }
    fronts.push_back({});
    fronts.back().first = j;
    fronts.back().columns = 1;
    filled = own;
  }
  return fronts;
}

// Places of memory given out and taken back in a fixed order.
class Arena {
 public:
  std::size_t take(std::size_t size) {
    for (auto place = free_.begin(); place != free_.end(); ++place) {
      if (place->second < size) continue;
      const auto [begin, length] = *place;
      free_.erase(place);
      if (length > size) free_[begin + size] = length - size;
      return begin;
    }
    const std::size_t begin = end_;
    end_ += size;
    return begin;
  }
  void give_back(std::size_t begin, std::size_t size) {
    auto place = free_.emplace(begin, size).first;
    const auto next = std::next(place);
    if (next != free_.end() && begin + size == next->first) {
      place->second += next->second;
      free_.erase(next);
    }
    if (place == free_.begin()) return;
    const auto before = std::prev(place);
    if (before->first + before->second == begin) {
      before->second += place->second;
      free_.erase(place);
    }
  }
  std::size_t end() const { return end_; }

 private:
  std::map<std::size_t, std::size_t> free_;
  std::size_t end_ = 0;
};

class Builder {
 public:
  explicit Builder(const std::vector<std::vector<int>>& below) : below_(below) {}

  FrontPattern build() {
    out_.front = join_columns(below_);
    list_rows();
    link();
    count_flops();
    divide();
    lay_out();
    return std::move(out_);
  }

 private:
  void list_rows() {
    out_.front_of_column.resize(below_.size());
    for (std::size_t s = 0; s < out_.front.size(); ++s) {
      Front& front = out_.front[s];
      front.row_begin = static_cast<int>(out_.row.size());
      for (int c = 0; c < front.columns; ++c) {
        out_.row.push_back(front.first + c);
        out_.front_of_column[at(front.first + c)] = static_cast<int>(s);
      }
      const auto& rest = below_[at(front.first + front.columns - 1)];
      out_.row.insert(out_.row.end(), rest.begin(), rest.end());
      front.rows = front.columns + static_cast<int>(rest.size());
    }
  }

  int parent(const Front& front) const {
    if (front.rows == front.columns) return -1;
    return out_.front_of_column[at(out_.row[at(front.row_begin + front.columns)])];
  }

  void link() {
    std::vector<std::vector<int>> children(out_.front.size());
    for (std::size_t s = 0; s < out_.front.size(); ++s) {
      Front& front = out_.front[s];
      front.run_begin = front.run_end = static_cast<int>(out_.run.size());
      const int above = parent(front);
      if (above < 0) continue;
      children[at(above)].push_back(static_cast<int>(s));
      add_runs(front, out_.front[at(above)]);
    }
    for (std::size_t s = 0; s < out_.front.size(); ++s) {
      out_.front[s].child_begin = static_cast<int>(out_.child.size());
      out_.child.insert(out_.child.end(), children[s].begin(), children[s].end());
      out_.front[s].child_end = static_cast<int>(out_.child.size());
    }
  }

  void add_runs(Front& front, const Front& above) {
    int to = 0;
    for (int from = front.columns; from < front.rows; ++from, ++to) {
      while (out_.row[at(above.row_begin + to)] != out_.row[at(front.row_begin + from)]) ++to;
      const bool joined =
          front.run_end > front.run_begin && out_.run.back().to + out_.run.back().length == to;
      if (joined) {
        ++out_.run.back().length;
      } else {
        out_.run.push_back({from, to, 1});
        ++front.run_end;
      }
    }
  }

  static std::size_t update_size(const Front& front) {
    return front.update_lead() * 6 * at(front.rows - front.columns) + 8;
  }

  void count_flops() {
    flops_.assign(out_.front.size(), 0.0);
    for (std::size_t s = 0; s < out_.front.size(); ++s) {
      const Front& front = out_.front[s];
      const double k = 6.0 * front.columns, m = 6.0 * front.rows;
      const double own = k * (m - k) * (m - k) + k * k * (m - k) + k * k * k / 3.0;
      out_.flops += own;
      flops_[s] += own;
      const int above = parent(front);
      if (above >= 0) flops_[at(above)] += flops_[s];  // of the subtree
    }
  }

  // The largest subtrees with no more than a part of the work; they are consecutive fronts.
  void divide() {
    const int n = static_cast<int>(out_.front.size());
    const double most = out_.flops < kLeastFlops ? 0.0 : kSubtree * out_.flops;
    int rest_end = n;
    for (int s = n - 1; s >= 0;) {
      if (flops_[at(s)] > most) {
        --s;
        continue;
      }
      const int begin = first_descendant(s);
      if (s + 1 < rest_end) out_.rest.push_back({s + 1, rest_end});
      out_.subtree.push_back({begin, s + 1});
      s = begin - 1;
      rest_end = begin;
    }
    if (rest_end > 0) out_.rest.push_back({0, rest_end});
    std::reverse(out_.rest.begin(), out_.rest.end());
    std::sort(out_.subtree.begin(), out_.subtree.end(),
              [&](const FrontTask& a, const FrontTask& b) {
                return flops_[at(a.end - 1)] < flops_[at(b.end - 1)];
              });
  }

  int first_descendant(int s) const {
    const Front& front = out_.front[at(s)];
    if (front.child_begin == front.child_end) return s;
    return first_descendant(out_.child[at(front.child_begin)]);
  }

  void lay_out() {
    for (Front& front : out_.front) {
      const std::size_t columns = 6 * at(front.columns);
      front.lead = round_up(6 * at(front.rows));
      front.skip = columns / 8 * 8;
      front.panel = out_.panel_doubles;
      out_.panel_doubles += front.lead * columns + 8;  // vectors may reach beyond the last row
      front.vector = out_.vector_doubles;
      out_.vector_doubles += front.lead;
    }
    // The updates of a subtree are forgotten with it but for that of its last front, and all
    // subtrees come before the rest.
    Arena updates;
    for (const FrontTask& subtree : out_.subtree) {
      Front& last = out_.front[at(subtree.end - 1)];
      last.update = updates.take(update_size(last));
      Arena scratch;
      place(subtree, scratch, true);
      out_.scratch_doubles = std::max(out_.scratch_doubles, round_up(scratch.end()));
    }
    for (const FrontTask& part : out_.rest) place(part, updates, false);
    out_.update_doubles = updates.end();
  }

  void place(const FrontTask& part, Arena& arena, bool subtree) {
    for (int s = part.begin; s < part.end; ++s) {
      Front& front = out_.front[at(s)];
      front.in_scratch = subtree && s + 1 < part.end;
      if (front.in_scratch || !subtree) front.update = arena.take(update_size(front));
      for (int c = front.child_begin; c < front.child_end; ++c) {
        const Front& child = out_.front[at(out_.child[at(c)])];
        arena.give_back(child.update, update_size(child));
      }
    }
  }

  const std::vector<std::vector<int>>& below_;
  FrontPattern out_;
  std::vector<double> flops_;  // of the subtree of each front
};

}  // namespace

FrontPattern make_fronts(const std::vector<std::vector<int>>& below) {
  return Builder(below).build();
}

}  // namespace ourengine
