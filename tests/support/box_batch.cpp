#include "tests/support/box_batch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/support/box_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ourengine {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr std::size_t k_pairs = hn::MaxLanes(D());

struct BoxVector {
  V x, y, z;
  HWY_INLINE V operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
};
struct Boxes {
  BoxVector half, centre, axis[3];
};

HWY_INLINE V dot(const BoxVector& a, const BoxVector& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

// The same vector of k_pairs boxes, one register per component.
HWY_INLINE BoxVector transpose(const std::array<double, 4>* const* from) {
  const D d;
#if HWY_TARGET == HWY_SCALAR
  return {hn::Set(d, (*from[0])[0]), hn::Set(d, (*from[0])[1]), hn::Set(d, (*from[0])[2])};
#else
  if constexpr (k_pairs == 8) {
    const hn::Half<D> half;
    const auto two = [&](std::size_t k) HWY_ATTR {
      return hn::Combine(d, hn::LoadU(half, from[k + 4]->data()), hn::LoadU(half, from[k]->data()));
    };
    const V a = two(0), b = two(1), c = two(2), e = two(3);
    const V ab = hn::InterleaveLower(d, a, b), ce = hn::InterleaveLower(d, c, e);
    return {hn::OddEvenBlocks(hn::SwapAdjacentBlocks(ce), ab),
            hn::OddEvenBlocks(hn::SwapAdjacentBlocks(hn::InterleaveUpper(d, c, e)),
                              hn::InterleaveUpper(d, a, b)),
            hn::OddEvenBlocks(ce, hn::SwapAdjacentBlocks(ab))};
  } else if constexpr (k_pairs == 4) {
    const V a = hn::LoadU(d, from[0]->data()), b = hn::LoadU(d, from[1]->data());
    const V c = hn::LoadU(d, from[2]->data()), e = hn::LoadU(d, from[3]->data());
    const V ab = hn::InterleaveLower(d, a, b), ce = hn::InterleaveLower(d, c, e);
    return {hn::ConcatLowerLower(d, ce, ab),
            hn::ConcatLowerLower(d, hn::InterleaveUpper(d, c, e), hn::InterleaveUpper(d, a, b)),
            hn::ConcatUpperUpper(d, ce, ab)};
  } else {
    const V a = hn::LoadU(d, from[0]->data()), b = hn::LoadU(d, from[1]->data());
    return {hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b),
            hn::InterleaveLower(d, hn::LoadU(d, from[0]->data() + 2),
                                hn::LoadU(d, from[1]->data() + 2))};
  }
#endif
}

HWY_INLINE Boxes load(const PackedBox* const* boxes) {
  const auto part = [&](auto member) HWY_ATTR {
    const std::array<double, 4>* rows[k_pairs];
    for (std::size_t k = 0; k < k_pairs; ++k) rows[k] = member(boxes[k]);
    return transpose(rows);
  };
  Boxes all;
  all.half = part([](const PackedBox* box) HWY_ATTR { return &box->half_m; });
  all.centre = part([](const PackedBox* box) HWY_ATTR { return &box->centre_m; });
  all.axis[0] = part([](const PackedBox* box) HWY_ATTR { return &box->axes[0]; });
  all.axis[1] = part([](const PackedBox* box) HWY_ATTR { return &box->axes[1]; });
  all.axis[2] = part([](const PackedBox* box) HWY_ATTR { return &box->axes[2]; });
  return all;
}

struct Best {
  V gap, axis;
};

// The largest of three, the first if several are.
HWY_INLINE Best largest(const BoxVector& gaps, double first_axis) {
  const D d;
  Best best = {gaps.x, hn::Set(d, first_axis)};
  const M second = hn::Gt(gaps.y, best.gap);
  best = {hn::IfThenElse(second, gaps.y, best.gap),
          hn::IfThenElse(second, hn::Set(d, first_axis + 1.0), best.axis)};
  const M third = hn::Gt(gaps.z, best.gap);
  return {hn::IfThenElse(third, gaps.z, best.gap),
          hn::IfThenElse(third, hn::Set(d, first_axis + 2.0), best.axis)};
}

