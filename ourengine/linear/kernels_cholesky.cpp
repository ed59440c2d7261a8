#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "ourengine/linear/fronts.hpp"
#include "ourengine/linear/kernels.hpp"
#include "ourengine/linear/kernels_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ourengine/linear/kernels_cholesky.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands.
#include "ourengine/linear/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace ourengine::linear::HWY_NAMESPACE {

// Vectors of rows in one tile, as many as leave six columns of them in registers.
constexpr std::size_t kTile = kLanes >= 8 ? 4 : 2;

constexpr std::size_t round_down(std::size_t n) { return n / 8 * 8; }

// Lanes 6 and 7 of a block are zeros, which are added to the rows after it.
HWY_INLINE void add_block(const Columns& c, double* target, std::size_t lead) {
  const D d;
  const V column[6] = {c.c0, c.c1, c.c2, c.c3, c.c4, c.c5};
  for (std::size_t k = 0; k < 6; ++k, target += lead)
    hn::StoreU(hn::Add(hn::LoadU(d, target), column[k]), d, target);
}

// Is any of a contact's weights not zero?
template <int kComponents>
HWY_INLINE bool loaded(const double* d, std::size_t n, std::size_t i) {
  return d[i] != 0.0 || (kComponents == 3 && (d[3 * n + i] != 0.0 || d[5 * n + i] != 0.0));
}

// c += J^T D J of a pair, with the rows of J towards `left` and towards `right` (0: a, 8: b).
template <int kComponents>
HWY_INLINE void add_pair(const SystemView& s, const double* d, const ContactPair& pair,
                         std::size_t left, std::size_t right, std::size_t part, Columns& c) {
  const D tag;
  const std::size_t n = at(s.stride);
  HWY_ALIGN double scaled[8 * kComponents];
  for (std::size_t i = at(pair.begin); i < at(pair.end); ++i) {
    if (!loaded<kComponents>(d, n, i)) continue;
    const double* rows = s.rows + 16 * at(kComponents) * i;
    scale_rows<kComponents>(rows + right, d, n, i, scaled);
    for (std::size_t k = 0; k < kComponents; ++k)
      add_outer(hn::Load(tag, rows + 16 * k + left + part), scaled + 8 * k, c);
  }
}

// Mass and contacts of the bodies that are eliminated here.
template <int kComponents>
HWY_INLINE void add_system(const SystemView& s, const FrontalView& view, const double* d,
                           std::size_t index, const FrontWork& work) {
  const std::size_t lead = work.front.lead;
  for (std::size_t part = 0; part < 6; part += kLanes) {
    for (std::size_t b = 0; b < at(work.front.columns); ++b) {
      const std::size_t body = at(work.front.first) + b;
      Columns c = load_columns(s.mass + kBlock * body + part);
      for (int q = view.side_begin[body]; q < view.side_begin[body + 1]; ++q) {
        const std::size_t side = view.sides[q].of_b ? 8 : 0;
        add_pair<kComponents>(s, d, s.pairs[view.sides[q].pair], side, side, part, c);
      }
      add_block(c, work.entry(6 * b + part, 6 * b), lead);
    }
    for (int p = view.pair_begin[index]; p < view.pair_begin[index + 1]; ++p) {
      const FrontPair& place = view.pairs[p];
      const std::size_t below = place.a_below ? 0 : 8;
      Columns c = zero_columns();
      add_pair<kComponents>(s, d, s.pairs[place.pair], below, 8 - below, part, c);
      add_block(c, work.entry(6 * at(place.row) + part, 6 * at(place.column)), lead);
    }
  }
}

