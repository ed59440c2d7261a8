// Step faults: what goes wrong inside a step, put on the states after it, which the engine goes on
// with.
#pragma once

#include <span>
#include <vector>

#include "adapters/seam/world.hpp"

namespace brickbench::testing {

// One step, for the fault to change.
struct SpoiledStep {
  const World& world;
  std::span<const State> before;
  std::vector<State>& after;
  std::span<const Wrench> wrenches;
  double step_s = 0.0;
  int& memory;  // of the fault, 0 at the start

  // Change of velocity, m/s, that neither gravity nor wrenches gave body i.
  double struck_mps(std::size_t i) const;
  // Whether any body was struck: by more than the fall of three steps and half a metre per second.
  bool is_hit() const;
  // The state of body i after a step without any contact.
  State free(std::size_t i) const;
};

// Each says whether it changed `after`.
bool plastic_is_elastic_once(SpoiledStep& s);
bool restitution_adds_energy(SpoiledStep& s);
bool bounce_gains_a_step(SpoiledStep& s);
bool contact_is_lost_when_moved_apart(SpoiledStep& s);
bool light_bricks_explode(SpoiledStep& s);
bool flies_to_1e33_m(SpoiledStep& s);
bool is_carried_to_1e33_m(SpoiledStep& s);
bool sinks_after_a_blow(SpoiledStep& s);
bool passes_at_a_hit(SpoiledStep& s);
bool nan_is_hidden(SpoiledStep& s);
bool creeps(SpoiledStep& s);
bool leaks_momentum(SpoiledStep& s);
bool pulls_to_the_left(SpoiledStep& s);
bool differs_from_run_to_run(SpoiledStep& s);

}  // namespace brickbench::testing
