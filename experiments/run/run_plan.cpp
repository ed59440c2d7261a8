#include "experiments/run/run_plan.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

namespace brickbench {
namespace {

template <typename T>
void append(std::vector<T>& to, std::vector<T>&& from) {
  std::ranges::move(from, std::back_inserter(to));
}

}  // namespace

void note_method(RunResult& result, MethodRecord method) {
  if (method.facts.empty()) return;
  if (std::ranges::find(result.methods, method) != result.methods.end()) return;
  result.methods.push_back(std::move(method));
}

RunResult run_cells(const std::vector<Cell>& cells, const Catalogues& catalogues,
                    const Origin& origin, const RunCallbacks& callbacks,
                    const std::filesystem::path& folder) {
  RunResult result;
  for (const Cell& cell : cells) {
    if (callbacks.cell_begins) callbacks.cell_begins(cell, cells.size());
    CellResult done = run_cell(cell, catalogues, origin, callbacks.after_step, folder);
    result.cells.push_back({cell, done.timing.cell, done.outcome, done.reason,
                            done.timing.cell_wall_s, done.unrecorded, done.validity});
    note_method(result, std::move(done.method));
    append(result.rows, std::move(done.rows));
    append(result.series, std::move(done.series));
    result.timings.push_back(std::move(done.timing));
    if (callbacks.cell_ends) callbacks.cell_ends(result.cells.back(), cells.size());
  }
  return result;
}

bool is_failure(const CellOutcome& cell) {
  constexpr std::array<std::string_view, 3> fine = {"ok", "refused", "excluded"};
  if (cell.outcome == "excluded") return false;
  if (!cell.cell.expected_outcome.empty()) return cell.outcome != cell.cell.expected_outcome;
  return std::ranges::find(fine, cell.outcome) == fine.end();
}

int exit_code(const RunResult& result) {
  return std::ranges::any_of(result.cells, is_failure) ? 1 : 0;
}

Provenance provenance_of(const Plan& plan, const Catalogues& catalogues) {
  Provenance provenance;
  provenance.plan = plan.file.string();
  provenance.title = plan.title;
  provenance.analysis = plan.analysis;
  provenance.machine = this_machine();
  for (const Adapter& adapter : catalogues.adapters) {
    provenance.engines.push_back(
        {adapter.name, adapter.version, precision_text(adapter), adapter.own});
  }
  for (const Experiment& experiment : plan.experiments) {
    if (!experiment.file_scene) continue;
    const Scenario& read = *experiment.file_scene;
    const SceneRecord scene{read.name, read.file, read.hash, read.text};
    if (std::ranges::find(provenance.scenes, scene) == provenance.scenes.end()) {
      provenance.scenes.push_back(scene);
    }
  }
  for (const MetricInfo& metric : catalogues.metrics) {
    for (const OutputInfo& output : metric.outputs) {
      provenance.metrics.push_back({output.name, output.unit, metric.name,
                                    std::string(better_word(output.better)), output.meaning,
                                    output.good});
    }
  }
  return provenance;
}

}  // namespace brickbench
