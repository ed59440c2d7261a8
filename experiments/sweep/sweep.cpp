#include "experiments/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "experiments/sweep/line_difference.hpp"
#include "experiments/sweep/result_file.hpp"

namespace brickbench {
namespace fs = std::filesystem;
namespace {

constexpr int k_schema = 2;

template <typename Record>
std::string header() {
  std::string text = to_csv<Record>({});
  text.pop_back();
  return text;
}

std::string list_name(const std::string& cells_csv) {
  return fmt::format("cells.{}.csv", checksum(cells_csv).substr(0, 16));
}

nlohmann::ordered_json to_json(const Sweep& sweep) {
  return {{"schema", k_schema},
          {"cells", sweep.cells.size()},
          {"list", sweep.list},
          {"rows_header", sweep.rows_header},
          {"timings_header", sweep.timings_header},
          {"series_header", sweep.series_header},
          {"set", sweep.overrides.set},
          {"engines", sweep.overrides.engines},
          {"only", sweep.overrides.only},
          {"plan_text", sweep.plan_text},
          {"provenance", brickbench::to_json(sweep.provenance)}};
}

tl::unexpected<Failure> damaged(const fs::path& file, const std::string& what) {
  return fail(Fault::invalid, fmt::format("{}: {}", file.string(), what));
}

Expected<Sweep> sweep_from_json(const nlohmann::ordered_json& json, const fs::path& file) {
  try {
    if (json.at("schema") != k_schema) return damaged(file, "of another version of the program");
    Sweep sweep;
    sweep.list = json.at("list");
    sweep.rows_header = json.at("rows_header");
    sweep.timings_header = json.at("timings_header");
    sweep.series_header = json.at("series_header");
    sweep.overrides.set = json.at("set");
    sweep.overrides.engines = json.at("engines");
    sweep.overrides.only = json.at("only");
    sweep.plan_text = json.at("plan_text");
    auto provenance = provenance_from_json(json.at("provenance"));
    if (!provenance) return damaged(file, provenance.error().reason);
    sweep.provenance = std::move(*provenance);
    sweep.cells.reserve(json.at("cells").get<std::size_t>());
    return sweep;
  } catch (const nlohmann::json::exception& error) {
    return damaged(file, error.what());
  }
}

std::string versions_difference(const Provenance& before, const Provenance& after) {
  std::string text;
  if (before.machine.revision != after.machine.revision) {
    text += fmt::format("it was made by revision {} of the program, this one is {}\n",
                        before.machine.revision, after.machine.revision);
  }
  const auto version = [](const Provenance& provenance, const std::string& name) -> std::string {
    const auto found = std::ranges::find(provenance.engines, name, &EngineRecord::name);
    return found == provenance.engines.end() ? "absent" : found->version;
  };
  std::set<std::string> names;
  for (const EngineRecord& engine : before.engines) names.insert(engine.name);
  for (const EngineRecord& engine : after.engines) names.insert(engine.name);
  for (const std::string& name : names) {
    if (version(before, name) == version(after, name)) continue;
    text +=
        fmt::format("engine {} was {}, is {}\n", name, version(before, name), version(after, name));
  }
  return text;
}

std::string options_text(const Overrides& overrides) {
  std::string text;
  for (const std::string& set : overrides.set) text += "--set " + set + '\n';
  for (const std::string& engine : overrides.engines) text += "--engine " + engine + '\n';
  if (!overrides.only.empty()) text += "--only " + overrides.only + '\n';
  return text;
}

// Why two sweeps are not the same, as text for people.
std::string difference(const Sweep& before, const Sweep& after) {
  std::set<std::string> ids;
  for (const PlannedCell& cell : before.cells) ids.insert(cell.cell);
  const auto same = static_cast<std::size_t>(std::ranges::count_if(
      after.cells, [&](const PlannedCell& cell) { return ids.contains(cell.cell); }));
  std::string text = fmt::format(
      "'{}' belongs to another sweep, of {} cells; {} of the {} asked for now are among them:\n",
      before.folder.string(), before.cells.size(), same, after.cells.size());
  text += versions_difference(before.provenance, after.provenance);
  text += line_difference(options_text(before.overrides), options_text(after.overrides));
  text += line_difference(before.plan_text, after.plan_text);
  return text + "name a new folder, or go back to what the folder was made with";
}

// Writes the folder's description; true if this process did, false if another one had. A failure
// that leaves the file there is one of a race, and no failure: see tidy().
Expected<bool> write_sweep(const Sweep& sweep, const std::string& csv) {
  if (!fs::exists(sweep.folder / sweep.list)) {
    const auto listed = replace_file(sweep.folder / sweep.list, csv);
    if (!listed && !fs::exists(sweep.folder / sweep.list)) return tl::unexpected(listed.error());
  }
  const std::string json = to_json(sweep).dump(2) + '\n';
  const auto written = write_new_file(sweep.folder / "sweep.json", json);
  if (written) return true;
  if (fs::exists(sweep.folder / "sweep.json")) return false;
  return tl::unexpected(written.error());
}

// Removes what processes that were killed while they made the folder have left of its files. One
// that is alive and still at it loses a copy of what is there already.
void tidy(const Sweep& sweep) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(sweep.folder, error)) {
    if (entry.path().filename().string().find(".tmp.") != std::string::npos) {
      fs::remove(entry.path(), error);
    }
  }
  // For people only.
  if (fs::exists(sweep.folder / "plan.toml", error)) return;
  (void)replace_file(sweep.folder / "plan.toml", sweep.plan_text);
}

