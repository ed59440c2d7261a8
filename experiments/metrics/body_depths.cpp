#include "experiments/metrics/body_depths.hpp"

#include <algorithm>

namespace brickbench {
namespace {

struct Span {
  std::size_t body;
  double low_m;  // along x
  double high_m;
};

}  // namespace

std::vector<double> body_depths_m(std::span<const Shape> shapes, const std::vector<bool>& fixed,
                                  std::span<const State> states) {
  std::vector<double> depths_m(shapes.size(), 0.0);
  std::vector<Placed> placed;
  std::vector<Eigen::Vector3d> reaches_m;
  std::vector<std::size_t> planes;
  std::vector<Span> spans;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    placed.push_back(place(shapes[i], states[i]));
    const bool is_plane = placed[i].kind == PlacedKind::plane;
    reaches_m.push_back(is_plane ? Eigen::Vector3d::Zero() : reach_m(placed[i]));
    const double x_m = placed[i].center_m.x();
    if (is_plane)
      planes.push_back(i);
    else
      spans.push_back({i, x_m - reaches_m[i].x(), x_m + reaches_m[i].x()});
  }
  const auto look_at = [&](std::size_t a, std::size_t b) {
    if (fixed[a] && fixed[b]) return;
    const double depth_m = depth_above_m(placed[a], placed[b], 0.0);
    depths_m[a] = std::max(depths_m[a], depth_m);
    depths_m[b] = std::max(depths_m[b], depth_m);
  };
  for (const std::size_t plane : planes) {
    for (const Span& span : spans) look_at(plane, span.body);
  }
  std::ranges::sort(spans, {}, &Span::low_m);
  for (auto a = spans.begin(); a != spans.end(); ++a) {
    for (auto b = a + 1; b != spans.end() && b->low_m < a->high_m; ++b) {
      const Eigen::Vector3d apart_m =
          (placed[a->body].center_m - placed[b->body].center_m).cwiseAbs();
      const Eigen::Vector3d room_m = reaches_m[a->body] + reaches_m[b->body];
      if ((apart_m.array() < room_m.array()).all()) look_at(a->body, b->body);
    }
  }
  return depths_m;
}

}  // namespace brickbench
