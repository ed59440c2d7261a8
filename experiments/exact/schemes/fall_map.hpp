// The discrete map of scenes that fall: what free motion does with the gaps within a step.
#pragma once

#include <span>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// A contact's gap under free motion until the end of the step, all along its normal.
struct FreeGap {
  double gap_m = 0.0;
  double velocity_mps = 0.0;
  double acceleration_mps2 = 0.0;
  double lag_mps2 = 0.0;  // of gravity, where one of the two bodies is fixed
  bool with_fixed = false;
  double restitution = 0.0;
};

FreeGap free_gap(const World& world, std::span<const Wrench> wrenches, const PointContact& contact,
                 std::span<const State> states);

// How a step begins for all bodies, which count as one island.
struct FreeFall {
  bool falls = false;     // no fixed body holds them: whatever meets one bounces off it
  double flight_s = 0.0;  // free flight before contacts act, up to the first bounce
};

// Where law.bounces_before_touch; else the bodies are held.
FreeFall free_fall(const ImpulseContact& law, const ExactRun& run, std::span<const Wrench> wrenches,
                   const std::vector<PointContact>& contacts, std::span<const State> states);

// What a contact of falling bodies asks for.
struct FallingTarget {
  double velocity_mps = 0.0;  // along the normal, at least, at the end of the step
  bool holds = false;         // with a fixed body, and no bounce: pushed by it, nothing falls
};

// left_s: what is left of the step after the flight.
FallingTarget falling_target(const ImpulseContact& law, const ExactRun& run, const FreeGap& gap,
                             double left_s);

}  // namespace brickbench::exact
