// Fixed bodies push, within the cone of friction, where they touch: docs/hunt.md, section push.
#include <algorithm>

#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"

namespace brickbench::hunt {
namespace {

// Of the momentum that contacts gave in the step.
constexpr double k_push_share = 0.1;
// Of the weights times the step: what a solver that was stopped early may leave.
constexpr double k_weight_share = 0.05;
// Of the momenta: what rounding leaves of a step in double precision.
constexpr double k_double_rounding = 1e-9;
// A square of friction reaches this much farther than the circle in it.
constexpr double k_square_reach = 1.4142135623730951;

}  // namespace

std::optional<Breach> push_breach(const Motion& motion) {
  World world = motion.scene.world;
  if (!has_fixed(world)) return std::nullopt;
  if (!motion.scheme || motion.scheme->friction != FrictionSet::circle) {
    world.law.friction *= k_square_reach;
    for (PairLaw& pair : world.exceptions) pair.law.friction *= k_square_reach;
  }
  double weight_ns = 0.0;
  for (const Body& body : world.bodies) {
    if (!body.fixed) weight_ns += body.mass_kg * world.gravity_mps2.norm() * motion.step_s;
  }
  const bool single = motion.single;
  const double rounding = single ? k_single_rounding : k_double_rounding;
  Worst worst;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    const gate::StepRecord record = motion.record(n);
    double size_ns = 0.0;
    double moving_ns = 0.0;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Body& body = world.bodies[i];
      if (body.fixed) continue;
      size_ns += (body.mass_kg * (record.after[i].velocity_mps - record.before[i].velocity_mps) -
                  motion.step_s * (body.mass_kg * world.gravity_mps2 + record.wrenches[i].force_n))
                     .norm();
      moving_ns += body.mass_kg * fastest_point_mps(body, record.before[i]);
    }
    const double rounding_ns = rounding * (moving_ns + weight_ns);
    if (size_ns <= rounding_ns) continue;
    const double allowed_ns = k_push_share * size_ns + k_weight_share * weight_ns + rounding_ns;
    const double excess_ns = gate::external_excess_ns(world, record, 0.1 * allowed_ns);
    worst.see({"push", excess_ns, allowed_ns, "N s", n + 1, 0.0, ""});
  }
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
