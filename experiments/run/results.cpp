#include "experiments/run/results.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"

namespace brickbench {
namespace fs = std::filesystem;

fs::path next_results_folder(const std::string& plan_name) {
  for (int number = 1;; ++number) {
    fs::path folder = fs::path("results") / fmt::format("{}-{:03}", plan_name, number);
    if (!fs::exists(fs::symlink_status(folder))) return folder;
  }
}

Expected<void> write_results(const fs::path& folder, const Plan& plan, const RunResult& result,
                             const Provenance& provenance) {
  Provenance whole = provenance;
  whole.methods = result.methods;
  const std::vector<std::pair<const char*, std::string>> files = {
      {"plan.toml", plan.text},
      {"provenance.json", to_json(whole).dump(2) + '\n'},
      {"series.csv", to_csv<SeriesPoint>(result.series)},
      {"timings.csv", to_csv<Timing>(result.timings)},
      {"rows.csv", to_csv<Row>(result.rows)},
  };
  for (const auto& [name, content] : files) {
    if (auto ok = write_new_file(folder / name, content); !ok) return ok;
  }
  return {};
}

Expected<Results> read_results(const fs::path& folder) {
  auto rows = read_csv<Row>(folder / "rows.csv");
  if (!rows) return tl::unexpected(rows.error());
  auto timings = read_csv<Timing>(folder / "timings.csv");
  if (!timings) return tl::unexpected(timings.error());
  const fs::path file = folder / "provenance.json";
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const auto json = nlohmann::ordered_json::parse(*text, nullptr, false);
  if (json.is_discarded()) {
    return fail(Fault::invalid, fmt::format("{}: not JSON", file.string()));
  }
  auto provenance = provenance_from_json(json);
  if (!provenance) {
    return fail(Fault::invalid, fmt::format("{}: {}", file.string(), provenance.error().reason));
  }
  return Results{std::move(*rows), std::move(*timings), std::move(*provenance)};
}

}  // namespace brickbench
