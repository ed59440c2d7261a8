// Passages: whatever jumps or sinks through another body is told; what bounces, slides, rolls,
// grazes or spins is not.
#include "experiments/metrics/passages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "adapters/seam/shape.hpp"
#include "tests/unit/metrics/metric_runs.hpp"

namespace brickbench::testing {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Poses = std::function<std::vector<State>(double time_s)>;

constexpr double k_pi = 3.14159265358979323846;

Body shaped(const std::string& name, Shape shape, bool fixed = false) {
  return fixed ? fixed_body(name, shape) : solid_body(name, shape, 1000.0);
}

State placed_at(const Vector3d& position_m) {
  State state;
  state.position_m = position_m;
  return state;
}

// The image of the run in a frame that is turned and shifted at random: nothing about it may
// depend on the frame.
Poses turned(const Poses& poses, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Quaterniond turn =
      Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
  const Vector3d shift_m(normal(random), normal(random), normal(random));
  return [=](double time_s) {
    std::vector<State> states = poses(time_s);
    for (State& state : states) {
      state.position_m = turn * state.position_m + shift_m;
      state.orientation = turn * state.orientation;
      state.angular_velocity_radps = turn * state.angular_velocity_radps;
    }
    return states;
  };
}

// The passages of a run, as "body through other" of the first one; empty: none.
std::string first_passage(const std::vector<Body>& bodies, const Poses& poses, double step_s,
                          std::size_t steps, std::size_t* when = nullptr) {
  World world;
  world.bodies = bodies;
  Passages passages(world, step_s);
  for (std::size_t step = 0; step <= steps; ++step) {
    const auto& found = passages.observe(poses(step_s * static_cast<double>(step)));
    if (found.empty()) continue;
    if (when != nullptr) *when = step;
    return bodies[found.front().body].name + " through " + bodies[found.front().through].name;
  }
  return "";
}

const std::vector<Shape>& thrown_shapes() {
  static const std::vector<Shape> shapes = {
      SphereShape{0.05}, SphereShape{0.3}, BoxShape{{0.1, 0.05, 0.05}}, BoxShape{{0.05, 0.2, 0.3}}};
  return shapes;
}

// A plate across x, 2 m x 2 m and 0.1 m thick, and a body thrown along x, which in the world of
// this test nothing stops.
TEST(Passages, AreToldWhereverABodyFliesThroughAPlate) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> within(-0.9, 0.9);
  for (const Shape& thrown : thrown_shapes()) {
    for (const double speed_mps : {0.5, 7.0, 60.0, 100.0, 900.0}) {
      for (const double step_s : {1e-3, 1.0 / 60.0}) {
        const Vector3d start_m(-1.0 - speed_mps * step_s, within(random), within(random));
        const Poses poses = turned(
            [=](double time_s) {
              return std::vector<State>{placed_at(start_m + Vector3d(speed_mps * time_s, 0, 0)),
                                        placed_at({0, 0, 0})};
            },
            random);
        const auto steps = static_cast<std::size_t>(3.0 / (speed_mps * step_s)) + 3;
        const std::string found =
            first_passage({shaped("thrown", thrown), shaped("plate", BoxShape{{0.05, 1, 1}}, true)},
                          poses, step_s, steps);
        EXPECT_NE(found, "") << thrown.index() << " at " << speed_mps << " m/s, " << step_s << " s";
      }
    }
  }
}

TEST(Passages, AreToldOfTheJointBetweenTwoBricks) {
  const std::vector<Body> bodies = {shaped("thrown", BoxShape{{0.1, 0.05, 0.05}}),
                                    shaped("lower", BoxShape{{0.05, 0.1, 0.05}}),
                                    shaped("upper", BoxShape{{0.05, 0.1, 0.05}})};
  const Poses poses = [](double time_s) {
    return std::vector<State>{placed_at({-1.0 + 100.0 * time_s, 0, 0}), placed_at({0, 0, -0.05}),
                              placed_at({0, 0, 0.05})};
  };
  std::size_t when = 0;
  EXPECT_NE(first_passage(bodies, poses, 1.0 / 60.0, 3, &when), "");
  EXPECT_EQ(when, 1U);
}

TEST(Passages, AreToldOfWhatSinksIntoTheGround) {
  for (const double speed_mps : {0.01, 1.0, 30.0}) {
    const Poses poses = [=](double time_s) {
      return std::vector<State>{placed_at({0, 0, 0.1 - speed_mps * time_s}), placed_at({0, 0, 0})};
    };
    const double step_s = 0.004;
    const auto steps = static_cast<std::size_t>(0.4 / (speed_mps * step_s)) + 2;
    for (const Body& ground : {ground_plane(), fixed_body("ground", BoxShape{{5, 5, 0.5}})}) {
      const bool box = !is_half_space(ground.shape);
      const Poses down = [=](double time_s) {
        auto states = poses(time_s);
        if (box) states[1].position_m.z() = -0.5;
        return states;
      };
      std::size_t when = 0;
      EXPECT_EQ(first_passage({shaped("brick", BoxShape{{0.1, 0.05, 0.05}}), ground}, down, step_s,
                              steps, &when),
                "brick through " + ground.name);
      // Told when the centre is as deep as the inscribed radius, within a look.
      const double depth_m = speed_mps * step_s * static_cast<double>(when) - 0.1;
      EXPECT_GE(depth_m, 0.05 - 1e-12);
      EXPECT_LE(depth_m, 0.05 + 0.0125 + 2.0 * speed_mps * step_s);
    }
  }
}

