#include "reports/src/report_source.hpp"

#include <fmt/format.h>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "reports/src/replay_source.hpp"

namespace brickbench {
namespace {

namespace fs = std::filesystem;

// Fault::invalid with file:line:column where the text is not JSON.
Expected<nlohmann::ordered_json> read_json(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  try {
    return nlohmann::ordered_json::parse(*text);
  } catch (const nlohmann::json::parse_error& error) {
    std::size_t line = 1;
    std::size_t column = 1;
    for (std::size_t i = 0; i + 1 < error.byte && i < text->size(); ++i) {
      column = (*text)[i] == '\n' ? 1 : column + 1;
      if ((*text)[i] == '\n') ++line;
    }
    return fail(Fault::invalid, fmt::format("{}:{}:{}: not JSON", file.string(), line, column));
  }
}

Expected<void> read_validation(const fs::path& file, ReportSource& source) {
  if (!fs::exists(file)) return {};
  auto json = read_json(file);
  if (!json) return tl::unexpected(json.error());
  const auto complain = [&](const std::string& what) {
    return fail(Fault::invalid, fmt::format("{}: {}", file.string(), what));
  };
  if (!json->is_object() || !json->contains("cells") || !(*json)["cells"].is_array()) {
    return complain("no array 'cells'; write it with `brickbench validate --json`");
  }
  for (const auto& cell : (*json)["cells"]) {
    for (const char* key : {"engine", "variant", "case", "outcome"}) {
      if (!cell.contains(key) || !cell[key].is_string()) {
        return complain(fmt::format("a cell without the text '{}'", key));
      }
    }
  }
  source.validation = std::move(*json);
  return {};
}

}  // namespace

Expected<ReportSource> read_report_source(const fs::path& folder) {
  ReportSource source;
  const fs::path whole = fs::absolute(folder).lexically_normal();
  source.name = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
  auto rows = read_csv<Row>(folder / "rows.csv");
  if (!rows) return tl::unexpected(rows.error());
  source.rows = std::move(*rows);
  auto timings = read_csv<Timing>(folder / "timings.csv");
  if (!timings) return tl::unexpected(timings.error());
  source.timings = std::move(*timings);
  auto series = read_csv<SeriesPoint>(folder / "series.csv");
  if (!series) return tl::unexpected(series.error());
  source.series = std::move(*series);
  const fs::path file = folder / "provenance.json";
  const auto json = read_json(file);
  if (!json) return tl::unexpected(json.error());
  auto provenance = provenance_from_json(*json);
  if (!provenance) {
    return fail(Fault::invalid, fmt::format("{}: {}", file.string(), provenance.error().reason));
  }
  source.provenance = std::move(*provenance);
  if (auto ok = read_validation(folder / "validation.json", source); !ok) {
    return tl::unexpected(ok.error());
  }
  auto replays = read_replays(folder, source.rows);
  if (!replays) return tl::unexpected(replays.error());
  source.replays = std::move(replays->replays);
  source.recorded_cells = replays->cells;
  return source;
}

}  // namespace brickbench
