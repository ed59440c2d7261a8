#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "ourengine/linear/kernels_scalar.hpp"

namespace ourengine::scalar {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// The block of rows `row` and columns `column` += left * scaled^T, 6 components each.
void add_outer(const FrontWork& work, int row, int column, const double* left,
               const double* scaled) {
  for (std::size_t c = 0; c < 6; ++c) {
    for (std::size_t r = 0; r < 6; ++r)
      *work.entry(6 * at(row) + r, 6 * at(column) + c) += left[r] * scaled[c];
  }
}

// J^T D J of a pair, with the rows of J towards `left` and towards `right` (0: a, 8: b).
void add_pair(const SystemView& s, const double* d, const ContactPair& pair, std::size_t left,
              std::size_t right, const FrontWork& work, int row, int column) {
  constexpr int kSymmetric[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  for (int i = pair.begin; i < pair.end; ++i) {
    const double* rows = s.rows + 16 * at(i) * at(s.components);
    for (int k = 0; k < s.components; ++k) {
      double scaled[6] = {};
      for (int l = 0; l < s.components; ++l) {
        const double weight = d[at(kSymmetric[k][l]) * at(s.stride) + at(i)];
        for (std::size_t c = 0; c < 6; ++c) scaled[c] += weight * rows[16 * at(l) + right + c];
      }
      add_outer(work, row, column, rows + 16 * at(k) + left, scaled);
    }
  }
}

void add_system(const SystemView& s, const FrontalView& view, const double* d, int index,
                const FrontWork& work) {
  for (int b = 0; b < work.front.columns; ++b) {
    const int body = work.front.first + b;
    const double* mass = s.mass + at(kBlockSize) * at(body);
    for (std::size_t c = 0; c < 6; ++c) {
      for (std::size_t r = 0; r < 6; ++r)
        *work.entry(6 * at(b) + r, 6 * at(b) + c) += mass[8 * c + r];
    }
    for (int q = view.side_begin[body]; q < view.side_begin[body + 1]; ++q) {
      const std::size_t side = view.sides[q].of_b ? 8 : 0;
      add_pair(s, d, s.pairs[view.sides[q].pair], side, side, work, b, b);
    }
  }
  for (int p = view.pair_begin[index]; p < view.pair_begin[index + 1]; ++p) {
    const FrontPair& place = view.pairs[p];
    const std::size_t below = place.a_below ? 0 : 8;
    add_pair(s, d, s.pairs[place.pair], below, 8 - below, work, place.row, place.column);
  }
}

// Scalar row of the parent for each scalar row of a front below its pivots.
template <class Use>
void for_rows_in_parent(const FrontPattern& fronts, const Front& front, const Use& use) {
  for (int q = front.run_begin; q < front.run_end; ++q) {
    const FrontRun& run = fronts.run[at(q)];
    for (std::size_t r = 0; r < 6 * at(run.length); ++r)
      use(6 * at(run.from) + r, 6 * at(run.to) + r);
  }
}

void add_child(const FrontPattern& fronts, const FrontWork& child, const FrontWork& work) {
  for_rows_in_parent(fronts, child.front, [&](std::size_t c, std::size_t to_c) {
    for_rows_in_parent(fronts, child.front, [&](std::size_t r, std::size_t to_r) {
      if (r >= c) *work.entry(to_r, to_c) += *child.entry(r, c);
    });
  });
}

// The lower factor of the 6x6 block at `pivot`, and its inverse in its place, upper part zero.
bool invert_pivot(const FrontWork& work, std::size_t pivot) {
  bool positive = true;
  double l[6][6] = {}, inverse[6][6] = {};
  for (std::size_t a = 0; a < 6; ++a) {
    double square = *work.entry(pivot + a, pivot + a);
    for (std::size_t k = 0; k < a; ++k) square -= l[a][k] * l[a][k];
    if (!(square > 0.0)) {
      positive = false;
      square = std::numeric_limits<double>::max();
    }
    l[a][a] = std::sqrt(square);
    for (std::size_t b = a + 1; b < 6; ++b) {
      double sum = *work.entry(pivot + b, pivot + a);
      for (std::size_t k = 0; k < a; ++k) sum -= l[b][k] * l[a][k];
      l[b][a] = sum / l[a][a];
    }
  }
  for (std::size_t c = 0; c < 6; ++c) {
    for (std::size_t r = c; r < 6; ++r) {
      double sum = r == c ? 1.0 : 0.0;
      for (std::size_t k = c; k < r; ++k) sum -= l[r][k] * inverse[k][c];
      inverse[r][c] = sum / l[r][r];
    }
  }
  for (std::size_t c = 0; c < 6; ++c) {
    for (std::size_t r = 0; r < 6; ++r) *work.entry(pivot + r, pivot + c) = inverse[r][c];
  }
  return positive;
}

// Right-looking: six columns, then what they subtract from all later ones.
bool eliminate(const FrontWork& work) {
  bool positive = true;
  for (std::size_t pivot = 0; pivot < work.pivots(); pivot += 6) {
    positive = invert_pivot(work, pivot) && positive;
    for (std::size_t r = pivot + 6; r < work.rows(); ++r) {
      double row[6] = {};
      for (std::size_t c = 0; c < 6; ++c) {
        for (std::size_t k = 0; k <= c; ++k)
          row[c] += *work.entry(r, pivot + k) * *work.entry(pivot + c, pivot + k);
      }
      for (std::size_t c = 0; c < 6; ++c) *work.entry(r, pivot + c) = row[c];
    }
    for (std::size_t c = pivot + 6; c < work.rows(); ++c) {
      for (std::size_t r = c; r < work.rows(); ++r) {
        for (std::size_t k = pivot; k < pivot + 6; ++k)
          *work.entry(r, c) -= *work.entry(r, k) * *work.entry(c, k);
      }
    }
  }
  return positive;
}

}  // namespace

bool factor_fronts(const SystemView& system, const FrontalView& view, const double* d,
                   FrontTask task, const FrontStores& stores) {
  bool positive = true;
  const FrontPattern& fronts = *view.fronts;
  for (int s = task.begin; s < task.end; ++s) {
    const FrontWork work = work_on(fronts.front[at(s)], stores);
    for (std::size_t c = 0; c < work.rows(); ++c) {
      for (std::size_t r = c; r < work.rows(); ++r) *work.entry(r, c) = 0.0;
    }
    add_system(system, view, d, s, work);
    for (int c = work.front.child_begin; c < work.front.child_end; ++c) {
      const Front& child = fronts.front[at(fronts.child[at(c)])];
      add_child(fronts, work_on(child, stores), work);
    }
    positive = eliminate(work) && positive;
  }
  return positive;
}

void solve_fronts_forward(const FrontalView& view, FrontTask task, const double* panels,
                          double* vectors, double* x) {
  const FrontPattern& fronts = *view.fronts;
  for (int s = task.begin; s < task.end; ++s) {
    const Front& front = fronts.front[at(s)];
    double* z = vectors + front.vector;
    double* own = x + at(kBodyStride) * at(front.first);
    std::fill_n(z, front.lead, 0.0);
    for (std::size_t i = 0; i < 6 * at(front.columns); ++i)
      z[i] = own[at(kBodyStride) * (i / 6) + i % 6];
    for (int c = front.child_begin; c < front.child_end; ++c) {
      const Front& child = fronts.front[at(fronts.child[at(c)])];
      for_rows_in_parent(fronts, child, [&](std::size_t r, std::size_t to) {
        z[to] += vectors[child.vector + r];
      });
    }
    for (std::size_t pivot = 0; pivot < 6 * at(front.columns); pivot += 6) {
      const double* columns = panels + front.panel + pivot * front.lead;
      double* y = own + at(kBodyStride) * (pivot / 6);
      for (std::size_t r = 0; r < 6; ++r) {
        y[r] = 0.0;
        for (std::size_t k = 0; k <= r; ++k)
          y[r] += columns[k * front.lead + pivot + r] * z[pivot + k];
      }
      for (std::size_t r = pivot + 6; r < 6 * at(front.rows); ++r) {
        for (std::size_t k = 0; k < 6; ++k) z[r] -= columns[k * front.lead + r] * y[k];
      }
    }
  }
}

void solve_fronts_backward(const FrontalView& view, FrontTask task, const double* panels,
                           double* vectors, double* x) {
  const FrontPattern& fronts = *view.fronts;
  for (int s = task.end - 1; s >= task.begin; --s) {
    const Front& front = fronts.front[at(s)];
    double* z = vectors + front.vector;
    for (int r = 0; r < front.rows; ++r)
      std::copy_n(x + at(kBodyStride) * at(fronts.row[at(front.row_begin + r)]), 6, z + 6 * r);
    for (std::size_t j = at(front.columns); j-- > 0;) {
      const double* columns = panels + front.panel + 6 * j * front.lead;
      double y[6];
      for (std::size_t c = 0; c < 6; ++c) {
        y[c] = z[6 * j + c];
        for (std::size_t r = 6 * j + 6; r < 6 * at(front.rows); ++r)
          y[c] -= columns[c * front.lead + r] * z[r];
      }
      for (std::size_t c = 0; c < 6; ++c) {
        z[6 * j + c] = 0.0;
        for (std::size_t r = c; r < 6; ++r)
          z[6 * j + c] += columns[c * front.lead + 6 * j + r] * y[r];
      }
      std::copy_n(z + 6 * j, 6, x + at(kBodyStride) * (at(front.first) + j));
    }
  }
}

}  // namespace ourengine::scalar