struct Relative {
  BoxVector r[3], abs_r[3];  // rows: axes of a; columns: axes of b
  BoxVector in_a, in_b;      // centre of b from that of a
};

HWY_INLINE Relative relative(const Boxes& a, const Boxes& b) {
  Relative all;
  const BoxVector between = {hn::Sub(b.centre.x, a.centre.x), hn::Sub(b.centre.y, a.centre.y),
                             hn::Sub(b.centre.z, a.centre.z)};
  for (int i = 0; i < 3; ++i) {
    all.r[i] = {dot(a.axis[i], b.axis[0]), dot(a.axis[i], b.axis[1]), dot(a.axis[i], b.axis[2])};
    all.abs_r[i] = {hn::Abs(all.r[i].x), hn::Abs(all.r[i].y), hn::Abs(all.r[i].z)};
  }
  all.in_a = {dot(a.axis[0], between), dot(a.axis[1], between), dot(a.axis[2], between)};
  all.in_b = {dot(b.axis[0], between), dot(b.axis[1], between), dot(b.axis[2], between)};
  return all;
}

HWY_INLINE V face_gap(V offset, V own_half, V reach) {
  return hn::Sub(hn::Sub(hn::Abs(offset), own_half), reach);
}

HWY_INLINE V signed_square(V x) { return hn::Mul(x, hn::Abs(x)); }

// A gap that has not been divided yet: over / sqrt(length_squared).
struct Edges {
  V over, length_squared, axis;
};

// Edge i of a with edge j of b.
HWY_INLINE Edges cross_edges(const Relative& all, const Boxes& a, const Boxes& b, int i, int j) {
  const D d;
  const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  const V distance =
      hn::Abs(hn::NegMulAdd(all.in_a[i1], all.r[i2][j], hn::Mul(all.in_a[i2], all.r[i1][j])));
  V reach = hn::Mul(a.half[i1], all.abs_r[i2][j]);
  reach = hn::MulAdd(a.half[i2], all.abs_r[i1][j], reach);
  reach = hn::MulAdd(b.half[j1], all.abs_r[i][j2], reach);
  reach = hn::MulAdd(b.half[j2], all.abs_r[i][j1], reach);
  return {hn::Sub(distance, reach), hn::NegMulAdd(all.r[i][j], all.r[i][j], hn::Set(d, 1.0)),
          hn::Set(d, 6.0 + 3.0 * i + j)};
}

// The best edges of the pairs that are open, in the order of BoxSeparation::axis, if they beat the
// threshold. Gaps are compared by their squares with sign, multiplied out (x -> x |x| is monotone),
// so that no pair needs more than one root and one division, and there is no branch to guess.
HWY_INLINE void try_edges(const Relative& all, const Boxes& a, const Boxes& b, V margin,
                          V threshold, M open, Best& best) {
  const D d;
  const V square_of_margin = signed_square(margin);
  Edges top = {threshold, hn::Set(d, 1.0), best.axis};
  V square = signed_square(threshold);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Edges edges = cross_edges(all, a, b, i, j);
      const V own = signed_square(edges.over);
      M wins = hn::Gt(hn::Mul(own, top.length_squared), hn::Mul(square, edges.length_squared));
      wins = hn::And(wins, hn::Ge(edges.length_squared, hn::Set(d, k_parallel_edges)));
      wins = hn::And(wins, open);
      top.over = hn::IfThenElse(wins, edges.over, top.over);
      top.length_squared = hn::IfThenElse(wins, edges.length_squared, top.length_squared);
      top.axis = hn::IfThenElse(wins, edges.axis, top.axis);
      square = hn::IfThenElse(wins, own, square);
      const M apart = hn::Gt(own, hn::Mul(square_of_margin, edges.length_squared));
      open = hn::And(open, hn::Not(hn::And(wins, apart)));
    }
  }
  const M found = hn::Ge(top.axis, hn::Set(d, 6.0));
  if (hn::AllFalse(d, found)) return;
  const V gap = hn::Div(top.over, hn::Sqrt(top.length_squared));
  best = {hn::IfThenElse(found, gap, best.gap), hn::IfThenElse(found, top.axis, best.axis)};
}

