#include "reports/src/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "experiments/statistics/bootstrap.hpp"
#include "reports/src/flags.hpp"
#include "reports/src/replay_source.hpp"
#include "reports/src/scene_names.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

using AxisMap = std::map<std::string, std::set<std::string>>;  // name: values

template <typename Visit>
void each_axis(const std::string& axes, const Visit& visit) {
  for (std::size_t at = 0; at < axes.size();) {
    const std::size_t end = std::min(axes.find(';', at), axes.size());
    const std::string axis = axes.substr(at, end - at);
    const std::size_t equals = std::min(axis.find('='), axis.size());
    visit(axis.substr(0, equals), equals < axis.size() ? axis.substr(equals + 1) : "", axis);
    at = end + 1;
  }
}

// The values of each "experiment/axis"; the step and the duration are axes too.
AxisMap axis_values(const ReportSource& source) {
  AxisMap values;
  for (const Row& row : source.rows) {
    each_axis(row.axes, [&](const auto& name, const auto& value, const auto&) {
      values[row.experiment + '/' + name].insert(value);
    });
    values[row.experiment + "/step_s"].insert(shortest(row.step_s));
    values[row.experiment + "/duration_s"].insert(shortest(row.duration_s));
  }
  return values;
}

// Axes with one value in each folder that is not the same, or that only one folder names: what was
// set differently.
std::map<std::string, std::string> turned_axes(const AxisMap& a, const AxisMap& b,
                                               const std::set<std::string>& shared) {
  std::map<std::string, std::string> turned;
  const auto text = [](const AxisMap& map, const std::string& name) {
    const auto found = map.find(name);
    return found == map.end() ? std::string("not said") : *found->second.begin();
  };
  const auto count = [](const AxisMap& map, const std::string& name) {
    const auto found = map.find(name);
    return found == map.end() ? std::size_t{0} : found->second.size();
  };
  std::set<std::string> names;
  for (const auto* map : {&a, &b}) {
    for (const auto& [name, values] : *map) names.insert(name);
  }
  for (const std::string& name : names) {
    if (!shared.contains(name.substr(0, name.find('/')))) continue;
    if (count(a, name) > 1 || count(b, name) > 1) continue;
    if (text(a, name) != text(b, name)) {
      turned[name] = fmt::format("{} -> {}", text(a, name), text(b, name));
    }
  }
  return turned;
}

struct Values {
  std::string scene;
  std::string engine;
  std::string unit;
  std::string better;
  std::vector<double> values;      // valid ones
  std::set<std::string> outcomes;  // other than ok
  std::size_t flagged = 0;
  std::set<std::string> flags;  // their words
};

using Key = std::vector<std::string>;

Key key_of(const std::string& experiment, const std::string& engine, const std::string& variant,
           double step_s, const std::string& axes,
           const std::map<std::string, std::string>& turned) {
  Key key = {experiment, engine, variant};
  if (!turned.contains(experiment + "/step_s")) key.push_back(shortest(step_s));
  each_axis(axes, [&](const auto& name, const auto&, const auto& axis) {
    if (!turned.contains(experiment + '/' + name)) key.push_back(axis);
  });
  return key;
}

std::map<Key, Values> numbers_of(const ReportSource& source,
                                 const std::map<std::string, std::string>& turned) {
  std::map<Key, Values> numbers;
  const SceneNames names(summarize(source.rows));
  for (const Row& row : source.rows) {
    Key key = key_of(row.experiment, row.engine, row.variant, row.step_s, row.axes, turned);
    key.push_back(row.metric);
    Values& values = numbers[key];
    values.scene = names.brief(scene_of(row));
    values.engine = contender_of(row);
    values.unit = row.unit;
    values.better = row.better;
    if (!row.value) {
      values.outcomes.insert(row.outcome);
    } else if (row.validity.empty()) {
      values.values.push_back(*row.value);
    } else {
      ++values.flagged;
      for (std::string& word : flag_words(row.validity)) values.flags.insert(std::move(word));
    }
  }
  for (auto& [key, values] : numbers) std::ranges::sort(values.values);
  return numbers;
}

