// Oracles: laws that every motion must obey, judged from states, wrenches and World alone. None
// needs a truth, none shares code with an engine. docs/hunt.md derives each bound.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/hunt/motion.hpp"

namespace brickbench::hunt {

// One law broken in one motion, where it was broken most.
struct Breach {
  std::string oracle;  // its name in the list below
  double observed = 0.0;
  double allowed = 0.0;  // the most that the law and the stated scheme admit
  std::string unit;
  std::size_t step = 0;  // after which it shows, from 1
  double time_s = 0.0;
  std::string bodies;  // whom it concerns: "a" or "a, b"; empty: all together

  // How many times too large.
  double excess() const { return allowed > 0.0 ? observed / allowed : observed; }
};

// Kinetic and potential energy above that of the start and the work from outside, J.
std::optional<Breach> energy_breach(const Motion& motion);

// Carnot's theorem for the impulses of one step, J: what the pushes of contacts give at the
// velocity after them, restitution counted, is never positive.
std::optional<Breach> impact_breach(const Motion& motion);

// Momentum of all bodies that neither gravity nor wrenches gave, N s; worlds without fixed bodies.
std::optional<Breach> momentum_breach(const Motion& motion);
// ... and angular momentum about the common centre, N m s.
std::optional<Breach> spin_breach(const Motion& motion);

// Depth, m, of the deepest overlap beyond the way of one step.
std::optional<Breach> overlap_breach(const Motion& motion);

// A body that has gone through another between two steps, or lies wholly behind a plane: how deep
// it was inside on its way, m.
std::optional<Breach> passage_breach(const Motion& motion);

// One brick that slides on a fixed body with less than Coulomb's friction, as a share of it: creep.
std::optional<Breach> friction_breach(const Motion& motion);

// ... or lies on it and is held by more than that, N s summed over the run.
std::optional<Breach> cone_breach(const Motion& motion);

// Momentum, N s, that the fixed bodies gave in one step though no contact inside its cone could.
std::optional<Breach> push_breach(const Motion& motion);

// Way, m, that a body went over the whole run beside that of its velocities.
std::optional<Breach> kinematics_breach(const Motion& motion);

struct OracleInfo {
  std::string_view name;
  std::string_view law;                                            // one line: what is demanded
  std::optional<Breach> (*judge)(const Motion& motion) = nullptr;  // nullptr: needs more runs
};

// All of them, those that need further runs of the engine included, in the order of the tables.
const std::vector<OracleInfo>& oracles();

}  // namespace brickbench::hunt
