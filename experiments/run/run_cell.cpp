#include "experiments/run/run_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <new>

#include "experiments/run/perturb.hpp"
#include "experiments/run/watch.hpp"

namespace brickbench {
namespace {

std::string id_of(const Cell& cell, const Catalogues& catalogues, const Origin& origin) {
  const Adapter* adapter = find_adapter(catalogues, cell.engine.engine);
  return cell_id(cell_key(cell, adapter == nullptr ? "" : adapter->version, origin.revision));
}

// The columns that all rows of a cell share.
Row row_of(const Cell& cell, const Catalogues& catalogues, const Origin& origin) {
  Row row;
  row.experiment = cell.experiment;
  row.cell = id_of(cell, catalogues, origin);
  row.scenario = cell.scenario;
  row.engine = cell.engine.engine;
  row.variant = cell.engine.variant;
  if (const Adapter* adapter = find_adapter(catalogues, row.engine)) {
    row.engine_version = adapter->version;
    row.precision = variant_of(*adapter, row.variant).precision;
  }
  row.revision = origin.revision;
  row.machine = origin.machine;
  row.step_s = cell.step_s;
  row.duration_s = cell.duration_s;
  row.seed = cell.seed;
  row.axes = cell.axes;
  return row;
}

Timing timing_of(const Cell& cell, const Row& row) {
  Timing timing;
  timing.experiment = cell.experiment;
  timing.cell = row.cell;
  timing.engine = row.engine;
  timing.variant = row.variant;
  timing.step_s = cell.step_s;
  timing.seed = cell.seed;
  timing.axes = cell.axes;
  timing.machine = row.machine;
  return timing;
}

void describe(Row& row, const MetricInfo& metric, const OutputInfo& output) {
  row.group = metric.name;
  row.metric = output.name;
  row.unit = output.unit;
  row.better = better_word(output.better);
}

void fill(Row& row, const Measurement* measured) {
  constexpr std::string_view inapplicable = "not applicable";
  if (measured == nullptr) {
    row.outcome = "not_reported";
    row.reason = fmt::format("metric {} declares this number but did not report it", row.group);
  } else if (!std::isnan(measured->value)) {
    row.outcome = "ok";
    row.value = measured->value;
    row.note = measured->note;
  } else if (measured->note.starts_with(inapplicable)) {
    row.outcome = "not_applicable";
    row.reason = measured->note;
  } else {
    row.outcome = "not_a_number";
    row.reason = fmt::format("metric {} yields NaN{}{}", row.group,
                             measured->note.empty() ? "" : ": ", measured->note);
  }
}

// The numbers that the metric declares, then those that only the engine could name.
void add_rows(std::vector<Row>& rows, const Row& common, const MetricInfo& metric,
              const std::vector<Measurement>& measured) {
  for (const OutputInfo& output : metric.outputs) {
    Row row = common;
    describe(row, metric, output);
    const auto found = std::ranges::find(measured, output.name, &Measurement::name);
    fill(row, found == measured.end() ? nullptr : &*found);
    rows.push_back(std::move(row));
  }
  for (const Measurement& told : measured) {
    if (std::ranges::find(metric.outputs, told.name, &OutputInfo::name) != metric.outputs.end()) {
      continue;
    }
    Row row = common;
    describe(row, metric, {told.name, told.unit, Better::neither, "", ""});
    fill(row, &told);
    rows.push_back(std::move(row));
  }
}

void add_rows(CellResult& result, const Cell& cell, Row common, const Watch& watch,
              const Catalogues& catalogues) {
  common.validity = result.validity;
  common.state_hash = watch.state_hash();
  const auto measured = watch.report();
  for (std::size_t i = 0; i < cell.metrics.size(); ++i) {
    add_rows(result.rows, common, *find_metric(catalogues, cell.metrics[i]), measured[i]);
  }
}

void add_series(CellResult& result, const Watch& watch) {
  for (const CurvePoint& point : watch.curves()) {
    SeriesPoint out;
    out.experiment = result.timing.experiment;
    out.cell = result.timing.cell;
    out.engine = result.timing.engine;
    out.variant = result.timing.variant;
    out.step_s = result.timing.step_s;
    out.curve = point.curve;
    out.unit = point.unit;
    out.stride = watch.stride();
    out.time_s = point.time_s;
    out.value = point.value;
    result.series.push_back(std::move(out));
  }
}

CellResult run_checked(const Cell& cell, const Catalogues& catalogues, const Origin& origin,
                       const StepCallback& after_step, const std::filesystem::path& folder) {
  const auto failed = [&](const Failure& failure) {
    return failed_cell(cell, catalogues, origin, std::string(to_outcome(failure.fault)),
                       failure.reason);
  };
  const Adapter* adapter = find_adapter(catalogues, cell.engine.engine);
  if (adapter == nullptr) {
    return failed({Fault::invalid, fmt::format("engine {} is not linked", cell.engine.engine)});
  }
  auto scene = build(scenario_of(cell, catalogues), cell.parameters);
  if (!scene) return failed(scene.error());
  perturb(scene->world, cell.perturb, cell.seed);

  const auto start = std::chrono::steady_clock::now();
  Watch watch(*scene, cell, catalogues);
  const Row common = row_of(cell, catalogues, origin);
  TrajectoryRecorder recorder(folder, cell, *scene, common);
  const auto watched = watch.run(*adapter, after_step, &recorder);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  CellResult result;
  if (watched) {
    result.outcome = "ok";
    result.validity = watch.validity().text();
    result.timing = timing_of(cell, common);
    add_rows(result, cell, common, watch, catalogues);
    add_series(result, watch);
  } else {
    result = failed(watched.error());
  }
  result.unrecorded = recorder.finish(result.outcome, result.reason);
  watch.fill_timing(result.timing);
  result.method = watch.method();
  result.timing.cell_wall_s = wall.count();
  result.timing.outcome = result.outcome;
  result.timing.validity = result.validity;
  return result;
}

}  // namespace

std::string_view better_word(Better better) {
  switch (better) {
    case Better::lower:
      return "lower";
    case Better::higher:
      return "higher";
    case Better::neither:
      return "neither";
  }
  return "neither";
}

CellResult failed_cell(const Cell& cell, const Catalogues& catalogues, const Origin& origin,
                       const std::string& outcome, const std::string& reason) {
  Row row = row_of(cell, catalogues, origin);
  row.outcome = outcome;
  row.reason = reason;
  CellResult result;
  result.outcome = outcome;
  result.reason = reason;
  result.timing = timing_of(cell, row);
  result.timing.outcome = outcome;
  for (const std::string& name : cell.metrics) {
    const MetricInfo& metric = *find_metric(catalogues, name);
    for (const OutputInfo& output : metric.outputs) {
      describe(row, metric, output);
      result.rows.push_back(row);
    }
  }
  return result;
}

CellResult run_cell(const Cell& cell, const Catalogues& catalogues, const Origin& origin,
                    const StepCallback& after_step, const std::filesystem::path& folder) {
  if (!cell.excluded_why.empty()) {
    return failed_cell(cell, catalogues, origin, "excluded", cell.excluded_why);
  }
  try {
    return run_checked(cell, catalogues, origin, after_step, folder);
  } catch (const std::bad_alloc&) {
    return failed_cell(cell, catalogues, origin, "out_of_memory", "the cell ran out of memory");
  } catch (const std::exception& error) {
    return failed_cell(cell, catalogues, origin, "crashed",
                       fmt::format("an exception left the engine or a metric: {}", error.what()));
  } catch (...) {
    return failed_cell(cell, catalogues, origin, "crashed",
                       "an exception of unknown type left the engine or a metric");
  }
}

}  // namespace brickbench