// Six columns of `count` rows, added.
HWY_INLINE void add_rows(const double* from, std::size_t lead_from, double* to, std::size_t lead_to,
                         std::size_t count) {
  const D d;
  std::size_t r = 0;
  for (; r + kLanes <= count; r += kLanes) {
    for (std::size_t c = 0; c < 6; ++c) {
      double* target = to + c * lead_to + r;
      hn::StoreU(hn::Add(hn::LoadU(d, target), hn::LoadU(d, from + c * lead_from + r)), d, target);
    }
  }
  if (r == count) return;
  const auto rest = hn::FirstN(d, count - r);
  for (std::size_t c = 0; c < 6; ++c) {
    double* target = to + c * lead_to + r;
    const V sum = hn::Add(hn::LoadU(d, target), hn::LoadU(d, from + c * lead_from + r));
    hn::BlendedStore(sum, rest, d, target);
  }
}

// What the update matrix of a child adds to the panel, or to the update matrix.
HWY_INLINE void add_child(const FrontPattern& fronts, const FrontWork& child, const FrontWork& work,
                          bool to_panel) {
  for (int q = child.front.run_begin; q < child.front.run_end; ++q) {
    const FrontRun& columns = fronts.run[at(q)];
    for (int k = 0; k < columns.length; ++k) {
      if ((columns.to + k < work.front.columns) != to_panel) continue;
      const std::size_t from = 6 * at(columns.from + k), to = 6 * at(columns.to + k);
      const std::size_t lead_from = child.lead(from), lead_to = work.lead(to);
      add_rows(child.entry(from, from), lead_from, work.entry(to, to), lead_to,
               6 * at(columns.length - k));
      for (int r = q + 1; r < child.front.run_end; ++r) {
        const FrontRun& rows = fronts.run[at(r)];
        add_rows(child.entry(6 * at(rows.from), from), lead_from, work.entry(6 * at(rows.to), to),
                 lead_to, 6 * at(rows.length));
      }
    }
  }
}

// c -= a b^T, or c = -a b^T if kFresh: kVectors vectors of rows, 6 columns, `depth` terms.
template <bool kFresh, std::size_t kVectors>
HWY_INLINE void subtract_tile(const double* HWY_RESTRICT a, const double* HWY_RESTRICT b,
                              std::size_t lead, std::size_t depth, double* HWY_RESTRICT c,
                              std::size_t lead_c) {
  const D d;
  V sum[6][kVectors];
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t v = 0; v < kVectors; ++v)
      sum[j][v] = kFresh ? hn::Zero(d) : hn::Load(d, c + j * lead_c + v * kLanes);
  }
  for (std::size_t k = 0; k < depth; ++k, a += lead, b += lead) {
    V left[kVectors];
    for (std::size_t v = 0; v < kVectors; ++v) left[v] = hn::Load(d, a + v * kLanes);
    for (std::size_t j = 0; j < 6; ++j) {
      const V right = hn::Set(d, b[j]);
      for (std::size_t v = 0; v < kVectors; ++v)
        sum[j][v] = hn::NegMulAdd(left[v], right, sum[j][v]);
    }
  }
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t v = 0; v < kVectors; ++v) hn::Store(sum[j][v], d, c + j * lead_c + v * kLanes);
  }
}

template <bool kFresh>
HWY_INLINE void subtract_rows(std::size_t vectors, const double* a, const double* b,
                              std::size_t lead, std::size_t depth, double* c, std::size_t lead_c) {
  switch (vectors) {
    case 1:
      return subtract_tile<kFresh, 1>(a, b, lead, depth, c, lead_c);
    case 2:
      return subtract_tile<kFresh, 2>(a, b, lead, depth, c, lead_c);
    case 3:
      return subtract_tile<kFresh, (kTile > 3 ? 3 : 1)>(a, b, lead, depth, c, lead_c);
    default:
      return subtract_tile<kFresh, kTile>(a, b, lead, depth, c, lead_c);
  }
}

// Block column j of the panel less the products of the columns before it.
HWY_INLINE void subtract_earlier(const FrontWork& work, std::size_t j) {
  if (j == 0) return;
  const std::size_t lead = work.front.lead, depth = 6 * j;
  double* target = work.panel + depth * lead;
  for (std::size_t r = round_down(depth); r < lead; r += kTile * kLanes) {
    subtract_rows<false>(std::min(kTile, (lead - r) / kLanes), work.panel + r, work.panel + depth,
                         lead, depth, target + r, lead);
  }
}

