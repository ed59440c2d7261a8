// A folder of results read back, whole.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/provenance.hpp"

namespace brickbench::testing {

struct Results {
  std::vector<Row> rows;
  std::vector<Timing> timings;
  Provenance provenance;
};

// Fault::invalid with file and line if something is missing or damaged.
inline Expected<Results> read_results(const std::filesystem::path& folder) {
  auto rows = read_csv<Row>(folder / "rows.csv");
  if (!rows) return tl::unexpected(rows.error());
  auto timings = read_csv<Timing>(folder / "timings.csv");
  if (!timings) return tl::unexpected(timings.error());
  const std::filesystem::path file = folder / "provenance.json";
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

}  // namespace brickbench::testing
