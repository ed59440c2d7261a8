// What slides is held back by the whole of Coulomb's friction: docs/hunt.md, section friction.
#include <algorithm>
#include <cmath>

#include "adapters/seam/shape.hpp"
#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"

namespace brickbench::hunt {
namespace {

// Less than this share of Coulomb's friction along the whole way is creep.
constexpr double k_friction_share = 0.9;
// A way below this share of the smallest edge is not worth a word.
constexpr double k_way_share = 0.05;
// A body whose edges turn faster than this share of its speed rolls or tumbles.
constexpr double k_turning_share = 0.02;
// A push of more than so many weights times step is an impact, and a brick whose height changes by
// more than this share of a step's fall does not lie.
constexpr double k_resting_weights = 2.0;
constexpr double k_flat_share = 0.01;
// Friction beyond Coulomb's cone, of that on the cone: single bricks converge to rounding.
constexpr double k_cone_share = 0.002;

// The normal of the one fixed body's face on which the brick lies: that which is nearest to the
// impulse against gravity.
Eigen::Vector3d face_normal(const Body& ground, const Eigen::Vector3d& up) {
  const Eigen::Matrix3d axes = ground.initial.orientation.toRotationMatrix();
  if (is_half_space(ground.shape)) return axes.col(2);
  Eigen::Index best = 0;
  (axes.transpose() * up).cwiseAbs().maxCoeff(&best);
  return axes.col(best) * (axes.col(best).dot(up) < 0.0 ? -1.0 : 1.0);
}

// What the face that a brick lies on gave it along the way, where it slid without turning.
struct Sliding {
  double owed_j = 0.0;       // Coulomb's friction times the way
  double taken_j = 0.0;      // what the tangential impulses took
  double normal_ns = 0.0;    // sum of all pushes of the face while the brick lay on it
  double beyond_ns = 0.0;    // tangential impulses beyond the cone then
  double rounding_ns = 0.0;  // what rounding may have left of them
  double way_m = 0.0;
};

// nullopt where the world is not one brick under gravity, on one fixed body, with friction.
std::optional<Sliding> sliding_of(const Motion& motion) {
  const World& world = motion.scene.world;
  if (world.bodies.size() != 2 || moving_count(world) != 1) return std::nullopt;
  const std::size_t moving = world.bodies[0].fixed ? 1 : 0;
  const Body& brick = world.bodies[moving];
  const double g_mps2 = world.gravity_mps2.norm();
  const double friction = world.law.friction;
  if (g_mps2 == 0.0 || friction == 0.0) return std::nullopt;
  const Eigen::Vector3d normal =
      face_normal(world.bodies[1 - moving], -world.gravity_mps2 / g_mps2);
  const double fall_mps = g_mps2 * motion.step_s;
  Sliding sum;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    const State& before = motion.states[n][moving];
    const State& after = motion.states[n + 1][moving];
    const Eigen::Vector3d impulse_ns =
        brick.mass_kg * (after.velocity_mps - before.velocity_mps) -
        motion.step_s * (brick.mass_kg * world.gravity_mps2 + motion.wrenches[n][moving].force_n);
    const double pressed_ns = impulse_ns.dot(normal);
    const double held_ns = (impulse_ns - pressed_ns * normal).norm();
    const Eigen::Vector3d slip_mps = after.velocity_mps - after.velocity_mps.dot(normal) * normal;
    const double turning_mps = reach_m(brick.shape) * std::max(before.angular_velocity_radps.norm(),
                                                               after.angular_velocity_radps.norm());
    const double rounding_ns =
        (motion.single ? k_single_rounding : k_rounding) * brick.mass_kg *
        (fastest_point_mps(brick, before) + fastest_point_mps(brick, after) + fall_mps);
    const bool lies = pressed_ns > rounding_ns &&
                      pressed_ns < k_resting_weights * brick.mass_kg * fall_mps &&
                      std::abs(after.velocity_mps.dot(normal)) < k_flat_share * fall_mps;
    if (!lies) continue;
    sum.normal_ns += pressed_ns;
    sum.rounding_ns += rounding_ns;
    sum.beyond_ns += std::max(0.0, held_ns - friction * pressed_ns);
    if (turning_mps > k_turning_share * slip_mps.norm()) continue;
    sum.owed_j += friction * pressed_ns * slip_mps.norm();
    sum.taken_j += -impulse_ns.dot(slip_mps);
    sum.way_m += slip_mps.norm() * motion.step_s;
  }
  return sum;
}

}  // namespace

std::optional<Breach> friction_breach(const Motion& motion) {
  // A spring of finite stiffness holds friction too: such engines creep by their own statement.
  if (motion.scheme && motion.scheme->compliant()) return std::nullopt;
  const auto sliding = sliding_of(motion);
  if (!sliding || sliding->way_m < k_way_share * thinnest_m(motion.scene.world)) {
    return std::nullopt;
  }
  // Told as what is missing.
  Worst worst;
  worst.see({"friction", 1.0 - sliding->taken_j / sliding->owed_j, 1.0 - k_friction_share, "1",
             motion.steps(), 0.0, ""});
  return worst.breach(motion);
}

std::optional<Breach> cone_breach(const Motion& motion) {
  if (!motion.scheme || motion.scheme->friction != FrictionSet::circle) return std::nullopt;
  const auto sliding = sliding_of(motion);
  if (!sliding || sliding->normal_ns == 0.0) return std::nullopt;
  const double allowed_ns =
      k_cone_share * motion.scene.world.law.friction * sliding->normal_ns + sliding->rounding_ns;
  Worst worst;
  worst.see({"cone", sliding->beyond_ns, allowed_ns, "N s", motion.steps(), 0.0, ""});
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
