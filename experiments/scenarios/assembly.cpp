// Bricks of random sizes, in a pile, a stack or a lattice: whatever a few numbers can throw at an
// engine.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

#include "adapters/seam/shape.hpp"
#include "experiments/scenarios/parts.hpp"

namespace brickbench {
namespace {

// The same numbers on every platform: SplitMix64 (Steele, Lea, Flood, 2014).
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : state_(seed) {}
  double unit() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
  }
  double sign() { return 2.0 * unit() - 1.0; }
  // A factor between 1 / (1 + spread) and 1 + spread, even in the logarithm.
  double factor(double spread) { return std::pow(1.0 + spread, sign()); }
  Eigen::Vector3d signs() {
    const double x = sign();
    const double y = sign();
    return {x, y, sign()};
  }
  // Uniform over all attitudes (K. Shoemake, Uniform Random Rotations, Graphics Gems III, 1992).
  Eigen::Quaterniond attitude() {
    const double share = unit();
    const double first = 2.0 * std::numbers::pi * unit();
    const double second = 2.0 * std::numbers::pi * unit();
    const double small = std::sqrt(1.0 - share);
    const double large = std::sqrt(share);
    return {large * std::cos(second), small * std::sin(first), small * std::cos(first),
            large * std::sin(second)};
  }

 private:
  std::uint64_t state_;
};

Eigen::Vector3d draw_edges_m(Draw& draw, const ParameterValues& values) {
  const double spread = number(values, "size_spread");
  Eigen::Vector3d edges_m = size_m(values, "brick");
  for (int axis = 0; axis < 3; ++axis) edges_m[axis] *= draw.factor(spread);
  return edges_m;
}

Body draw_brick(Draw& draw, const ParameterValues& values, int index,
                const Eigen::Vector3d& edges_m) {
  const double density_kgpm3 =
      number(values, "density_kgpm3") * draw.factor(number(values, "density_spread"));
  State initial;
  initial.velocity_mps = number(values, "speed_mps") * draw.signs();
  initial.angular_velocity_radps = number(values, "spin_radps") * draw.signs();
  return brick(fmt::format("brick_{}", index), edges_m, density_kgpm3, initial);
}

// One upon the other, each turned about the vertical and shifted by up to `lean` of what keeps its
// centre over the brick below.
void stack(Scene& scene, Draw& draw, const ParameterValues& values) {
  const double lean = number(values, "lean");
  Eigen::Vector3d foot_m = Eigen::Vector3d::Zero();
  double reach_m = 0.0;
  for (int i = 0; i < count(values, "count"); ++i) {
    const Eigen::Vector3d edges_m = draw_edges_m(draw, values);
    Body body = draw_brick(draw, values, i, edges_m);
    const double turn_rad = lean * std::numbers::pi * draw.sign();
    const double shift_m = lean * reach_m * draw.sign();
    foot_m.x() += shift_m;
    body.initial.position_m = foot_m + Eigen::Vector3d(0.0, 0.0, 0.5 * edges_m.z());
    body.initial.orientation = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ());
    add_brick(scene, std::move(body));
    foot_m.z() += edges_m.z() + number(values, "gap_m");
    reach_m = 0.5 * std::min(edges_m.x(), edges_m.y());
  }
}

// A cubic lattice of cells that hold the largest brick in any attitude; a pile is turned at random
// and stands on the ground cell upon cell, a lattice is straight.
void lattice(Scene& scene, Draw& draw, const ParameterValues& values, bool turned) {
  const int bricks = count(values, "count");
  const Eigen::Vector3d largest_m = size_m(values, "brick") * (1.0 + number(values, "size_spread"));
  const Eigen::Vector3d cell_m =
      (turned ? Eigen::Vector3d::Constant(largest_m.norm()) : largest_m).array() +
      number(values, "gap_m");
  const int side = std::max(1, static_cast<int>(std::floor(std::cbrt(bricks) + 1e-9)));
  for (int i = 0; i < bricks; ++i) {
    const Eigen::Vector3d place(i % side - 0.5 * (side - 1), i / side % side - 0.5 * (side - 1),
                                i / (side * side) + 0.5);
    Body body = draw_brick(draw, values, i, draw_edges_m(draw, values));
    if (turned) body.initial.orientation = draw.attitude();
    body.initial.position_m = cell_m.cwiseProduct(place);
    add_brick(scene, std::move(body));
  }
}

Expected<Scene> make(const ParameterValues& values) {
  Scene scene;
  scene.world.gravity_mps2 = {0.0, 0.0, -number(values, "gravity_mps2")};
  scene.world.law = contact_law(values);
  if (flag(values, "ground")) scene.world.bodies.push_back(ground_plane());
  Draw draw(static_cast<std::uint64_t>(count(values, "seed")));
  const std::string& arrangement = word(values, "arrangement");
  if (arrangement == "stack") {
    stack(scene, draw, values);
  } else {
    lattice(scene, draw, values, arrangement == "pile");
  }
  scene.length_scale_m = std::numeric_limits<double>::infinity();
  for (const std::size_t index : scene.bricks) {
    scene.length_scale_m =
        std::min(scene.length_scale_m, thickness_m(scene.world.bodies[index].shape));
  }
  return scene;
}

}  // namespace

Scenario assembly() {
  return {
      .name = "assembly",
      .meaning =
          "Bricks of random sizes, densities and velocities, in a pile of random attitudes, a "
          "leaning stack or a straight lattice: no answer is known, every law must hold.",
      .duration_s = 1.0,
      .parameters = joined(
          {{choice_parameter(
                "arrangement", {"pile", "stack", "lattice"},
                "pile: turned at random; stack: one upon the other; lattice: straight"),
            count_parameter("count", 8, 1, 1000, "bricks"),
            count_parameter("seed", 1, 1, 1000000, "of everything that is random in the scene"),
            number_parameter("size_spread", "1", 0.5, 0.0, 10.0,
                             "edges differ by up to this factor plus 1 from the brick's"),
            number_parameter("density_spread", "1", 0.0, 0.0, 1000.0,
                             "densities differ by up to this factor plus 1"),
            number_parameter("lean", "1", 0.5, 0.0, 1.0,
                             "stack: shift and turn, 1 for the farthest that may stand"),
            number_parameter("gap_m", "m", 0.0, 0.0, 10.0, "between cells, or bricks of a stack"),
            number_parameter("speed_mps", "m/s", 0.0, 0.0, 1000.0,
                             "largest component of the random velocities"),
            number_parameter("spin_radps", "rad/s", 0.0, 0.0, 1000.0,
                             "largest component of the random spins"),
            flag_parameter("ground", true, "a fixed plane at z = 0"),
            number_parameter("gravity_mps2", "m/s2", k_standard_gravity_mps2, 0.0, 100.0,
                             "downward acceleration")},
           size_parameters("brick", {0.2, 0.1, 0.1}),
           {density_parameter()},
           contact_parameters(0.5, 0.0)}),
      .make = make};
}

}  // namespace brickbench