// Cholesky factor of a 6x6 block, inverted (column by column, leading dimension 8, upper part
// zero).
HWY_INLINE bool invert_pivot(const double* block, std::size_t lead, double* inverted) {
  bool positive = true;
  double l[6][6], reciprocal[6], inverse[6][6] = {};
  for (std::size_t a = 0; a < 6; ++a) {
    double pivot = block[a * lead + a];
    for (std::size_t k = 0; k < a; ++k) pivot -= l[a][k] * l[a][k];
    if (!(pivot > 0.0)) {
      positive = false;
      pivot = std::numeric_limits<double>::max();
    }
    reciprocal[a] = 1.0 / std::sqrt(pivot);
    for (std::size_t b = a + 1; b < 6; ++b) {
      double sum = block[a * lead + b];
      for (std::size_t k = 0; k < a; ++k) sum -= l[b][k] * l[a][k];
      l[b][a] = sum * reciprocal[a];
    }
  }
  for (std::size_t c = 0; c < 6; ++c) {
    inverse[c][c] = reciprocal[c];
    for (std::size_t r = c + 1; r < 6; ++r) {
      double sum = 0.0;
      for (std::size_t k = c; k < r; ++k) sum -= l[r][k] * inverse[k][c];
      inverse[r][c] = sum * reciprocal[r];
    }
  }
  for (std::size_t c = 0; c < 6; ++c) {
    for (std::size_t r = 0; r < 6; ++r) inverted[8 * c + r] = inverse[r][c];
  }
  return positive;
}

// Rows from r on of six columns, times inverse^T.
HWY_INLINE void scale_rows_by(const double* inverse, std::size_t lead, double* columns,
                              std::size_t r) {
  const D d;
  for (; r < lead; r += kLanes) {
    V column[6];
    for (std::size_t c = 0; c < 6; ++c) column[c] = hn::Load(d, columns + c * lead + r);
    for (std::size_t c = 0; c < 6; ++c) {
      V sum = hn::Mul(column[0], hn::Set(d, inverse[c]));
      for (std::size_t k = 1; k <= c; ++k)
        sum = hn::MulAdd(column[k], hn::Set(d, inverse[8 * k + c]), sum);
      hn::Store(sum, d, columns + c * lead + r);
    }
  }
}

HWY_INLINE bool eliminate(const FrontWork& work) {
  bool positive = true;
  HWY_ALIGN double inverse[kBlockSize];
  for (std::size_t j = 0; j < at(work.front.columns); ++j) {
    subtract_earlier(work, j);
    double* columns = work.panel + 6 * j * work.front.lead;
    positive = invert_pivot(columns + 6 * j, work.front.lead, inverse) && positive;
    scale_rows_by(inverse, work.front.lead, columns, round_down(6 * j + 6));
    for (std::size_t c = 0; c < 6; ++c)
      std::memcpy(columns + c * work.front.lead + 6 * j, inverse + 8 * c, 6 * sizeof(double));
  }
  return positive;
}

// update = -(panel below the pivots) (the same)^T, lower part.
HWY_INLINE void start_update(const FrontWork& work) {
  const std::size_t lead = work.front.lead, last = at(work.front.rows);
  for (std::size_t r = work.front.skip; r < lead; r += kTile * kLanes) {
    const std::size_t vectors = std::min(kTile, (lead - r) / kLanes);
    const std::size_t end = r + vectors * kLanes;
    for (std::size_t j = at(work.front.columns); j < last && 6 * j < end; ++j) {
      // Rows above the diagonal of this column are nobody's.
      const std::size_t above = 6 * j > r ? (6 * j - r) / kLanes : 0;
      const std::size_t from = r + above * kLanes;
      subtract_rows<true>(vectors - above, work.panel + from, work.panel + 6 * j, lead,
                          work.pivots(), work.entry(from, 6 * j), work.front.update_lead());
    }
  }
}

