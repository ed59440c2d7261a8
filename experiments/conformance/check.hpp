// The rules of the seam as checks: functions from an engine to a verdict, so that the same code
// judges real engines and deliberately wrong ones.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "adapters/seam/adapter.hpp"
#include "experiments/conformance/tolerance.hpp"

namespace brickbench::conformance {

enum class Outcome {
  passed,
  failed,
  refused,  // the engine said Fault::unsupported with a reason, and the rule allows that
  no_view,  // the engine does not offer the view that the rule is about
};

struct Verdict {
  Outcome outcome = Outcome::passed;
  std::string detail;
};

// An engine with a chosen variant.
struct Subject {
  Adapter adapter;
  std::string variant;

  Expected<std::unique_ptr<Simulation>> build(const World& world, double step_s) const;
};

struct Check {
  std::string name;
  std::string rule;  // one line
  Verdict (*run)(const Subject&) = nullptr;
};

std::vector<Check> motion_checks();       // frames, order, units, step length, forces
std::vector<Check> contact_checks();      // friction, restitution, contacts
std::vector<Check> repetition_checks();   // equal runs, set-state
std::vector<Check> bookkeeping_checks();  // audit, refusals
std::vector<Check> all_checks();

// ---- what checks are made of ----

inline constexpr double k_step_s = 0.001;

// At rest, upright.
State at(double x, double y, double z);

using States = std::vector<State>;

// Ends a check early; caught by guarded().
struct Stop {
  Verdict verdict;
};

// Runs the body of a check; a Stop, or an exception out of the engine, becomes the verdict.
Verdict guarded(const std::function<Verdict()>& body);

// Builds. A refusal stops the check: as `refused` if `may_refuse` and it is Fault::unsupported with
// a reason, else as failed. A world with balls may always be refused.
std::unique_ptr<Simulation> must_build(const Subject& subject, const World& world, double step_s,
                                       bool may_refuse);

States read(const Simulation& simulation, const World& world);

// One step, then the states; stops the check where the engine fails or a state is not finite.
States step_and_read(Simulation& simulation, const World& world, bool may_refuse);

// Builds, runs, and calls `watch(step, states)` after every step, counted from 1.
States run(const Subject& subject, const World& world, double step_s, int steps, bool may_refuse,
           const std::function<void(int, const States&)>& watch = {});

Verdict within(const Worst& worst, const Tolerance& tolerance);
Verdict passed();
Verdict failed(std::string detail);

}  // namespace brickbench::conformance
