// The independent depth: hand cases, closed forms, symmetries, libccd's EPA, and the whole-world
// search against all pairs.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "experiments/metrics/body_depths.hpp"
#include "experiments/metrics/deepest_overlap.hpp"
#include "experiments/metrics/penetration_depth.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/metrics/metric_runs.hpp"

namespace brickbench::testing {
namespace {

constexpr Tolerance k_depth_rounding{"rounding of a depth (m)", 2e-14, 2.1e-15,
                                     "projections of metres, rounded to 1.1e-16 each"};

State at(const Eigen::Vector3d& position_m,
         const Eigen::Quaterniond& orientation = Eigen::Quaterniond::Identity()) {
  State state;
  state.position_m = position_m;
  state.orientation = orientation;
  return state;
}

Eigen::Quaterniond turned(double angle_rad, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis.normalized()));
}

const Shape k_cube = BoxShape{{0.5, 0.5, 0.5}};
const Shape k_ball = SphereShape{0.5};

TEST(PenetrationDepth, MatchesHandCases) {
  using std::numbers::pi;
  const double diagonal = std::sqrt(0.5);  // of a unit cube's face, halved
  const Eigen::Quaterniond on_edge = turned(pi / 4, {1, 0, 0});
  const Eigen::Quaterniond on_edge_across = turned(pi / 4, {0, 1, 0});
  const Eigen::Quaterniond on_corner =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(0, 0, -1));
  const double corner = std::sqrt(0.75);
  struct Case {
    const char* what;
    Shape a;
    State at_a;
    Shape b;
    State at_b;
    double expected_m;
  };
  const std::vector<Case> cases = {
      {"face on face", k_cube, at({0, 0, 0}), k_cube, at({0, 0, 0.9}), 0.1},
      {"exact touch", k_cube, at({0, 0, 0}), k_cube, at({0, 0, 1.0}), 0.0},
      {"apart", k_cube, at({0, 0, 0}), k_cube, at({0, 1.5, 0}), 0.0},
      {"vertex in face", k_cube, at({0, 0, 0}), k_cube, at({0, 0, 0.5 + corner - 0.01}, on_corner),
       0.01},
      {"edge on edge", k_cube, at({0, 0, 0}, on_edge), k_cube,
       at({0, 0, 2 * diagonal - 0.02}, on_edge_across), 0.02},
      {"contained", k_cube, at({0, 0, 0}), BoxShape{{0.1, 0.1, 0.1}}, at({0.2, 0, 0}), 0.4},
      {"same place", k_cube, at({0, 0, 0}), k_cube, at({0, 0, 0}), 1.0},
      {"ball on face", k_cube, at({0, 0, 0}), k_ball, at({0, 0, 0.97}), 0.03},
      {"ball at corner", k_cube, at({0, 0, 0}), k_ball, at(Eigen::Vector3d::Constant(0.7)),
       0.5 - std::sqrt(0.12)},
      {"ball's centre inside", k_cube, at({0, 0, 0}), k_ball, at({0.3, 0.1, 0}), 0.7},
      {"balls", k_ball, at({0, 0, 0}), k_ball, at({0.6, 0, 0}), 0.4},
      {"brick in plane", PlaneShape{}, at({0, 0, 0}), k_cube, at({7, 3, diagonal - 0.01}, on_edge),
       0.01},
      {"brick on plane", PlaneShape{}, at({0, 0, 2}), k_cube, at({7, 3, 2.5}), 0.0},
      {"ball in plane", PlaneShape{}, at({0, 0, 0}), k_ball, at({1, 1, -1}), 1.5},
      {"ball in a wall", PlaneShape{}, at({0, 0, 0}, turned(pi / 2, {0, 1, 0})), k_ball,
       at({0.4, 9, 9}), 0.1}};
  Worst worst;
  for (const Case& one : cases) {
    worst.see(penetration_depth_m(one.a, one.at_a, one.b, one.at_b) - one.expected_m, one.what);
    worst.see(penetration_depth_m(one.b, one.at_b, one.a, one.at_a) - one.expected_m, one.what);
  }
  EXPECT_TRUE(worst.within(k_depth_rounding));
}

struct Random {
  std::mt19937_64 engine{20240229};
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  }
  Eigen::Vector3d vector(double low, double high) {
    return {uniform(low, high), uniform(low, high), uniform(low, high)};
  }
  Eigen::Quaterniond rotation() {
    std::normal_distribution<double> normal;
    return Eigen::Quaterniond(normal(engine), normal(engine), normal(engine), normal(engine))
        .normalized();
  }
  Shape shape() {
    if (uniform(0, 1) < 0.25) return SphereShape{uniform(0.05, 0.5)};
    return BoxShape{vector(0.05, 0.5)};
  }
};

TEST(PenetrationDepth, IgnoresOrderAndFrame) {
  constexpr Tolerance tolerance{"depth after a rigid motion (m)", 3e-14, 1.7e-15,
                                "cross products of nearly parallel edges lose 1/sine digits"};
  Random random;
  Worst worst;
  for (int n = 0; n < 20000; ++n) {
    const Shape a = random.shape();
    const Shape b = random.shape();
    const State at_a = at(random.vector(-0.3, 0.3), random.rotation());
    const State at_b = at(random.vector(-0.3, 0.3), random.rotation());
    const Eigen::Quaterniond turn = random.rotation();
    const Eigen::Vector3d shift_m = random.vector(-3, 3);
    const auto moved = [&](const State& s) {
      return at(turn * s.position_m + shift_m, turn * s.orientation);
    };
    const double depth_m = penetration_depth_m(a, at_a, b, at_b);
    worst.see(penetration_depth_m(b, at_b, a, at_a) - depth_m,
              "swapped, pair " + std::to_string(n));
    worst.see(penetration_depth_m(a, moved(at_a), b, moved(at_b)) - depth_m,
              "moved, pair " + std::to_string(n));
  }
  EXPECT_TRUE(worst.within(tolerance));
}

