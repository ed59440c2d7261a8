// KnobTable: the knobs of an adapter as one table, with the library's own value and the tuned one.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <span>
#include <string_view>
#include <vector>

#include "adapters/seam/adapter.hpp"

namespace brickbench {

// The variant in which every knob that the user did not turn stays as the library has it.
inline constexpr std::string_view k_library_variant = "default";

struct KnobRow {
  const char* name;  // snake_case with SI suffix
  const char* unit;
  double library;  // what the library does when nobody asks
  double tuned;    // what all variants but k_library_variant use
  double min;      // allowed range, both ends included
  double max;
  bool whole;  // only whole numbers
  const char* meaning;
};

inline std::vector<Knob> to_knobs(std::span<const KnobRow> rows) {
  std::vector<Knob> knobs;
  for (const KnobRow& row : rows) {
    knobs.push_back({row.name, row.unit, row.library, row.meaning, row.min, row.max, row.whole});
  }
  return knobs;
}

// The user's value, else that of the variant.
inline double knob_value(std::span<const KnobRow> rows, const Settings& settings,
                         std::string_view name) {
  const auto row = std::ranges::find_if(
      rows, [&](const KnobRow& r) { return std::string_view(r.name) == name; });
  assert(row != rows.end());
  return knob_or(settings, name, settings.variant == k_library_variant ? row->library : row->tuned);
}

// The shortest text that reads back to the same number.
inline AuditFact number_fact(std::string name, std::string unit, double value) {
  return {std::move(name), std::move(unit), fmt::format("{}", value)};
}

// Step and knobs as Adapter::asked states them, under the names of the knobs.
inline std::vector<AuditFact> asked_knobs(std::span<const KnobRow> rows, const Settings& settings) {
  std::vector<AuditFact> facts = {number_fact("step_s", "s", settings.step_s)};
  for (const KnobRow& row : rows) {
    facts.push_back(number_fact(row.name, row.unit, knob_value(rows, settings, row.name)));
  }
  return facts;
}

// `values` in one text if they are all the same, else how they differ; "-" if there are none.
inline std::string common_text(std::span<const double> values) {
  if (values.empty()) return "-";
  const auto [least, most] = std::ranges::minmax(values);
  return least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
}

}  // namespace brickbench
