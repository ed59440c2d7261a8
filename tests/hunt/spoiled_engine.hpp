// Spoiled engines: a correct one whose states are changed after some steps, as the faults do that
// the hunt must find by itself.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adapters/seam/adapter.hpp"

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
};

struct Spoiling {
  const char* name;
  const char* story;
  bool (*spoil)(SpoiledStep& step);  // whether `after` was changed
  std::vector<std::string> oracles;  // any of which must find it
  std::vector<std::string> scenes;   // to hunt in; empty: all
};

std::span<const Spoiling> spoilings();

// The correct engine with spoiling number `index` on top, under its name; empty name if no linked
// engine is fit.
Adapter spoiled_adapter(std::size_t index);

}  // namespace brickbench::testing