std::optional<double> median(const std::vector<double>& sorted) {
  if (sorted.empty()) return {};
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

std::optional<double> mean(const std::vector<double>& values) {
  if (values.empty()) return {};
  return statistics::moments(values).mean;
}

double half_range(const std::vector<double>& sorted) {
  return sorted.empty() ? 0.0 : 0.5 * (sorted.back() - sorted.front());
}

std::string outcome_words(const Values& values) {
  std::vector<std::string> words(values.outcomes.begin(), values.outcomes.end());
  if (values.flagged > 0) {
    words.push_back(fmt::format("{} (flagged)", fmt::join(values.flags, ", ")));
  }
  if (words.empty()) return "ok";
  std::string text = fmt::format("{}", fmt::join(words, "+"));
  return values.values.empty() ? text : fmt::format("{} ok, some {}", values.values.size(), text);
}

// Identical folders yield nothing here.
std::optional<Change> change_between(const std::string& number, const Values& a, const Values& b) {
  const bool same_kinds = a.outcomes == b.outcomes && a.flagged == b.flagged && a.flags == b.flags;
  if (a.values == b.values && same_kinds) return {};
  Change change;
  change.scene = b.scene;
  change.engine = b.engine;
  change.number = number;
  change.unit = b.unit;
  change.before = mean(a.values);
  change.after = mean(b.values);
  if (a.values.size() != b.values.size() || !same_kinds) {
    change.kind = ChangeKind::outcome;
    change.relative = std::numeric_limits<double>::infinity();
    change.words = outcome_words(a) + " -> " + outcome_words(b);
    change.worse = a.values.size() > b.values.size();
    return change;
  }
  const double scale = std::max(std::abs(*change.before), std::abs(*change.after));
  const double moved = *change.after - *change.before;
  change.relative = scale > 0.0 ? std::abs(moved) / scale : 0.0;
  change.noise = scale > 0.0 ? std::max(half_range(a.values), half_range(b.values)) / scale : 0.0;
  const bool is_beyond = std::abs(moved) > k_rounding_absolute &&
                         change.relative > std::max(change.noise, k_rounding_relative);
  change.kind = is_beyond ? ChangeKind::beyond_noise : ChangeKind::within_noise;
  change.worse = (b.better == "lower" && moved > 0.0) || (b.better == "higher" && moved < 0.0);
  return change;
}

void compare_facts(const ReportSource& a, const ReportSource& b,
                   const std::map<std::string, std::string>& turned, FolderComparison& out) {
  const auto fact = [&](const std::string& name, const std::string& before,
                        const std::string& after) {
    if (before != after) out.facts.push_back(fmt::format("{}: {} -> {}", name, before, after));
  };
  fact("revision", a.provenance.machine.revision, b.provenance.machine.revision);
  fact("machine", a.provenance.machine.label(), b.provenance.machine.label());
  fact("compiler", a.provenance.machine.compiler, b.provenance.machine.compiler);
  fact("flags", a.provenance.machine.flags, b.provenance.machine.flags);
  std::map<std::string, std::string> versions;
  for (const EngineRecord& engine : a.provenance.engines) versions[engine.name] = engine.version;
  for (const EngineRecord& engine : b.provenance.engines) {
    const auto found = versions.find(engine.name);
    if (found != versions.end()) fact("version of " + engine.name, found->second, engine.version);
  }
  for (const auto& [name, words] : turned) out.facts.push_back(name + ": " + words);
}

void compare_timings(const ReportSource& a, const ReportSource& b,
                     const std::map<std::string, std::string>& turned, FolderComparison& out) {
  std::set<std::string> untimed;
  const auto collect = [&](const ReportSource& source) {
    std::map<Key, std::vector<double>> medians;
    for (const Timing& timing : source.timings) {
      if (timing.steps == 0) continue;
      if (timing.outcome != "ok" || !timing.validity.empty()) {
        untimed.insert(fmt::format("{}/{}, {}: not comparable: {}", timing.engine, timing.variant,
                                   timing.experiment,
                                   timing.validity.empty() ? timing.outcome : timing.validity));
        continue;
      }
      medians[key_of(timing.experiment, timing.engine, timing.variant, timing.step_s, timing.axes,
                     turned)]
          .push_back(timing.step_median_cpu_s);
    }
    for (auto& [key, values] : medians) std::ranges::sort(values);
    return medians;
  };
  const auto before = collect(a);
  for (const auto& [key, values] : collect(b)) {
    const auto found = before.find(key);
    if (found == before.end()) continue;
    Change change;
    change.scene = key[0];
    change.engine = key[1] + '/' + key[2];
    change.number = "step_median_cpu_s";
    change.unit = "s";
    change.before = median(found->second);
    change.after = median(values);
    const double scale = std::max(*change.before, *change.after);
    change.relative = scale > 0.0 ? std::abs(*change.after - *change.before) / scale : 0.0;
    change.noise = k_timing_noise_relative;
    change.worse = *change.after > *change.before;
    if (change.relative > change.noise) out.timings.push_back(change);
  }
  out.untimed.assign(untimed.begin(), untimed.end());
}

double severity(const Change& change) {
  if (change.kind == ChangeKind::outcome) return std::numeric_limits<double>::infinity();
  return change.kind == ChangeKind::beyond_noise ? change.relative : change.relative - 1e6;
}

}  // namespace

FolderComparison compare(const ReportSource& a, const ReportSource& b) {
  FolderComparison out;
  std::set<std::string> in_a;
  std::set<std::string> shared;
  for (const Row& row : a.rows) in_a.insert(row.experiment);
  for (const Row& row : b.rows) {
    if (in_a.contains(row.experiment)) shared.insert(row.experiment);
  }
  const auto turned = turned_axes(axis_values(a), axis_values(b), shared);
  compare_facts(a, b, turned, out);
  const auto before = numbers_of(a, turned);
  const auto after = numbers_of(b, turned);
  std::set<std::string> lost;
  std::set<std::string> gained;
  for (const auto& [key, values] : before) {
    const auto found = after.find(key);
    if (found == after.end()) {
      lost.insert(values.scene + ", " + values.engine);
      continue;
    }
    const bool comparable = !values.values.empty() && !found->second.values.empty();
    const bool flagged = values.flagged > 0 || found->second.flagged > 0;
    ++(comparable ? out.compared : flagged ? out.flagged : out.without_number);
    const auto change = change_between(key.back(), values, found->second);
    if (!change) {
      out.same += comparable ? 1U : 0U;
      continue;
    }
    if (change->kind != ChangeKind::within_noise) ++out.beyond_noise;
    out.changes.push_back(*change);
  }
  for (const auto& [key, values] : after) {
    if (!before.contains(key)) gained.insert(values.scene + ", " + values.engine);
  }
  out.only_in_a.assign(lost.begin(), lost.end());
  out.only_in_b.assign(gained.begin(), gained.end());
  std::ranges::stable_sort(out.changes, std::greater{}, severity);
  compare_timings(a, b, turned, out);
  return out;
}

}  // namespace brickbench
