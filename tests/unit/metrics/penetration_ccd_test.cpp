// The independent depth against libccd: GJK with the expanding polytope algorithm, which shares not
// even the idea with the 15 axes.
#include <ccd/ccd.h>
#include <ccd/quat.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "experiments/metrics/penetration_depth.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::testing {
namespace {

struct CcdBox {
  Eigen::Vector3d half_m;
  State state;
};

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const auto& box = *static_cast<const CcdBox*>(object);
  const Eigen::Vector3d local = box.state.orientation.conjugate() *
                                Eigen::Vector3d(direction->v[0], direction->v[1], direction->v[2]);
  Eigen::Vector3d corner_m = box.half_m;
  for (int i = 0; i < 3; ++i) {
    if (local[i] < 0.0) corner_m[i] = -corner_m[i];
  }
  const Eigen::Vector3d world_m = box.state.position_m + box.state.orientation * corner_m;
  ccdVec3Set(point, world_m.x(), world_m.y(), world_m.z());
}

// What libccd knows of the depth: its inner polytope bounds it from below, and the overlap along
// the direction that it returns bounds it from above. Both 0 where it finds no overlap.
struct Bracket {
  double low_m = 0.0;
  double high_m = 0.0;
};

Bracket ccd_depth(const CcdBox& a, const CcdBox& b) {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = support;
  ccd.support2 = support;
  ccd.max_iterations = 500;
  ccd.epa_tolerance = 1e-9;
  ccd_real_t depth_m = 0.0;
  ccd_vec3_t along;
  ccd_vec3_t position;
  if (ccdGJKPenetration(&a, &b, &ccd, &depth_m, &along, &position) != 0) return {};
  ccd_vec3_t back = along;
  ccdVec3Scale(&back, -1.0);
  const auto extent_m = [&](const ccd_vec3_t& direction, const ccd_vec3_t& opposite) {
    ccd_vec3_t on_a;
    ccd_vec3_t on_b;
    support(&a, &direction, &on_a);
    support(&b, &opposite, &on_b);
    ccdVec3Sub(&on_a, &on_b);
    return ccdVec3Dot(&on_a, &direction) / std::sqrt(ccdVec3Len2(&direction));
  };
  return {depth_m, std::min(extent_m(along, back), extent_m(back, along))};
}

struct Pair {
  CcdBox a, b;
};

// A third each: any pose; turned by 1e-9 .. 1e-2 rad as in a wall; one small in one large.
Pair random_pair(std::mt19937_64& engine, int kind) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  const auto vector = [&](double low, double high) {
    return Eigen::Vector3d(uniform(low, high), uniform(low, high), uniform(low, high));
  };
  std::normal_distribution<double> normal;
  const auto rotation = [&] {
    return Eigen::Quaterniond(normal(engine), normal(engine), normal(engine), normal(engine))
        .normalized();
  };
  Pair pair{{vector(0.05, 0.5), {}}, {vector(0.05, 0.5), {}}};
  pair.a.state.orientation = rotation();
  pair.b.state.orientation = rotation();
  if (kind == 1) {
    const double angle_rad = std::pow(10.0, uniform(-9.0, -2.0));
    pair.b.state.orientation =
        pair.a.state.orientation *
        Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, vector(-1, 1).normalized()));
  }
  if (kind == 2) pair.b.half_m *= 0.1;
  pair.b.state.position_m = vector(-0.5, 0.5);
  return pair;
}

// libccd's polytope sometimes stops growing too early; its own two bounds then show it, and another
// view of the same pair mostly converges.
constexpr double k_converged_m = 1e-6;
constexpr int k_views = 8;
// Observed 0.0426, a property of libccd (degenerate facets). For these pairs the bounds still hold
// but are wide: they test less.
constexpr double k_largest_unconverged_share = 0.05;

Bracket ccd_depth_from_many_sides(Pair pair) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()));
  Bracket best = ccd_depth(pair.a, pair.b);
  for (int view = 1; view < k_views && best.high_m - best.low_m > k_converged_m; ++view) {
    for (CcdBox* box : {&pair.a, &pair.b}) {
      box->state.position_m = turn * box->state.position_m;
      box->state.orientation = turn * box->state.orientation;
    }
    std::swap(pair.a, pair.b);
    const Bracket next = ccd_depth(pair.a, pair.b);
    best = {std::max(best.low_m, next.low_m), std::min(best.high_m, next.high_m)};
  }
  return best;
}

TEST(PenetrationDepth, AgreesWithLibccdOnRandomPairs) {
  constexpr Tolerance tolerance{"depth outside libccd's bounds (m)", 2e-14, 1.3e-15,
                                "both bounds are rounded sums of metres"};
  std::mt19937_64 engine(7);
  Worst worst;
  int overlapping = 0;
  int disagreeing = 0;
  int unconverged = 0;
  constexpr int k_pairs = 100000;
  for (int n = 0; n < k_pairs; ++n) {
    const Pair pair = random_pair(engine, n % 3);
    const double ours_m = penetration_depth_m(BoxShape{pair.a.half_m}, pair.a.state,
                                              BoxShape{pair.b.half_m}, pair.b.state);
    const Bracket theirs = ccd_depth_from_many_sides(pair);
    if (ours_m > 0.0) ++overlapping;
    if ((ours_m > 0.0) != (theirs.high_m > 0.0)) ++disagreeing;
    if (theirs.high_m - theirs.low_m > k_converged_m) ++unconverged;
    const double outside_m = std::max({theirs.low_m - ours_m, ours_m - theirs.high_m, 0.0});
    worst.see(outside_m, "pair " + std::to_string(n) + ": ours " + std::to_string(ours_m) +
                             " m, theirs " + std::to_string(theirs.low_m) + " .. " +
                             std::to_string(theirs.high_m) + " m");
  }
  EXPECT_TRUE(worst.within(tolerance)) << disagreeing << " of " << k_pairs << " verdicts differ";
  EXPECT_LT(unconverged, k_largest_unconverged_share * k_pairs);
  EXPECT_GT(overlapping, k_pairs / 4);
  std::printf("%d overlapping, %d verdicts differ, %d unconverged\n", overlapping, disagreeing,
              unconverged);
}

}  // namespace
}  // namespace brickbench::testing
