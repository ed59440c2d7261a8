#include "experiments/oracle/static_truth.hpp"

#include <cmath>
#include <vector>

namespace brickbench::gate {
namespace {

constexpr double k_balanced_share = 1e-6;  // of the weight: upper bound of "balanced"
constexpr double k_proven_share = 1e-5;    // lower bound of "cannot be balanced"

void scale_friction(World& world, double factor) {
  world.law.friction *= factor;
  for (PairLaw& pair : world.exceptions) pair.law.friction *= factor;
}

}  // namespace

StaticVerdict static_verdict(const World& world, const ContactRoom& room) {
  constexpr double unit_time_s = 1.0;  // forces times one second, as impulses
  std::vector<State> states;
  double weight_n = 0.0;
  for (const Body& body : world.bodies) {
    states.push_back(body.initial);
    if (!body.fixed) weight_n += body.mass_kg * world.gravity_mps2.norm();
  }
  const std::vector<Wrench> none(world.bodies.size());
  const ConeProblem problem = cone_problem(world, {states, states, none, unit_time_s}, room);
  const ConeSolution solution = solve(problem, 0.1 * k_balanced_share * weight_n * unit_time_s);
  const ConeBounds bounds = certify(problem, solution);
  StaticVerdict verdict;
  verdict.upper_share = bounds.upper_ns / (weight_n * unit_time_s);
  verdict.lower_share = bounds.lower_ns / (weight_n * unit_time_s);
  if (verdict.lower_share > k_proven_share) verdict.label = StaticLabel::falls;
  if (verdict.upper_share < k_balanced_share) verdict.label = StaticLabel::stands;
  return verdict;
}

bool robust(const World& world, StaticLabel label, const Margins& margins) {
  const bool stands = label == StaticLabel::stands;
  ContactRoom room = k_flush;
  room.border_share = stands ? -margins.border_share : margins.border_share;
  room.head_joints = !stands;
  for (int side = 0; side < 4; ++side) {
    World tilted = world;
    scale_friction(tilted, stands ? 1.0 - margins.friction_share : 1.0 + margins.friction_share);
    const double angle = side * M_PI_2;
    const Eigen::Vector3d axis(std::cos(angle), std::sin(angle), 0.0);
    tilted.gravity_mps2 = Eigen::AngleAxisd(margins.tilt_rad, axis) * world.gravity_mps2;
    if (static_verdict(tilted, room).label != label) return false;
  }
  return true;
}

}  // namespace brickbench::gate