// Zeros in the lower part of the panel, and as far above it as vectors reach.
HWY_INLINE void clear(const FrontWork& work) {
  const D d;
  double* column = work.panel;
  for (std::size_t c = 0; c < work.pivots(); ++c, column += work.front.lead) {
    for (std::size_t r = round_down(c / 6 * 6); r < work.front.lead; r += kLanes)
      hn::Store(hn::Zero(d), d, column + r);
  }
}

bool factor_fronts(const SystemView& system, const FrontalView& view, const double* d,
                   FrontTask task, const FrontStores& stores) {
  bool positive = true;
  const FrontPattern& fronts = *view.fronts;
  for (std::size_t s = at(task.begin); s < at(task.end); ++s) {
    const Front& front = fronts.front[s];
    const FrontWork work = work_on(front, stores);
    clear(work);
    if (system.components == 1)
      add_system<1>(system, view, d, s, work);
    else
      add_system<3>(system, view, d, s, work);
    const auto add_children = [&](bool to_panel) {
      for (int c = front.child_begin; c < front.child_end; ++c) {
        const Front& child = fronts.front[at(fronts.child[at(c)])];
        add_child(fronts, work_on(child, stores), work, to_panel);
      }
    };
    add_children(true);
    positive = eliminate(work) && positive;
    start_update(work);
    add_children(false);
  }
  return positive;
}

// z -= (six columns) * y from row r on.
HWY_INLINE void subtract_columns(const double* columns, std::size_t lead, const double* y,
                                 std::size_t r, double* z) {
  const D d;
  const V y0 = hn::Set(d, y[0]), y1 = hn::Set(d, y[1]), y2 = hn::Set(d, y[2]),
          y3 = hn::Set(d, y[3]), y4 = hn::Set(d, y[4]), y5 = hn::Set(d, y[5]);
  for (; r < lead; r += kLanes) {
    const double* column = columns + r;
    V sum = hn::Load(d, z + r);
    sum = hn::NegMulAdd(hn::Load(d, column), y0, sum);
    sum = hn::NegMulAdd(hn::Load(d, column + lead), y1, sum);
    sum = hn::NegMulAdd(hn::Load(d, column + 2 * lead), y2, sum);
    sum = hn::NegMulAdd(hn::Load(d, column + 3 * lead), y3, sum);
    sum = hn::NegMulAdd(hn::Load(d, column + 4 * lead), y4, sum);
    sum = hn::NegMulAdd(hn::Load(d, column + 5 * lead), y5, sum);
    hn::Store(sum, d, z + r);
  }
}

// Forward: what a front subtracts from the right-hand side of later rows goes to its parent, in the
// same way as its update matrix.
void solve_fronts_forward(const FrontalView& view, FrontTask task, const double* panels,
                          double* vectors, double* x) {
  const FrontPattern& fronts = *view.fronts;
  for (std::size_t s = at(task.begin); s < at(task.end); ++s) {
    const Front& front = fronts.front[s];
    double* z = vectors + front.vector;
    std::memset(z, 0, front.lead * sizeof(double));
    double* own = x + kBodyStride * at(front.first);
    for (std::size_t c = 0; c < at(front.columns); ++c)
      std::memcpy(z + 6 * c, own + kBodyStride * c, 6 * sizeof(double));
    for (int c = front.child_begin; c < front.child_end; ++c) {
      const Front& child = fronts.front[at(fronts.child[at(c)])];
      for (int q = child.run_begin; q < child.run_end; ++q) {
        const FrontRun& run = fronts.run[at(q)];
        const double* from = vectors + child.vector + 6 * at(run.from);
        double* to = z + 6 * at(run.to);
        for (std::size_t i = 0; i < 6 * at(run.length); ++i) to[i] += from[i];
      }
    }
    for (std::size_t j = 0; j < at(front.columns); ++j) {
      const double* columns = panels + front.panel + 6 * j * front.lead;
      double* y = own + kBodyStride * j;
      for (std::size_t r = 0; r < 6; ++r) {
        double sum = 0.0;
        for (std::size_t k = 0; k <= r; ++k)
          sum += columns[k * front.lead + 6 * j + r] * z[6 * j + k];
        y[r] = sum;
      }
      subtract_columns(columns, front.lead, y, round_down(6 * j + 6), z);
    }
  }
}

