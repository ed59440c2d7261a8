// Seeded faults: what an adapter, or the harness around it, could get wrong, put on top of a
// correct engine. Each fault is data: a name, one line of what is wrong, and the hooks where it
// acts.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "adapters/seam/adapter.hpp"
#include "tests/faults/step_faults.hpp"

namespace brickbench::testing {

// What a hook on the read-out sees.
struct Readout {
  std::span<State> states;
  std::span<const State> previous;  // as the correct engine had them one step earlier
  const World& world;
  int step = 0;
  double step_s = 0.0;
};

struct SeededFault {
  const char* name;
  const char* story;
  void (*world)(World&) = nullptr;        // a fact translated wrongly
  void (*settings)(Settings&) = nullptr;  // a setting passed on wrongly
  void (*load)(std::span<Wrench>, std::span<const State>, int step) = nullptr;
  void (*read)(Readout&) = nullptr;
  void (*contacts)(std::vector<Contact>& now, const std::vector<Contact>& previous,
                   double step_s) = nullptr;
  bool (*step)(SpoiledStep&) = nullptr;  // whether the states after a step were changed
  const char* hunted_in = "";            // scenarios, one space apart; empty: all
};

// All faults; the first, "none", leaves the engine as it is.
std::span<const SeededFault> seeded_faults();

// The number of the fault of this name, or of seeded_faults() if there is none.
std::size_t fault_named(std::string_view name);

// An adapter that builds the correct engine with fault number `index` on top. `audit`: whether the
// audit of the faulty engine can be read; hidden, the motion alone must give the fault away.
// Correct is the first linked adapter that has spheres, friction and restitution.
Adapter faulty_adapter(std::size_t index, bool audit);

// Empty name if no linked engine can do it.
Adapter correct_adapter();

// One knob that shows in its audit, with a value that is not the default.
KnobValues turned_knob();

// A ball above a plane that asks for friction and restitution of an engine.
World demanding_world();

}  // namespace brickbench::testing
