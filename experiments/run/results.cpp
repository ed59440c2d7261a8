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

}  // namespace brickbench