// y -= (six columns)^T z from row r on. Eight sums per column whatever the vectors: the same bits.
HWY_INLINE void subtract_transposed(const double* columns, std::size_t lead, const double* z,
                                    std::size_t r, double* y) {
  const D d;
  Columns sum[8 / kLanes];
  for (Columns& part : sum) part = zero_columns();
  for (; r < lead; r += 8) {
    for (std::size_t part = 0; part < 8 / kLanes; ++part) {
      const double* column = columns + r + part * kLanes;
      const V value = hn::Load(d, z + r + part * kLanes);
      Columns& s = sum[part];
      s.c0 = hn::MulAdd(hn::Load(d, column), value, s.c0);
      s.c1 = hn::MulAdd(hn::Load(d, column + lead), value, s.c1);
      s.c2 = hn::MulAdd(hn::Load(d, column + 2 * lead), value, s.c2);
      s.c3 = hn::MulAdd(hn::Load(d, column + 3 * lead), value, s.c3);
      s.c4 = hn::MulAdd(hn::Load(d, column + 4 * lead), value, s.c4);
      s.c5 = hn::MulAdd(hn::Load(d, column + 5 * lead), value, s.c5);
    }
  }
  HWY_ALIGN double lanes[kBlockSize];
  for (std::size_t part = 0; part < 8 / kLanes; ++part) {
    double* lane = lanes + part * kLanes;
    hn::Store(sum[part].c0, d, lane);
    hn::Store(sum[part].c1, d, lane + 8);
    hn::Store(sum[part].c2, d, lane + 16);
    hn::Store(sum[part].c3, d, lane + 24);
    hn::Store(sum[part].c4, d, lane + 32);
    hn::Store(sum[part].c5, d, lane + 40);
  }
  for (std::size_t c = 0; c < 6; ++c) {
    const double* l = lanes + 8 * c;
    y[c] -= ((l[0] + l[1]) + (l[2] + l[3])) + ((l[4] + l[5]) + (l[6] + l[7]));
  }
}

void solve_fronts_backward(const FrontalView& view, FrontTask task, const double* panels,
                           double* vectors, double* x) {
  const FrontPattern& fronts = *view.fronts;
  for (std::size_t s = at(task.end); s-- > at(task.begin);) {
    const Front& front = fronts.front[s];
    double* z = vectors + front.vector;  // pivots not solved for yet are zero
    std::memset(z, 0, front.lead * sizeof(double));
    const int* row = fronts.row.data() + front.row_begin;
    for (std::size_t r = at(front.columns); r < at(front.rows); ++r)
      std::memcpy(z + 6 * r, x + kBodyStride * at(row[r]), 6 * sizeof(double));
    for (std::size_t j = at(front.columns); j-- > 0;) {
      const double* columns = panels + front.panel + 6 * j * front.lead;
      double* own = x + kBodyStride * (at(front.first) + j);
      double y[6];
      std::memcpy(y, own, sizeof y);
      subtract_transposed(columns, front.lead, z, round_down(6 * j + 6), y);
      for (std::size_t c = 0; c < 6; ++c) {
        double sum = 0.0;
        for (std::size_t r = c; r < 6; ++r) sum += columns[c * front.lead + 6 * j + r] * y[r];
        own[c] = sum;
      }
      std::memcpy(z + 6 * j, own, 6 * sizeof(double));
    }
  }
}

void fill_fronts(Kernels& kernels) {
  kernels.factor_fronts = factor_fronts;
  kernels.solve_fronts_forward = solve_fronts_forward;
  kernels.solve_fronts_backward = solve_fronts_backward;
}

}  // namespace ourengine::linear::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ourengine::linear {

HWY_EXPORT(fill_fronts);

void add_fronts(Kernels& kernels) { HWY_DYNAMIC_DISPATCH(fill_fronts)(kernels); }

}  // namespace ourengine::linear
#endif