TEST(DeepestOverlap, FindsWhatAllPairsShow) {
  Random random;
  World world;
  world.bodies.push_back(ground_plane(-1.0));
  for (int i = 0; i < 60; ++i) {
    Body body = solid_body(std::to_string(i), random.shape(), 1000.0);
    body.fixed = i % 10 == 0;
    world.bodies.push_back(body);
  }
  DeepestOverlap search(world);
  Worst worst;
  int overlapping = 0;
  for (int step = 0; step < 400; ++step) {
    const double spread_m = step % 2 == 0 ? 1.5 : 4.0;
    std::vector<State> states(world.bodies.size());
    states[0] = world.bodies[0].initial;
    for (std::size_t i = 1; i < states.size(); ++i) {
      states[i] =
          at(random.vector(-spread_m, spread_m) + Eigen::Vector3d(0, 0, 4), random.rotation());
    }
    double deepest_m = 0.0;
    for (std::size_t i = 0; i < states.size(); ++i) {
      for (std::size_t j = i + 1; j < states.size(); ++j) {
        if (world.bodies[i].fixed && world.bodies[j].fixed) continue;
        deepest_m = std::max(deepest_m, penetration_depth_m(world.bodies[i].shape, states[i],
                                                            world.bodies[j].shape, states[j]));
      }
    }
    const Overlap found = search.find(states);
    worst.see(found.depth_m - deepest_m, "step " + std::to_string(step));
    if (found.depth_m > 0.0) {
      ++overlapping;
      const Body& a = world.bodies[found.body_a];
      const Body& b = world.bodies[found.body_b];
      worst.see(penetration_depth_m(a.shape, states[found.body_a], b.shape, states[found.body_b]) -
                    deepest_m,
                "the pair of step " + std::to_string(step));
    }
  }
  EXPECT_TRUE(worst.within(k_depth_rounding));
  EXPECT_GT(overlapping, 200);
}

// The deepest of all bodies is what the search over the world finds, and each body's depth is that
// of some pair of its own.
TEST(BodyDepths, AreThoseOfAllPairs) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::vector<Shape> shapes = {PlaneShape{}};
  std::vector<bool> fixed = {true};
  std::vector<State> states = {at({0, 0, -0.9})};
  for (int i = 0; i < 40; ++i) {
    shapes.push_back(i % 4 == 0 ? Shape{SphereShape{0.15}} : Shape{BoxShape{{0.2, 0.1, 0.15}}});
    fixed.push_back(i % 10 == 1);
    states.push_back(at({place(random), place(random), place(random)},
                        turned(3.0 * place(random), {place(random), place(random), 1.0})));
  }
  const std::vector<double> depths_m = body_depths_m(shapes, fixed, states);
  Worst worst;
  std::size_t deep = 0;
  for (std::size_t a = 0; a < shapes.size(); ++a) {
    double deepest_m = 0.0;
    for (std::size_t b = 0; b < shapes.size(); ++b) {
      if (a == b || (fixed[a] && fixed[b])) continue;
      deepest_m =
          std::max(deepest_m, penetration_depth_m(shapes[a], states[a], shapes[b], states[b]));
    }
    deep += deepest_m > 1e-3 ? 1U : 0U;
    worst.see(depths_m[a] - deepest_m, "body " + std::to_string(a));
  }
  EXPECT_TRUE(worst.within(k_depth_rounding));
  EXPECT_GT(deep, 20U);
}

// A brick sinks 1 um per step into another: max, mean, 99th percentile and end are arithmetic.
SyntheticRun sinking() {
  SyntheticRun run{.scene =
                       scene_of({test_brick("low"), test_brick("high", {0, 0, 0.1})}, {0, 0, 0})};
  run.states = [start = initial_states(run.scene)](std::size_t step) {
    auto states = start;
    states[1].position_m.z() -= 1e-6 * static_cast<double>(step);
    return states;
  };
  return run;
}

TEST(Penetration, ReportsMaximumMeanPercentileAndEnd) {
  const auto found = measure("penetration", sinking());
  EXPECT_NEAR(value(found, "penetration_max_m"), 1e-4, 1e-15);
  EXPECT_NEAR(value(found, "penetration_mean_m"), 50.5e-6, 1e-15);
  EXPECT_NEAR(value(found, "penetration_p99_m"), 99e-6, 0.0051 * 99e-6);
  EXPECT_NEAR(value(found, "penetration_final_m"), 1e-4, 1e-15);
  EXPECT_EQ(find(found, "penetration_max_m").note, "bodies 'low' and 'high' at 0.1 s");
}

TEST(Penetration, NoticesBodiesPutIntoEachOther) {
  SyntheticRun run = free_flight();
  EXPECT_EQ(value(measure("penetration", run), "penetration_max_m"), 0.0);
  run.states = [exact = run.states](std::size_t step) {
    auto states = exact(step);
    if (step == 3) states[1].position_m = states[0].position_m;
    return states;
  };
  const auto found = measure("penetration", run);
  EXPECT_GT(value(found, "penetration_max_m"), 0.09);
  EXPECT_EQ(value(found, "penetration_final_m"), 0.0);
}

}  // namespace
}  // namespace brickbench::testing
