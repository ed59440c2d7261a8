#include "cli/check_output.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "adapters/seam/unit.hpp"
#include "cli/json_number.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/regression/digest.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;
using gate::Finding;

constexpr std::size_t k_open_shown = 5;

std::string metric_name(const gate::Comparison& c) {
  return c.obtained.metric.empty() ? "state hash" : c.obtained.metric;
}

Json record_json(const std::string& command, const gate::Comparison& c) {
  return {{"id", c.experiment + '|' + c.obtained.key()},
          {"experiment", c.experiment},
          {"engine", c.obtained.engine},
          {"axes", c.obtained.axes},
          {"metric", c.obtained.metric},
          {"unit", c.obtained.unit},
          {"kind", gate::to_word(c.reference.kind)},
          {"finding", gate::to_word(c.finding)},
          {"trend", gate::to_word(c.trend)},
          {"reference", json_number(c.reference_value)},
          {"got", json_number(c.obtained_value)},
          {"difference", json_number(c.difference)},
          {"bound", json_number(c.bound)},
          {"factor_over", json_number(c.factor)},
          {"p_value", json_number(c.p_value)},
          {"validity", c.obtained.validity.value_or("")},
          {"starts", c.obtained.seeds.size()},
          {"message", c.message},
          {"reproduce", gate::reproduce(command, c)}};
}

// One line per experiment: what became of its numbers, and who is red.
void print_experiments(const gate::CheckResult& result) {
  for (const gate::ExperimentDigest& e : gate::digest(result.comparisons)) {
    std::string red;
    for (const std::string& engine : e.red_engines) red += (red.empty() ? "" : ", ") + engine;
    fmt::print(
        "{:<4} {}: {} of {} numbers compared, {} fine, {} open, {} deviate, {} missing, {} "
        "new{}\n",
        red.empty() ? "ok" : "RED", e.name, e.compared, e.numbers, e.count(Finding::fine),
        e.count(Finding::open), e.count(Finding::deviation), e.count(Finding::missing),
        e.count(Finding::fresh), red.empty() ? "" : "; red: " + red);
  }
}

void print_changes(const std::vector<gate::ChangedSetting>& changes) {
  for (const gate::ChangedSetting& change : changes) {
    fmt::print(
        "setting changed in {}: {} ({}): {} references of the old setting were not run, {} "
        "numbers of the new one have none\n",
        change.experiment, change.change,
        change.engines.size() == 1 ? change.engines.front()
                                   : fmt::format("{} engines", change.engines.size()),
        change.missing, change.fresh);
  }
}

void print_offenders(const gate::CheckResult& result,
                     const std::vector<gate::ChangedSetting>& changes, std::size_t worst) {
  std::size_t shown = 0;
  std::size_t red = 0;
  for (const gate::Comparison& c : result.comparisons) {
    if (!gate::is_red(c) || gate::is_told_by(changes, c)) continue;
    ++red;
    if (shown >= worst) continue;
    ++shown;
    const std::string_view trend = gate::to_word(c.trend);
    fmt::print("{} {} {} {}{}\n    {}\n    {}\n", gate::to_word(c.finding), c.experiment,
               c.obtained.engine, metric_name(c), trend.empty() ? "" : fmt::format(" ({})", trend),
               c.message, gate::reproduce(result.command, c));
  }
  if (red > shown) fmt::print("... and {} more; --worst {} shows all\n", red - shown, red);
}

void print_open(const gate::CheckResult& result) {
  std::size_t shown = 0;
  for (const gate::Comparison& c : result.comparisons) {
    if (c.finding != Finding::open || shown++ >= k_open_shown) continue;
    fmt::print("{} {} {}: {}\n", c.experiment, c.obtained.engine, metric_name(c), c.message);
  }
  if (shown > k_open_shown)
    fmt::print("... and {} more open; --json has all\n", shown - k_open_shown);
}

