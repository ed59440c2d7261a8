#include "ourengine/linear/kernels_scalar.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace ourengine {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

const double* row_of(const SystemView& s, int contact, int component) {
  return s.rows + 16 * (at(contact) * at(s.components) + at(component));
}

void multiply_j(const SystemView& s, const double* v, bool with_bias, double* w) {
  for (int i = 0; i < s.contacts; ++i) {
    for (int k = 0; k < s.components; ++k) {
      const double* row = row_of(s, i, k);
      double sum = 0.0;
      for (int c = 0; c < 6; ++c) {
        sum += row[c] * v[s.offset_a[i] + c] + row[8 + c] * v[s.offset_b[i] + c];
      }
      if (with_bias) sum += k == 0 ? s.bias[i] : s.tangent_bias[at(k - 1) * at(s.stride) + at(i)];
      w[at(k) * at(s.stride) + at(i)] = sum;
    }
  }
}

void multiply_jt(const SystemView& s, const double* f, double* g) {
  for (int i = 0; i < s.contacts; ++i) {
    for (int k = 0; k < s.components; ++k) {
      const double* row = row_of(s, i, k);
      const double impulse = f[at(k) * at(s.stride) + at(i)];
      for (int c = 0; c < 6; ++c) {
        g[s.offset_a[i] + c] += row[c] * impulse;
        g[s.offset_b[i] + c] += row[8 + c] * impulse;
      }
    }
  }
}

// block += left * scaled^T, 6 components each.
void add_outer(const double* left, const double* scaled, double* block) {
  for (int c = 0; c < 6; ++c) {
    for (int r = 0; r < 6; ++r) block[8 * c + r] += left[r] * scaled[c];
  }
}

void assemble_general(const SystemView& s, const double* d, const PairTarget* targets,
                      const BlockPattern& pattern, double* lower, double* upper) {
  std::fill(lower, lower + at(kBlockSize) * pattern.row.size(), 0.0);
  std::fill(upper, upper + at(kBlockSize) * pattern.row.size(), 0.0);
  for (int j = 0; j < s.bodies; ++j) {
    std::copy_n(s.mass + at(kBlockSize) * at(j), kBlockSize,
                lower + at(kBlockSize) * at(pattern.column_begin[at(j)]));
  }
  for (int p = 0; p < s.pair_count; ++p) {
    const PairTarget& target = targets[p];
    for (int i = s.pairs[p].begin; i < s.pairs[p].end; ++i) {
      for (int k = 0; k < 3; ++k) {
        double scaled[16] = {};
        for (int l = 0; l < 3; ++l) {
          for (int c = 0; c < 16; ++c)
            scaled[c] += d[at(3 * k + l) * at(s.stride) + at(i)] * row_of(s, i, l)[c];
        }
        const double* row = row_of(s, i, k);
        if (target.diagonal_a >= 0)
          add_outer(row, scaled, lower + at(kBlockSize) * at(target.diagonal_a));
        if (target.diagonal_b >= 0)
          add_outer(row + 8, scaled + 8, lower + at(kBlockSize) * at(target.diagonal_b));
        if (target.off_diagonal < 0) continue;
        double* below = lower + at(kBlockSize) * at(target.off_diagonal);
        double* right = upper + at(kBlockSize) * at(target.off_diagonal);
        add_outer(target.a_below ? row : row + 8, target.a_below ? scaled + 8 : scaled, below);
        add_outer(target.a_below ? scaled : scaled + 8, target.a_below ? row + 8 : row, right);
      }
    }
  }
}

// target -= left * right^T
void subtract_product(const double* left, const double* right, double* target) {
  for (int c = 0; c < 6; ++c) {
    for (int k = 0; k < 6; ++k) {
      for (int r = 0; r < 6; ++r) target[8 * c + r] -= left[8 * k + r] * right[8 * k + c];
    }
  }
}

