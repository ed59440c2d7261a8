#include "reports/src/report_source.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "reports/src/replay_source.hpp"
#include "reports/src/validation.hpp"

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

// `into` stays null where there is no such file.
Expected<void> read_checked(const fs::path& file, nlohmann::ordered_json& into,
                            std::string (*fault)(const nlohmann::ordered_json&)) {
  if (!fs::exists(file)) return {};
  auto json = read_json(file);
  if (!json) return tl::unexpected(json.error());
  if (const std::string what = fault(*json); !what.empty()) {
    return fail(Fault::invalid, fmt::format("{}: {}", file.string(), what));
  }
  into = std::move(*json);
  return {};
}

Expected<void> read_rows(const fs::path& folder, ReportSource& source) {
  auto rows = read_csv<Row>(folder / "rows.csv");
  if (!rows) return tl::unexpected(rows.error());
  source.rows = std::move(*rows);
  auto timings = read_csv<Timing>(folder / "timings.csv");
  if (!timings) return tl::unexpected(timings.error());
  source.timings = std::move(*timings);
  auto series = read_csv<SeriesPoint>(folder / "series.csv");
  if (!series) return tl::unexpected(series.error());
  source.series = std::move(*series);
  return {};
}

}  // namespace

Expected<ReportSource> read_report_source(const fs::path& folder) {
  ReportSource source;
  const fs::path whole = fs::absolute(folder).lexically_normal();
  source.name = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
  if (auto ok = read_checked(folder / "validation.json", source.validation, validation_fault);
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (auto ok = read_checked(folder / "orders.json", source.orders, orders_fault); !ok) {
    return tl::unexpected(ok.error());
  }
  const bool validated = !source.validation.is_null() || !source.orders.is_null();
  if (!validated || fs::exists(folder / "rows.csv")) {
    if (auto ok = read_rows(folder, source); !ok) return tl::unexpected(ok.error());
  }
  const fs::path file = folder / "provenance.json";
  const auto json = read_json(file);
  if (!json) return tl::unexpected(json.error());
  auto provenance = provenance_from_json(*json);
  if (!provenance) {
    return fail(Fault::invalid, fmt::format("{}: {}", file.string(), provenance.error().reason));
  }
  source.provenance = std::move(*provenance);
  auto replays = read_replays(folder, source.rows);
  if (!replays) return tl::unexpected(replays.error());
  source.replays = std::move(replays->replays);
  source.recorded_cells = replays->cells;
  return source;
}

void fold_validations(std::vector<ReportSource>& sources) {
  for (std::size_t i = 0; i < sources.size();) {
    ReportSource& from = sources[i];
    const bool validates = !from.validation.is_null();
    const bool orders = !from.orders.is_null();
    const auto takes = [&](const ReportSource& into) {
      return &into != &from && (!into.rows.empty() || &into < &from) &&
             !(validates && !into.validation.is_null()) && !(orders && !into.orders.is_null());
    };
    const auto into = std::ranges::find_if(sources, takes);
    if (!from.rows.empty() || (!validates && !orders) || into == sources.end()) {
      ++i;
      continue;
    }
    if (validates) into->validation = std::move(from.validation);
    if (orders) into->orders = std::move(from.orders);
    into->attached.push_back(std::move(from.provenance));
    into->attached.insert(into->attached.end(), from.attached.begin(), from.attached.end());
    sources.erase(sources.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace brickbench
