#include "ourengine/collision/broad_phase.hpp"

#include <algorithm>
#include <cmath>

namespace ourengine {
namespace {

// A box that spans more cells than this along an axis is compared with everything instead.
constexpr double k_cells_per_body = 4.0;
// Cells are counted up to here from the origin; what lies further out is compared with everything.
constexpr double k_furthest_cell = 1e15;
// A rebuild costs as much per body as some 100 comparisons of two boxes, whatever the number of
// bodies: up to so many escaped bodies it is cheaper to compare each of them with everything.
constexpr std::size_t k_few_escaped = 64;

struct Entry {
  std::uint64_t cell;
  int body;
  auto operator<=>(const Entry&) const = default;
};

struct Cell {
  std::int64_t x, y, z;
  // 21 bits per axis; far cells may share a key, which costs a comparison and never a pair.
  std::uint64_t key() const {
    constexpr std::uint64_t mask = (std::uint64_t{1} << 21) - 1;
    return (static_cast<std::uint64_t>(x) & mask) << 42 |
           (static_cast<std::uint64_t>(y) & mask) << 21 | (static_cast<std::uint64_t>(z) & mask);
  }
};

// Whether the grid has cells for the box: its corners are numbers, neither large nor far away.
bool fits_the_grid(const Aabb& box, double size) {
  return size > 0.0 && ((box.upper_m - box.lower_m).array() <= k_cells_per_body * size).all() &&
         (box.lower_m.array().abs() <= k_furthest_cell * size).all() &&
         (box.upper_m.array().abs() <= k_furthest_cell * size).all();
}

Cell cell_of(const Eigen::Vector3d& point, double size) {
  const auto index = [&](double c) { return static_cast<std::int64_t>(std::floor(c / size)); };
  return {index(point.x()), index(point.y()), index(point.z())};
}

}  // namespace

BroadPhase::BroadPhase(std::vector<bool> fixed, double slack_m)
    : fixed_(std::move(fixed)), slack_m_(slack_m) {}

void BroadPhase::clear() {
  fat_.clear();
  pairs_.clear();
}

bool BroadPhase::is_pair(int i, int j) const {
  const auto a = static_cast<std::size_t>(i);
  const auto b = static_cast<std::size_t>(j);
  return !(fixed_[a] && fixed_[b]) && fat_[a].overlaps(fat_[b]);
}

void BroadPhase::update(std::span<const Aabb> boxes) {
  const Eigen::Vector3d slack = Eigen::Vector3d::Constant(slack_m_);
  const auto fatten = [&](const Aabb& box) {
    return Aabb{box.lower_m - slack, box.upper_m + slack};
  };
  if (fat_.size() != boxes.size()) {
    fat_.resize(boxes.size());
    std::ranges::transform(boxes, fat_.begin(), fatten);
    rebuild();
    return;
  }
  std::vector<int> escaped;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (fat_[i].contains(boxes[i])) continue;
    fat_[i] = fatten(boxes[i]);
    escaped.push_back(static_cast<int>(i));
  }
  if (escaped.empty()) return;
  if (escaped.size() > k_few_escaped) {
    rebuild();
  } else {
    replace(escaped);
  }
}

void BroadPhase::replace(std::span<const int> escaped) {
  std::vector<bool> moved(fat_.size(), false);
  for (const int i : escaped) moved[static_cast<std::size_t>(i)] = true;
  std::erase_if(pairs_, [&](const BodyPair& pair) {
    return moved[static_cast<std::size_t>(pair.first)] ||
           moved[static_cast<std::size_t>(pair.second)];
  });
  const auto kept = static_cast<std::ptrdiff_t>(pairs_.size());
  for (const int i : escaped) {
    for (int j = 0; j < static_cast<int>(fat_.size()); ++j) {
      if (j == i || (moved[static_cast<std::size_t>(j)] && j < i)) continue;
      if (is_pair(i, j)) pairs_.push_back({std::min(i, j), std::max(i, j)});
    }
  }
  std::sort(pairs_.begin() + kept, pairs_.end());
  std::inplace_merge(pairs_.begin(), pairs_.begin() + kept, pairs_.end());
}

void BroadPhase::rebuild() {
  pairs_.clear();
  std::vector<double> extents;
  for (std::size_t i = 0; i < fat_.size(); ++i) {
    const Eigen::Vector3d extent = fat_[i].upper_m - fat_[i].lower_m;
    if (!fixed_[i] && extent.allFinite()) extents.push_back(extent.maxCoeff());
  }
  double size = 0.0;  // without one the grid has no cells
  if (!extents.empty()) {
    const auto middle = extents.begin() + static_cast<std::ptrdiff_t>(extents.size() / 2);
    std::ranges::nth_element(extents, middle);
    size = *middle;
  }

  std::vector<Entry> entries;
  std::vector<int> large;
  std::vector<bool> is_large(fat_.size(), false);
  for (int i = 0; i < static_cast<int>(fat_.size()); ++i) {
    const Aabb& box = fat_[static_cast<std::size_t>(i)];
    if (!fits_the_grid(box, size)) {
      large.push_back(i);
      is_large[static_cast<std::size_t>(i)] = true;
      continue;
    }
    const Cell low = cell_of(box.lower_m, size);
    const Cell high = cell_of(box.upper_m, size);
    for (auto x = low.x; x <= high.x; ++x)
      for (auto y = low.y; y <= high.y; ++y)
        for (auto z = low.z; z <= high.z; ++z) entries.push_back({Cell{x, y, z}.key(), i});
  }
  std::ranges::sort(entries);
  for (std::size_t begin = 0; begin < entries.size();) {
    std::size_t end = begin;
    while (end < entries.size() && entries[end].cell == entries[begin].cell) ++end;
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t q = p + 1; q < end; ++q) {
        const int i = entries[p].body;
        const int j = entries[q].body;
        if (i != j && is_pair(i, j)) pairs_.push_back({i, j});
      }
    begin = end;
  }
  for (const int i : large) {
    for (int j = 0; j < static_cast<int>(fat_.size()); ++j) {
      if (j == i || (j < i && is_large[static_cast<std::size_t>(j)])) continue;
      if (is_pair(i, j)) pairs_.push_back({std::min(i, j), std::max(i, j)});
    }
  }
  std::ranges::sort(pairs_);
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
}

}  // namespace ourengine
