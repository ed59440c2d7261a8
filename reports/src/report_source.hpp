// ReportSource: a results folder as reports see it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/record/provenance.hpp"
#include "experiments/record/row.hpp"
#include "experiments/record/series.hpp"
#include "experiments/record/timing.hpp"
#include "reports/src/replay.hpp"

namespace brickbench {

struct ReportSource {
  std::string name;  // of the folder
  std::vector<Row> rows;
  std::vector<Timing> timings;
  std::vector<SeriesPoint> series;
  Provenance provenance;
  std::vector<Replay> replays;
  std::size_t recorded_cells = 0;     // with a trajectory; of several seeds one is a replay
  nlohmann::ordered_json validation;  // what `validate --json` printed, or null
  nlohmann::ordered_json orders;      // what `validate --order --out` saved, or null
  std::vector<Provenance> attached;   // of the folders that fold_validations() took in
};

// rows.csv, timings.csv, series.csv and provenance.json of the folder; trajectories,
// validation.json and orders.json where they exist. A folder of a validation, which has one of the
// last two, needs no rows. Fault::invalid with file and line if something is missing or damaged.
Expected<ReportSource> read_report_source(const std::filesystem::path& folder);

// Folders that hold nothing but a validation become part of the first other folder that has none of
// its kind: one page then has one verdict over runs and exact cases.
void fold_validations(std::vector<ReportSource>& sources);

}  // namespace brickbench