HWY_INLINE Best separate_lanes(const Boxes& a, const Boxes& b, V margin) {
  const D d;
  const Relative all = relative(a, b);
  const BoxVector column[3] = {{all.abs_r[0].x, all.abs_r[1].x, all.abs_r[2].x},
                               {all.abs_r[0].y, all.abs_r[1].y, all.abs_r[2].y},
                               {all.abs_r[0].z, all.abs_r[1].z, all.abs_r[2].z}};
  const Best best_a = largest({face_gap(all.in_a.x, a.half.x, dot(all.abs_r[0], b.half)),
                               face_gap(all.in_a.y, a.half.y, dot(all.abs_r[1], b.half)),
                               face_gap(all.in_a.z, a.half.z, dot(all.abs_r[2], b.half))},
                              0.0);
  const Best best_b = largest({face_gap(all.in_b.x, b.half.x, dot(column[0], a.half)),
                               face_gap(all.in_b.y, b.half.y, dot(column[1], a.half)),
                               face_gap(all.in_b.z, b.half.z, dot(column[2], a.half))},
                              3.0);
  const V thinnest = hn::Min(hn::Min(hn::Min(a.half.x, a.half.y), a.half.z),
                             hn::Min(hn::Min(b.half.x, b.half.y), b.half.z));
  const V bias = hn::Mul(hn::Set(d, 2.0 * k_axis_bias), thinnest);
  const M of_b = hn::Gt(best_b.gap, hn::Add(best_a.gap, bias));
  Best best = {hn::IfThenElse(of_b, best_b.gap, best_a.gap),
               hn::IfThenElse(of_b, best_b.axis, best_a.axis)};
  const M open = hn::Le(hn::Max(best_a.gap, best_b.gap), margin);
  if (hn::AllFalse(d, open)) return best;
  try_edges(all, a, b, margin, hn::Add(best.gap, bias), open, best);
  return best;
}

void separate_pairs(const PackedBox* boxes, const BodyPair* pairs, std::size_t count,
                    double margin_m, PairSeparation* separations) {
  const D d;
  const V margin = hn::Set(d, margin_m);
  for (std::size_t begin = 0; begin < count; begin += k_pairs) {
    const PackedBox* first[k_pairs];
    const PackedBox* second[k_pairs];
    for (std::size_t k = 0; k < k_pairs; ++k) {  // the last pair fills up the last batch
      const BodyPair& pair = pairs[HWY_MIN(begin + k, count - 1)];
      first[k] = boxes + pair.first;
      second[k] = boxes + pair.second;
    }
    const Best best = separate_lanes(load(first), load(second), margin);
    HWY_ALIGN double gap[k_pairs];
    HWY_ALIGN double axis[k_pairs];
    hn::Store(best.gap, d, gap);
    hn::Store(best.axis, d, axis);
    for (std::size_t k = 0; k < HWY_MIN(k_pairs, count - begin); ++k)
      separations[begin + k] = {gap[k], static_cast<int>(axis[k])};
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace ourengine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ourengine {
HWY_EXPORT(separate_pairs);

PackedBox pack(const PosedBox& box) {
  PackedBox packed{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    packed.half_m[c] = box.half_m[i];
    packed.centre_m[c] = box.centre_m[i];
    for (std::size_t k = 0; k < 3; ++k)
      packed.axes[k][c] = box.axes(i, static_cast<Eigen::Index>(k));
  }
  return packed;
}

void separate_pairs(std::span<const PackedBox> boxes, std::span<const BodyPair> pairs,
                    double margin_m, std::span<PairSeparation> separations) {
  HWY_DYNAMIC_DISPATCH(separate_pairs)
  (boxes.data(), pairs.data(), pairs.size(), margin_m, separations.data());
}

}  // namespace ourengine
#endif
