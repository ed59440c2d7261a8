// KnobTable: the knobs of an adapter as one table: what each is, how it is set in the engine's live
// objects, and how it is read back from them.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "adapters/seam/adapter.hpp"

namespace brickbench {

// A value as each of the live objects holds it.
using LiveValues = std::vector<double>;

// One knob of an engine whose live objects are `Live`.
template <class Live>
struct KnobRow {
  const char* name;  // snake_case with SI suffix
  const char* unit;
  double library;  // what the library does when nobody asks
  double tuned;    // what our own choice of settings uses
  double min;      // allowed range, both ends included
  double max;
  bool whole;  // only whole numbers
  const char* meaning;
  // nullptr: the adapter uses it where it builds.
  void (*set)(Live&, double) = nullptr;
  // nullptr: no live object holds it under this name.
  LiveValues (*read)(const Live&) = nullptr;
  bool of_bodies = false;  // held by each body: nothing to read where none moves
};

// set and read of a knob that is a member of the live object.
template <auto member>
struct Held;
template <class Live, class Value, Value Live::*member>
struct Held<member> {
  static void set(Live& live, double value) { live.*member = static_cast<Value>(value); }
  static LiveValues read(const Live& live) { return {static_cast<double>(live.*member)}; }
};

template <class Live, std::size_t size>
std::vector<Knob> to_knobs(const std::array<KnobRow<Live>, size>& rows) {
  std::vector<Knob> knobs;
  for (const auto& row : rows) {
    knobs.push_back({row.name, row.unit, row.library, row.meaning, row.min, row.max, row.whole});
  }
  return knobs;
}

// The values of a variant: all as the library has them, or all as we tuned them.
template <class Live, std::size_t size>
KnobValues library_values(const std::array<KnobRow<Live>, size>& rows) {
  KnobValues values;
  for (const auto& row : rows) values[row.name] = row.library;
  return values;
}
template <class Live, std::size_t size>
KnobValues tuned_values(const std::array<KnobRow<Live>, size>& rows) {
  KnobValues values;
  for (const auto& row : rows) values[row.name] = row.tuned;
  return values;
}

// Sets every knob that the live object holds to its value in the settled settings.
template <class Live, std::size_t size>
void set_knobs(const std::array<KnobRow<Live>, size>& rows, const Settings& settings, Live& live) {
  for (const auto& row : rows) {
    if (row.set != nullptr) row.set(live, knob(settings, row.name));
  }
}

// The shortest text that reads back to the same number.
inline AuditFact number_fact(std::string name, std::string unit, double value) {
  return {std::move(name), std::move(unit), fmt::format("{}", value)};
}

// `values` in one text if they are all the same, else how they differ; "-" if there are none.
inline std::string common_text(std::span<const double> values) {
  if (values.empty()) return "-";
  const auto [least, most] = std::ranges::minmax(values);
  return least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
}

// Every knob that the live object holds, as it holds it.
template <class Live, std::size_t size>
std::vector<AuditFact> read_knobs(const std::array<KnobRow<Live>, size>& rows, const Live& live) {
  std::vector<AuditFact> facts;
  for (const auto& row : rows) {
    if (row.read != nullptr) facts.push_back({row.name, row.unit, common_text(row.read(live))});
  }
  return facts;
}

// What read_knobs() must yield of the world built with these settled settings, and the step.
template <class Live, std::size_t size>
std::vector<AuditFact> asked_knobs(const std::array<KnobRow<Live>, size>& rows, const World& world,
                                   const Settings& settings) {
  std::vector<AuditFact> facts = {number_fact("step_s", "s", settings.step_s)};
  const bool moves = std::ranges::any_of(world.bodies, [](const Body& b) { return !b.fixed; });
  for (const auto& row : rows) {
    if (row.read == nullptr || (row.of_bodies && !moves)) continue;
    facts.push_back(number_fact(row.name, row.unit, knob(settings, row.name)));
  }
  return facts;
}

}  // namespace brickbench