// Elastic bounces of every speed, seen at the ends of steps alone.
TEST(Passages, AreNoneWhereABodyBounces) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const double speed_mps : {0.1, 3.0, 40.0, 500.0}) {
    for (int trial = 0; trial < 50; ++trial) {
      const double slide_mps = speed_mps * unit(random);
      const double y_m = unit(random);
      const Poses poses = turned(
          [=](double time_s) {
            const double free_m = -1.0 + speed_mps * time_s;
            const double x_m = free_m > -0.15 ? -0.3 - free_m : free_m;
            return std::vector<State>{placed_at({x_m, y_m + slide_mps * time_s, 0}),
                                      placed_at({0, 0, 0})};
          },
          random);
      EXPECT_EQ(first_passage({shaped("ball", SphereShape{0.1}),
                               shaped("plate", BoxShape{{0.05, 1, 1}}, true)},
                              poses, 1.0 / 60.0, 60),
                "");
    }
  }
}

// A ball that moves along the rounded outline of a box: faces, edges, at every speed up to a
// quarter turn about an edge per step.
TEST(Passages, AreNoneWhereABallRollsRoundABox) {
  std::mt19937 random(13);
  for (const double radius_m : {0.01, 0.05, 0.2}) {
    for (const double speed_mps : {0.2, 1.0, 3.0}) {
      const double half_m = 0.5;
      const double corner_m = 0.5 * k_pi * radius_m;
      const double step_s = 0.9 * corner_m / std::max(speed_mps, 0.2);
      const double round_m = 4.0 * (2.0 * half_m + corner_m);
      const Poses poses = turned(
          [=](double time_s) {
            double way_m = std::fmod(speed_mps * time_s, round_m);
            const double side_m = 2.0 * half_m + corner_m;
            const double quarter = std::floor(way_m / side_m);
            way_m -= quarter * side_m;
            Vector3d place_m(-half_m + std::min(way_m, 2.0 * half_m), half_m + radius_m, 0);
            if (way_m > 2.0 * half_m) {
              const double angle = (way_m - 2.0 * half_m) / radius_m;
              place_m = Vector3d(half_m + radius_m * std::sin(angle),
                                 half_m + radius_m * std::cos(angle), 0);
            }
            const Eigen::AngleAxisd turn(-0.5 * k_pi * quarter, Vector3d::UnitZ());
            return std::vector<State>{placed_at(turn * place_m), placed_at({0, 0, 0})};
          },
          random);
      EXPECT_EQ(first_passage({shaped("ball", SphereShape{radius_m}),
                               shaped("box", BoxShape{{half_m, half_m, 0.4}})},
                              poses, step_s, 400),
                "")
          << radius_m << ' ' << speed_mps;
    }
  }
}

// Straight flights past a long brick that turns at any rate: never nearer than both reach.
TEST(Passages, AreNoneWhereBodiesSpinAndFlyPastEachOther) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::uniform_real_distribution<double> exponent(-1.0, 4.0);
  const Vector3d half_m(0.3, 0.05, 0.03);
  for (int trial = 0; trial < 400; ++trial) {
    const double spin_radps = std::pow(10.0, exponent(random));
    const double speed_mps = std::pow(10.0, 0.5 * exponent(random));
    const Vector3d axis = Vector3d(unit(random), unit(random), unit(random)).normalized();
    const double miss_m = half_m.norm() + 0.1 * (1.001 + std::abs(unit(random)));
    const Poses poses = turned(
        [=](double time_s) {
          State brick = placed_at({0, 0, 0});
          brick.orientation = Eigen::AngleAxisd(spin_radps * time_s, axis);
          brick.angular_velocity_radps = spin_radps * axis;
          return std::vector<State>{placed_at({-1.0 + speed_mps * time_s, miss_m, 0}), brick};
        },
        random);
    EXPECT_EQ(first_passage({shaped("ball", SphereShape{0.1}), shaped("brick", BoxShape{half_m})},
                            poses, 1.0 / 60.0, 200),
              "")
        << spin_radps << " rad/s " << speed_mps << " m/s";
  }
}

// The other way round: a brick that turns about a body that it would have to cut, and does.
TEST(Passages, AreToldOfABrickThatTurnsThroughABall) {
  const Poses poses = [](double time_s) {
    State brick = placed_at({0, 0, 0});
    brick.orientation = Eigen::AngleAxisd(40.0 * time_s, Vector3d::UnitZ());
    brick.angular_velocity_radps = {0, 0, 40.0};
    return std::vector<State>{placed_at({0, 0.4, 0}), brick};
  };
  const std::vector<Body> bodies = {shaped("ball", SphereShape{0.05}),
                                    shaped("brick", BoxShape{{0.6, 0.05, 0.05}})};
  EXPECT_EQ(first_passage(bodies, poses, 1.0 / 60.0, 30), "ball through brick");
}

TEST(Passages, AreNoneInSoftContactThatGivesWay) {
  for (const double share : {0.0, 0.3, 0.49, 0.9}) {
    const Poses poses = [=](double time_s) {
      const double deep_m = share * 0.05 * std::sin(20.0 * time_s);
      return std::vector<State>{placed_at({0.3 * time_s, 0, 0.05 - std::abs(deep_m)}),
                                placed_at({0, 0, -0.05})};
    };
    EXPECT_EQ(first_passage({shaped("brick", BoxShape{{0.1, 0.05, 0.05}}),
                             shaped("lower", BoxShape{{0.3, 0.05, 0.05}})},
                            poses, 0.01, 200),
              "")
        << share;
  }
}

}  // namespace
}  // namespace brickbench::testing
