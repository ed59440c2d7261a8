// Hunt: draws trials, judges them on all cores, shrinks what was found, and keeps account.
#pragma once

#include <functional>
#include <limits>

#include "experiments/hunt/draw.hpp"
#include "experiments/hunt/record.hpp"

namespace brickbench::hunt {

struct HuntOptions {
  double budget_s = 60.0;  // no trial begins later; what was found is shrunk to its end
  std::uint64_t most_trials = std::numeric_limits<std::uint64_t>::max();
  std::size_t workers = 1;
  bool shrinks = true;  // else what was found stays as it was drawn
  DrawLimits limits;
};

// Trial `number` of the hunt: case number / engines, in engine number % engines. nullopt where the
// case makes no scene.
std::optional<Trial> trial_number(const Quarry& quarry, const Catalogues& catalogues,
                                  std::uint64_t number, const DrawLimits& limits = {});

// Called about ten times a second; false: stop, as if the budget were used up.
using Tick = std::function<bool(const Record& record, std::size_t running)>;

// Goes on from `record` and fills it. What is judged depends on the quarry alone; budget and
// workers decide how far it gets. The calling process must have one thread.
Expected<void> run_hunt(const Quarry& quarry, const Catalogues& catalogues,
                        const HuntOptions& options, const ProgressFile& progress, Record& record,
                        const Tick& tick = {});

}  // namespace brickbench::hunt
