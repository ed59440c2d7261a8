#include "ourengine/collision/passage.hpp"

#include <algorithm>
#include <cmath>

#include "ourengine/integration/rotation.hpp"

namespace ourengine {
namespace {

// Of the thinner body: how far apart the places are where one looks, and how much deeper an
// overlap must be than at the ends. To pass, a body must be deeper than half of it somewhere.
constexpr double k_passage_share = 0.25;
constexpr int k_most_places = 64;

double moved_m(const BodyModel& body, const Way& way) {
  if (body.fixed) return 0.0;
  return (way.end.position_m - way.start.position_m).norm() +
         way.turn_rad.norm() * bounding_radius_m(body.geometry);
}

Motion along(const BodyModel& body, const Way& way, double share) {
  if (body.fixed) return way.start;
  Motion at = way.start;
  at.position_m += share * (way.end.position_m - way.start.position_m);
  at.attitude = turned(way.start.attitude, share * way.turn_rad);
  return at;
}

}  // namespace

double deepest_overlap_m(const BodyModel& a, const Motion& at_a, const BodyModel& b,
                         const Motion& at_b) {
  const Manifold manifold = collide(a, at_a, b, at_b, 0.0);
  double deepest_m = 0.0;
  for (int p = 0; p < manifold.count; ++p) {
    deepest_m = std::max(deepest_m, -manifold.points[static_cast<std::size_t>(p)].gap_m);
  }
  return deepest_m;
}

double passage_m(const BodyModel& a, const Way& way_a, const BodyModel& b, const Way& way_b) {
  const double step_m =
      k_passage_share * std::min(thickness_m(a.geometry), thickness_m(b.geometry));
  const double places = (moved_m(a, way_a) + moved_m(b, way_b)) / step_m;
  if (!(places > 2.0)) return 0.0;
  const int count = static_cast<int>(std::min(std::ceil(places), double{k_most_places}));
  const double allowed_m = step_m + std::max(deepest_overlap_m(a, way_a.start, b, way_b.start),
                                             deepest_overlap_m(a, way_a.end, b, way_b.end));
  for (int k = 1; k < count; ++k) {
    const double share = static_cast<double>(k) / count;
    const double depth_m = deepest_overlap_m(a, along(a, way_a, share), b, along(b, way_b, share));
    if (depth_m > allowed_m) return depth_m;
  }
  return 0.0;
}

bool passes(const BodyModel& a, const Way& way_a, const BodyModel& b, const Way& way_b) {
  return passage_m(a, way_a, b, way_b) > 0.0;
}

}  // namespace ourengine
