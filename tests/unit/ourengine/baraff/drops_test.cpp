// Dropped bricks of every restitution, size, height and tilt: no contact is lost while overlaps are
// moved apart, and what is left at the end is the energy that the scheme must show.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ourengine/baraff/simulator.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/baraff/scenes.hpp"

namespace ourengine::baraff {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;

constexpr double k_fall_mps2 = 9.81;
constexpr double k_drop_step_s = 0.001;
constexpr Tolerance k_created{"energy_share", 4e-15, 9.9e-16, "rounding of one impulse"};
constexpr Tolerance k_risen{"rise_m", 1e-12, 8.9e-14, "rounding of 3000 steps"};
constexpr Tolerance k_above_rest{"energy_above_rest_m", 4e-5, 3.4e-6,
                                 "hits slower than two steps of gravity, (2 g h)^2 / 2 g = 2e-5 m"};

#ifdef NDEBUG
constexpr std::array k_heights_m = {0.05, 0.5, 2.0};
#else
constexpr std::array k_heights_m = {0.5};
#endif

struct Drop {
  double size_m;
  double height_m;
  double tilt_rad;
  double restitution;

  std::string name() const {
    return "size " + std::to_string(size_m) + " height " + std::to_string(height_m) + " tilt " +
           std::to_string(tilt_rad) + " e " + std::to_string(restitution);
  }
};

// (corner): where the corners of a brick are and how fast they move, along z.
struct Corners {
  std::array<double, 8> gap_m;
  std::array<double, 8> speed_mps;

  double lowest_m() const { return *std::ranges::min_element(gap_m); }
};
Corners corners_of(const RigidBody& body) {
  Corners corners{};
  for (std::size_t k = 0; k < 8; ++k) {
    const Eigen::Vector3d sign(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    const Eigen::Vector3d at =
        body.position_m + body.rotation * sign.cwiseProduct(std::get<Box>(body.solid).half_m);
    corners.gap_m[k] = at.z();
    corners.speed_mps[k] = velocity_of_point_on_body(body, at).z();
  }
  return corners;
}

double energy_of(const RigidBody& body) {
  return 0.5 * body.linear_momentum_ns.dot(body.velocity_mps) +
         0.5 * body.angular_momentum_nms.dot(body.angular_velocity_radps) +
         body.mass_kg * k_fall_mps2 * body.position_m.z();
}

class Drops : public ::testing::Test {
 protected:
  // Steps a drop for the duration; `see` gets each step: corners before, report, body after.
  template <typename See>
  RigidBody fall(const Drop& drop, double duration_s, const Options& options, const See& see) {
    std::vector<RigidBody> bodies = {
        make_fixed_body(Plane{}),
        testing::brick(drop.size_m * Eigen::Vector3d(1.0, 0.5, 0.325), {0, 0, 0})};
    bodies[1].orientation =
        Eigen::AngleAxisd(drop.tilt_rad, Eigen::Vector3d(1, 2, 0.5).normalized());
    compute_derived(bodies[1]);
    bodies[1].position_m.z() = drop.height_m - corners_of(bodies[1]).lowest_m();
    Simulator simulator(bodies, RestitutionTable::Constant(1, 1, drop.restitution), options);
    for (int i = 0; i < duration_s / k_drop_step_s; ++i) {
      const Corners before = corners_of(simulator.bodies()[1]);
      const StepReport& report = simulator.step();
      see(before, report, simulator.bodies()[1]);
    }
    return simulator.bodies()[1];
  }
};

std::vector<Drop> drops() {
  std::vector<Drop> all;
  for (const double size_m : {0.01, 0.1, 1.0, 10.0}) {
    for (const double height_m : k_heights_m) {
      for (const double tilt_rad : {0.0, 0.3}) {
        for (int tenth = 0; tenth <= 10; ++tenth) {
          all.push_back({size_m, height_m, tilt_rad, 0.1 * tenth});
        }
      }
    }
  }
  return all;
}

// After a step no corner that touched approaches: an impulse has met it, whatever overlap was
// undone in the same step. What a corner may keep is the threshold, a step of the acceleration of
// the far end of a brick that pivots about another corner, at most 4 g, and what the turn of the
// step adds to its speed: some w^2 r h. Of steps that are not cut: after its first piece another
// corner may turn the brick back.
TEST_F(Drops, MeetEveryCornerThatTouches) {
  Options whole_steps;
  whole_steps.depth_share = 0.0;
  const double threshold_mps = Options{}.collision_velocity_mps;
  for (const Drop& drop : drops()) {
    double worst = 0.0;
    fall(drop, 1.0, whole_steps,
         [&](const Corners& before, const StepReport& report, const RigidBody& body) {
           ASSERT_FALSE(report.unsolved) << drop.name();
           const Corners after = corners_of(body);
           const double reach_m = std::get<Box>(body.solid).half_m.norm();
           const double turning_mps =
               body.angular_velocity_radps.squaredNorm() * reach_m * k_drop_step_s;
           const double allowed_mps =
               threshold_mps + 4.0 * (k_fall_mps2 * k_drop_step_s + turning_mps);
           for (std::size_t k = 0; k < 8; ++k) {
             if (before.gap_m[k] <= 0.0) worst = std::max(worst, -after.speed_mps[k] / allowed_mps);
           }
         });
    EXPECT_LE(worst, 1.0) << drop.name();
  }
}

// Flight keeps the energy and impulses never add any. A move lifts a brick by no more than its
// overlap, and only one that rests or was just stopped: what the hit took is more.
TEST_F(Drops, EndWithTheEnergyThatRestitutionLeaves) {
  Worst created, risen, rest;
  int at_rest = 0;
  for (const Drop& drop : drops()) {
    double start_j = 0.0;
    double highest_j = 0.0;
    double weight_n = 0.0;
    const RigidBody end = fall(
        drop, 3.0, Options{}, [&](const Corners&, const StepReport& report, const RigidBody& body) {
          weight_n = body.mass_kg * k_fall_mps2;
          if (start_j == 0.0) start_j = energy_of(body);
          highest_j = std::max(highest_j, energy_of(body));
          created.see(std::max(0.0, report.collision_energy_j) / start_j, drop.name());
        });
    risen.see((highest_j - start_j) / weight_n, drop.name());
    const double lowest_m = corners_of(end).lowest_m();
    const double above_m = energy_of(end) / weight_n - (end.position_m.z() - lowest_m);
    if (drop.restitution <= 0.51) {
      rest.see(above_m, drop.name());
      ++at_rest;
    }
  }
  EXPECT_GT(at_rest, 40);
  EXPECT_TRUE(created.within(k_created));
  EXPECT_TRUE(risen.within(k_risen));
  EXPECT_TRUE(rest.within(k_above_rest));
}

}  // namespace
}  // namespace ourengine::baraff