// What sweep.json says; the cells are missing.
Expected<Sweep> read_description(const fs::path& folder) {
  const fs::path file = folder / "sweep.json";
  std::error_code error;
  if (!fs::exists(file, error)) {
    return fail(Fault::invalid,
                fmt::format("'{}' is not the folder of a sweep: no sweep.json", folder.string()));
  }
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const auto json = nlohmann::ordered_json::parse(*text, nullptr, false);
  if (json.is_discarded()) return damaged(file, "not JSON");
  auto sweep = sweep_from_json(json, file);
  if (sweep) sweep->folder = folder;
  return sweep;
}

// The same with the cells of its list.
Expected<Sweep> read_cells(Sweep sweep) {
  const fs::path file = sweep.folder / sweep.list;
  const auto csv = read_file(file);
  if (!csv) return tl::unexpected(csv.error());
  if (list_name(*csv) != sweep.list) {
    return damaged(file, "the checksum in its name does not fit");
  }
  auto cells = read_csv<PlannedCell>(file);
  if (!cells) return tl::unexpected(cells.error());
  sweep.cells = std::move(*cells);
  return sweep;
}

// Fault::invalid if there is something in the folder that no sweep has put there.
Expected<void> check_free(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("cells.") || name.starts_with("sweep.json")) continue;
    return fail(Fault::invalid, fmt::format("'{}' is not the folder of a sweep: it holds '{}'",
                                            folder.string(), name));
  }
  if (error) {
    return fail(Fault::invalid,
                fmt::format("cannot read folder '{}': {}", folder.string(), error.message()));
  }
  return {};
}

}  // namespace

std::vector<PlannedCell> planned_cells(const std::vector<Cell>& cells, const Catalogues& catalogues,
                                       const std::string& revision) {
  std::vector<PlannedCell> planned;
  planned.reserve(cells.size());
  for (const Cell& cell : cells) {
    const Adapter* adapter = find_adapter(catalogues, cell.engine.engine);
    planned.push_back(
        {cell_id(cell_key(cell, adapter == nullptr ? "" : adapter->version, revision)),
         cell.experiment, cell.engine.engine, cell.engine.variant, cell.step_s, cell.seed,
         cell.axes, cell.excluded_why, cell.expected_outcome});
  }
  return planned;
}

Expected<Sweep> open_sweep(const fs::path& folder, const Plan& plan, const Overrides& overrides,
                           std::vector<PlannedCell> cells, const Provenance& provenance) {
  Sweep sweep{.folder = folder,
              .list = {},
              .cells = std::move(cells),
              .rows_header = header<Row>(),
              .timings_header = header<Timing>(),
              .series_header = header<SeriesPoint>(),
              .plan_text = plan.text,
              .overrides = overrides,
              .provenance = provenance};
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return fail(Fault::crashed,
                fmt::format("cannot create folder '{}': {}", folder.string(), error.message()));
  }
  const std::string csv = to_csv<PlannedCell>(sweep.cells);
  sweep.list = list_name(csv);
  if (!fs::exists(folder / "sweep.json")) {
    if (auto ok = check_free(folder); !ok) return tl::unexpected(ok.error());
    const auto first = write_sweep(sweep, csv);
    if (!first) return tl::unexpected(first.error());
    if (*first) {
      tidy(sweep);
      return sweep;
    }
  }
  auto stored = read_description(folder);
  if (!stored) return stored;
  if (stored->list == sweep.list) {
    // Its own list of cells need not be read line by line if it is what was just written down.
    if (read_file(folder / sweep.list) != csv) return read_cells(std::move(*stored));
    stored->cells = std::move(sweep.cells);
    tidy(*stored);
    return stored;
  }
  stored = read_cells(std::move(*stored));
  if (!stored) return stored;
  return fail(Fault::invalid, difference(*stored, sweep));
}

Expected<Sweep> read_sweep(const fs::path& folder) {
  auto sweep = read_description(folder);
  if (!sweep) return sweep;
  return read_cells(std::move(*sweep));
}

}  // namespace brickbench