bool factor_general(const BlockPattern& pattern, int* block_of_row, double* lower, double* upper) {
  bool regular = true;
  for (int j = 0; j < pattern.columns; ++j) {
    const int begin = pattern.column_begin[at(j)];
    const int end = pattern.column_begin[at(j + 1)];
    for (int q = begin; q < end; ++q) block_of_row[pattern.row[at(q)]] = q;
    for (int t = pattern.row_begin[at(j)]; t < pattern.row_begin[at(j + 1)]; ++t) {
      const std::size_t first = at(pattern.row_block[at(t)]);
      for (std::size_t q = first; q < at(pattern.column_begin[at(pattern.row_column[at(t)] + 1)]);
           ++q) {
        const std::size_t target = at(kBlockSize) * at(block_of_row[pattern.row[q]]);
        subtract_product(lower + at(kBlockSize) * q, upper + at(kBlockSize) * first,
                         lower + target);
        if (q == first) continue;
        subtract_product(upper + at(kBlockSize) * q, lower + at(kBlockSize) * first,
                         upper + target);
      }
    }
    double* diagonal = lower + at(kBlockSize) * at(begin);
    regular = invert_general_block(diagonal) && regular;
    for (int q = begin + 1; q < end; ++q) {
      double* block = lower + at(kBlockSize) * at(q);
      double product[kBlockSize] = {};
      for (int c = 0; c < 6; ++c) {
        for (int k = 0; k < 6; ++k) {
          for (int r = 0; r < 6; ++r) product[8 * c + r] += block[8 * k + r] * diagonal[8 * c + k];
        }
      }
      std::copy_n(product, kBlockSize, block);
    }
  }
  return regular;
}

void solve_general(const BlockPattern& pattern, const double* lower, const double* upper,
                   double* x) {
  for (int j = 0; j < pattern.columns; ++j) {
    for (int q = pattern.column_begin[at(j)] + 1; q < pattern.column_begin[at(j + 1)]; ++q) {
      for (int c = 0; c < 6; ++c) {
        for (int r = 0; r < 6; ++r) {
          x[kBodyStride * at(pattern.row[at(q)]) + at(r)] -=
              lower[at(kBlockSize) * at(q) + at(8 * c + r)] * x[kBodyStride * at(j) + at(c)];
        }
      }
    }
  }
  for (int j = pattern.columns - 1; j >= 0; --j) {
    double* own = x + kBodyStride * at(j);
    for (int q = pattern.column_begin[at(j)] + 1; q < pattern.column_begin[at(j + 1)]; ++q) {
      for (int c = 0; c < 6; ++c) {
        for (int r = 0; r < 6; ++r) {
          own[c] -= upper[at(kBlockSize) * at(q) + at(8 * c + r)] *
                    x[kBodyStride * at(pattern.row[at(q)]) + at(r)];
        }
      }
    }
    const double* inverse = lower + at(kBlockSize) * at(pattern.column_begin[at(j)]);
    double y[6] = {};
    for (int c = 0; c < 6; ++c) {
      for (int r = 0; r < 6; ++r) y[r] += inverse[8 * c + r] * own[c];
    }
    std::copy_n(y, 6, own);
  }
}

}  // namespace

bool invert_general_block(double* block) {
  double left[6][6], inverse[6][6] = {};
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) left[r][c] = block[8 * c + r];
    inverse[r][r] = 1.0;
  }
  for (int c = 0; c < 6; ++c) {  // Gauss-Jordan with row exchanges
    int pivot = c;
    for (int r = c + 1; r < 6; ++r) {
      if (std::abs(left[r][c]) > std::abs(left[pivot][c])) pivot = r;
    }
    if (!(std::abs(left[pivot][c]) > 0.0)) return false;
    if (pivot != c) {
      std::swap(left[pivot], left[c]);
      std::swap(inverse[pivot], inverse[c]);
    }
    const double scale = 1.0 / left[c][c];
    for (int k = 0; k < 6; ++k) {
      left[c][k] *= scale;
      inverse[c][k] *= scale;
    }
    for (int r = 0; r < 6; ++r) {
      if (r == c) continue;
      const double factor = left[r][c];
      for (int k = 0; k < 6; ++k) {
        left[r][k] -= factor * left[c][k];
        inverse[r][k] -= factor * inverse[c][k];
      }
    }
  }
  for (int c = 0; c < 6; ++c) {
    for (int r = 0; r < 6; ++r) block[8 * c + r] = inverse[r][c];
  }
  return true;
}

const Kernels& scalar_kernels() {
  static constexpr Kernels kernels = {"scalar",
                                      multiply_j,
                                      multiply_jt,
                                      scalar::factor_fronts,
                                      scalar::solve_fronts_forward,
                                      scalar::solve_fronts_backward,
                                      assemble_general,
                                      factor_general,
                                      solve_general};
  return kernels;
}

}  // namespace ourengine