void print_loose_bounds(const gate::CheckResult& result) {
  const auto loose = gate::loose_bounds(result.comparisons);
  if (loose.empty()) return;
  const gate::Comparison& worst = *loose.front();
  const std::string unit = unit_suffix(worst.reference.unit);
  fmt::print(
      "warning: {} bounds are wider than the numbers that they guard. The widest: {} {} {}, "
      "{:.3g}{} +- {:.3g}{}\n",
      loose.size(), worst.experiment, worst.obtained.engine, metric_name(worst),
      worst.reference_value, unit, worst.bound, unit);
}

std::string bless_command(const CheckTold& told, const std::string& from) {
  std::vector<std::string> words = {"brickbench", "bless", "--from", from};
  if (told.reference != "reference_data/baseline") {
    words.insert(words.end(), {"--reference", told.reference});
  }
  return shell_command(words) + " --reason '...'";
}

// What to do with numbers that are new or deviate.
void print_next(const gate::CheckResult& result, const CheckTold& told) {
  const auto has = [&](Finding finding) {
    return std::ranges::count(result.comparisons, finding, &gate::Comparison::finding) > 0;
  };
  if (has(Finding::deviation) || has(Finding::missing)) {
    fmt::print(
        "If the change is wanted, run all starts and accept them:\n    {} --all-starts "
        "--obtained obtained/new\n    {}\n",
        result.command, bless_command(told, "obtained/new"));
  } else if (has(Finding::fresh)) {
    fmt::print("If the new numbers are right, make them references:\n    {}\n",
               bless_command(told, told.obtained));
  }
}

std::size_t count(const gate::CheckResult& result, Finding finding) {
  return static_cast<std::size_t>(
      std::ranges::count(result.comparisons, finding, &gate::Comparison::finding));
}

}  // namespace

void print_check(const gate::CheckResult& result, const CheckTold& told) {
  print_experiments(result);
  const auto changes = gate::changed_settings(result.comparisons);
  print_changes(changes);
  print_offenders(result, changes, told.worst);
  print_open(result);
  print_loose_bounds(result);
  fmt::print(
      "{} numbers, {} compared: {} fine, {} open, {} deviate. Not compared: {} flagged, {} without "
      "a number on either side, {} hashes of another platform, {} without reference, {} missing. "
      "{} cells run, {} spared.\nObtained: {}\n",
      result.comparisons.size(), std::ranges::count_if(result.comparisons, gate::is_compared),
      count(result, Finding::fine), count(result, Finding::open), count(result, Finding::deviation),
      count(result, Finding::flagged), count(result, Finding::no_number),
      count(result, Finding::not_comparable), count(result, Finding::fresh),
      count(result, Finding::missing), result.cells.size(), result.cells_spared, told.obtained);
  print_next(result, told);
}

Json check_json(const gate::CheckResult& result, const CheckTold& told, int exit_code) {
  auto records = Json::array();
  for (const auto& c : result.comparisons) records.push_back(record_json(result.command, c));
  auto experiments = Json::array();
  for (const gate::ExperimentDigest& e : gate::digest(result.comparisons)) {
    Json counts = Json::object();
    for (const auto& [finding, many] : e.counts) counts[std::string(gate::to_word(finding))] = many;
    experiments.push_back({{"id", e.name}, {"counts", counts}, {"red_engines", e.red_engines}});
  }
  auto changes = Json::array();
  for (const gate::ChangedSetting& change : gate::changed_settings(result.comparisons)) {
    changes.push_back({{"experiment", change.experiment},
                       {"engines", change.engines},
                       {"change", change.change},
                       {"missing", change.missing},
                       {"new", change.fresh}});
  }
  auto loose = Json::array();
  for (const gate::Comparison* c : gate::loose_bounds(result.comparisons)) {
    loose.push_back(c->experiment + '|' + c->obtained.key());
  }
  return {{"suite", told.suite},
          {"exit_code", exit_code},
          {"reference", told.reference},
          {"is_first", told.is_first},
          {"obtained", told.obtained},
          {"cells_run", result.cells.size()},
          {"cells_spared", result.cells_spared},
          {"compared", std::ranges::count_if(result.comparisons, gate::is_compared)},
          {"experiments", experiments},
          {"changed_settings", changes},
          {"loose_bounds", loose},
          {"records", records}};
}

}  // namespace brickbench
