#include "experiments/run/trajectory_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/run/cell.hpp"

namespace brickbench {
namespace {

// The largest relative distance of every_s / step_s from a whole number: rounding of the quotient.
constexpr double k_whole_steps_tolerance = 1e-9;

bool truth(const InputValue& table, const char* name) {
  const InputValue* value = table.find(name);
  return value != nullptr && expect(*value, name, ValueKind::boolean).number != 0.0;
}

TrajectoryPrecision precision_of(const InputValue& value) {
  const std::string& word = filled_text(value, "precision");
  if (word == "f64") return TrajectoryPrecision::f64;
  if (word == "f32") return TrajectoryPrecision::f32;
  reject(value.at, fmt::format("no precision '{}'{}", word, known_names(word, {"f64", "f32"})));
}

void read_every(const InputValue& table, TrajectoryChoice& choice) {
  const InputValue* steps = table.find("every");
  const InputValue* seconds = table.find("every_s");
  if (steps != nullptr && seconds != nullptr) {
    reject(seconds->at, "every and every_s say the same thing: give one of them");
  }
  if (steps != nullptr) {
    const double every = expect(*steps, "every", ValueKind::integer).number;
    if (every < 1.0) reject(steps->at, fmt::format("every = {} must be at least 1", every));
    choice.every = static_cast<std::uint64_t>(every);
  }
  if (seconds != nullptr) {
    choice.every_s = positive_number(*seconds, "every_s");
    choice.every_at = seconds->at;
  }
}

std::uint64_t steps_between_frames(const TrajectoryChoice& choice, const Cell& cell) {
  if (choice.every_s == 0.0) return choice.every;
  const double count = choice.every_s / cell.step_s;
  if (std::round(count) < 1.0 ||
      std::abs(count - std::round(count)) > k_whole_steps_tolerance * count) {
    reject(choice.every_at, fmt::format("every_s = {} is not a whole number of steps of {} s",
                                        choice.every_s, cell.step_s));
  }
  return static_cast<std::uint64_t>(std::llround(count));
}

bool is_meant(const TrajectoryChoice& choice, const Cell& cell, const Catalogues& catalogues) {
  const auto meant = [&](const Selector& selector) {
    const auto engines = select(selector, catalogues);
    return std::ranges::find(engines, cell.engine) != engines.end();
  };
  if (!choice.engines.empty() && std::ranges::none_of(choice.engines, meant)) return false;
  if (choice.cells.empty()) return true;
  ParameterValues values = quantities(cell, catalogues);
  values["experiment"] = cell.experiment;
  return holds(choice.cells, values);
}

}  // namespace

TrajectoryChoice trajectory_choice(const InputValue& table, std::vector<std::string> names,
                                   const Catalogues& catalogues) {
  expect(table, "trajectory", ValueKind::table);
  reject_unknown(table, "trajectory",
                 {"every", "every_s", "precision", "engines", "cells", "contacts"});
  TrajectoryChoice choice;
  choice.at = table.at;
  read_every(table, choice);
  if (const InputValue* value = table.find("precision")) choice.precision = precision_of(*value);
  if (const InputValue* engines = table.find("engines")) {
    for (const InputValue* item : one_or_more(*engines, "engines")) {
      choice.engines.push_back(
          expect_selector(filled_text(*item, "engines"), item->at, catalogues, false));
    }
  }
  if (const InputValue* cells = table.find("cells")) {
    names.emplace_back("experiment");
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    choice.cells = parse_condition(filled_text(*cells, "cells"), cells->at, names);
  }
  choice.contacts = truth(table, "contacts");
  return choice;
}

void choose_recordings(const TrajectoryChoice& choice, const Catalogues& catalogues,
                       std::vector<Cell>& cells) {
  for (Cell& cell : cells) {
    if (!cell.excluded_why.empty() || !is_meant(choice, cell, catalogues)) continue;
    cell.recording =
        Recording{steps_between_frames(choice, cell), choice.precision, choice.contacts};
  }
}

Expected<void> check_recordable(std::span<const Cell> cells) {
  const auto recorded = [](const Cell& cell) { return cell.recording.has_value(); };
  if (has_trajectories() || std::ranges::none_of(cells, recorded)) return {};
  return fail(Fault::unsupported,
              fmt::format("the plan records trajectories, but {}", no_trajectories_reason()));
}

}  // namespace brickbench
