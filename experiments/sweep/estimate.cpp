#include "experiments/sweep/estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <sstream>

#include "experiments/process/isolate.hpp"
#include "experiments/record/schema.hpp"
#include "experiments/sweep/result_file.hpp"

namespace brickbench {
namespace {

struct Kind {
  const Cell* first = nullptr;
  std::vector<const Cell*> cells;
};

struct Trial {
  std::string outcome;
  std::string reason;
  double per_step_s = 0.0;
  double per_cell_s = 0.0;  // start, building, writing
  double bytes = 0.0;
};

std::vector<Kind> kinds_of(const std::vector<Cell>& cells) {
  std::map<std::string, std::size_t> numbers;
  std::vector<Kind> kinds;
  for (const Cell& cell : cells) {
    if (!cell.excluded_why.empty()) continue;
    const std::string key = cell.experiment + '\n' + cell.engine.label() + '\n' + cell.axes;
    const auto [entry, is_new] = numbers.emplace(key, kinds.size());
    if (is_new) kinds.push_back({&cell, {}});
    kinds[entry->second].cells.push_back(&cell);
  }
  return kinds;
}

// Motion that the cell will record, before compression: as docs/format.md lists it: 13 numbers a
// body and frame, time and step a frame.
double motion_bytes(const Cell& cell, const Scene& scene) {
  const double frames = 1.0 + std::ceil(static_cast<double>(step_count(cell)) /
                                        static_cast<double>(cell.recording->every));
  const double number_bytes = cell.recording->precision == TrajectoryPrecision::f32 ? 4.0 : 8.0;
  const double bodies = static_cast<double>(scene.world.bodies.size());
  return frames * (13.0 * number_bytes * bodies + 16.0);
}

// The same for all cells of a kind: they differ in step and seed, not in their bodies.
double motion_bytes(const Kind& kind, const Catalogues& catalogues) {
  const auto recorded = [](const Cell* cell) { return cell->recording.has_value(); };
  if (std::ranges::none_of(kind.cells, recorded)) return 0.0;
  const auto scene = build(scenario_of(*kind.first, catalogues), kind.first->parameters);
  if (!scene) return 0.0;  // the trial says why it cannot be built
  double bytes = 0.0;
  for (const Cell* cell : kind.cells) {
    if (recorded(cell)) bytes += motion_bytes(*cell, *scene);
  }
  return bytes;
}

// In the trial's own process: outcome, steps, wall time of stepping and building, size, reason.
std::string trial_answer(const Cell& cell, const Catalogues& catalogues, const Origin& origin,
                         double stepping_s, const StepCallback& after_step) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  bool cut_short = false;
  const CellResult result = run_cell(cell, catalogues, origin, [&](double share) {
    after_step(share);
    cut_short = std::chrono::duration<double>(Clock::now() - start).count() > stepping_s;
    return !cut_short;
  });
  const bool fine = cut_short && result.outcome == to_outcome(Fault::timed_out);
  return fmt::format("{} {} {} {} {}\n{}", fine ? "ok" : result.outcome, result.timing.steps,
                     shortest(result.timing.cell_wall_s), shortest(result.timing.build_cpu_s),
                     to_text(cell_file(result)).size(), result.reason);
}

Trial trial_of(const Ended& ended, std::size_t steps_wanted) {
  Trial trial;
  if (!ended.answered) {
    trial.outcome = to_outcome(ended.failure.fault);
    trial.reason = ended.failure.reason;
    return trial;
  }
  std::istringstream stream(ended.answer);
  double steps = 0.0;
  double wall_s = 0.0;
  double build_s = 0.0;
  stream >> trial.outcome >> steps >> wall_s >> build_s >> trial.bytes;
  stream.ignore();
  std::getline(stream, trial.reason);
  trial.per_step_s = std::max(0.0, wall_s - build_s) / std::max(1.0, steps);
  trial.per_cell_s = steps < static_cast<double>(steps_wanted)
                         ? build_s
                         : std::max(build_s, ended.wall_s - trial.per_step_s * steps);
  return trial;
}

}  // namespace

Expected<Estimate> estimate(const std::vector<Cell>& cells, const Catalogues& catalogues,
                            const Origin& origin, const TrialLimits& limits) {
  const std::vector<Kind> kinds = kinds_of(cells);
  Estimate result;
  result.kinds = kinds.size();
  result.tried = std::min(kinds.size(), limits.most);
  for (const Kind& kind : kinds) {
    result.cells += kind.cells.size();
    result.motion_bytes += motion_bytes(kind, catalogues);
  }
  result.excluded = cells.size() - result.cells;
  std::size_t covered = 0;
  for (std::size_t i = 0; i < result.tried; ++i) {
    const Kind& kind = kinds[i * kinds.size() / result.tried];
    auto process = Isolated::start(
        [&](const StepCallback& after_step) {
          return trial_answer(*kind.first, catalogues, origin, limits.stepping_s, after_step);
        },
        {.wall_s = limits.hang_s});
    if (!process) return tl::unexpected(process.error());
    const Trial trial = trial_of(process->wait(), step_count(*kind.first));
    covered += kind.cells.size();
    for (const Cell* cell : kind.cells) {
      result.work_s += trial.per_cell_s + trial.per_step_s * static_cast<double>(step_count(*cell));
    }
    result.size_bytes += trial.bytes * static_cast<double>(kind.cells.size());
    if (trial.outcome != "ok") {
      result.failures.push_back({*kind.first, kind.cells.size(), trial.outcome, trial.reason});
    }
  }
  if (covered > 0) {
    const double scale = static_cast<double>(result.cells) / static_cast<double>(covered);
    result.work_s *= scale;
    result.size_bytes *= scale;
  }
  return result;
}

}  // namespace brickbench
