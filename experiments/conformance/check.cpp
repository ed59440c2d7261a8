#include "experiments/conformance/check.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "adapters/seam/shape.hpp"

namespace brickbench::conformance {

Expected<std::unique_ptr<Simulation>> Subject::build(const World& world, double step_s) const {
  Settings settings;
  settings.step_s = step_s;
  settings.variant = variant;
  return brickbench::build(adapter, world, settings);
}

std::vector<Check> all_checks() {
  std::vector<Check> all;
  for (const auto& part :
       {motion_checks(), contact_checks(), repetition_checks(), bookkeeping_checks()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

State at(double x, double y, double z) {
  State state;
  state.position_m = {x, y, z};
  return state;
}

Verdict passed() { return {}; }
Verdict failed(std::string detail) { return {Outcome::failed, std::move(detail)}; }

Verdict within(const Worst& worst, const Tolerance& tolerance) {
  if (worst.empty()) return failed(fmt::format("{}: nothing was compared", tolerance.name));
  const double allowed = tolerance.value * tolerance_scale();
  return {worst.residual() <= allowed ? Outcome::passed : Outcome::failed,
          fmt::format("{}: residual {} against {} ({}) at {}", tolerance.name, worst.residual(),
                      allowed, tolerance.derivation, worst.where())};
}

Verdict guarded(const std::function<Verdict()>& body) {
  try {
    return body();
  } catch (const Stop& stop) {
    return stop.verdict;
  } catch (const std::exception& error) {
    return failed(fmt::format("an exception left the engine: {}", error.what()));
  }
}

namespace {

[[noreturn]] void stop_on(const Failure& failure, bool may_refuse, const std::string& where) {
  const bool refused = may_refuse && failure.fault == Fault::unsupported && !failure.reason.empty();
  throw Stop{{refused ? Outcome::refused : Outcome::failed,
              fmt::format("{} {}: {}", where, to_outcome(failure.fault), failure.reason)}};
}

}  // namespace

std::unique_ptr<Simulation> must_build(const Subject& subject, const World& world, double step_s,
                                       bool may_refuse) {
  auto built = subject.build(world, step_s);
  // Boxes are what every engine has; balls may be refused.
  const bool balls =
      std::ranges::any_of(world.bodies, [](const Body& body) { return is_round(body.shape); });
  if (!built) stop_on(built.error(), may_refuse || balls, "building");
  return std::move(*built);
}

States read(const Simulation& simulation, const World& world) {
  States states(world.bodies.size());
  simulation.read(states);
  return states;
}

States step_and_read(Simulation& simulation, const World& world, bool may_refuse) {
  if (auto stepped = simulation.step(); !stepped) stop_on(stepped.error(), may_refuse, "stepping");
  States states = read(simulation, world);
  if (!std::ranges::all_of(states, is_finite)) throw Stop{failed("a state is not finite")};
  return states;
}

States run(const Subject& subject, const World& world, double step_s, int steps, bool may_refuse,
           const std::function<void(int, const States&)>& watch) {
  const auto simulation = must_build(subject, world, step_s, may_refuse);
  States states = read(*simulation, world);
  for (int k = 1; k <= steps; ++k) {
    states = step_and_read(*simulation, world, may_refuse);
    if (watch) watch(k, states);
  }
  return states;
}

}  // namespace brickbench::conformance
