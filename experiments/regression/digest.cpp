#include "experiments/regression/digest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace brickbench::gate {
namespace {

using Axes = std::map<std::string, std::string>;

Axes parsed(const std::string& axes) {
  Axes parts;
  for (std::size_t at = 0; at < axes.size();) {
    const std::size_t end = std::min(axes.find(';', at), axes.size());
    const std::string axis = axes.substr(at, end - at);
    const std::size_t equals = std::min(axis.find('='), axis.size());
    parts[axis.substr(0, equals)] = equals < axis.size() ? axis.substr(equals + 1) : "";
    at = end + 1;
  }
  return parts;
}

// "friction 0.3 -> 0.285, step_s 0.001 -> 0.002"; "none" where one side does not name it.
std::string change_between(const std::string& before, const std::string& after) {
  const Axes a = parsed(before);
  const Axes b = parsed(after);
  std::set<std::string> names;
  for (const Axes* axes : {&a, &b}) {
    for (const auto& [name, value] : *axes) names.insert(name);
  }
  const auto text = [](const Axes& axes, const std::string& name) {
    const auto found = axes.find(name);
    return found == axes.end() ? std::string("none") : found->second;
  };
  std::string change;
  for (const std::string& name : names) {
    if (text(a, name) == text(b, name)) continue;
    change += fmt::format("{}{} {} -> {}", change.empty() ? "" : ", ", name, text(a, name),
                          text(b, name));
  }
  return change;
}

// Of one engine in one experiment: how many numbers each set of axes has of each kind.
struct Sides {
  std::map<std::string, std::size_t> missing;
  std::map<std::string, std::size_t> fresh;
  bool any_other = false;
};

}  // namespace

std::size_t ExperimentDigest::count(Finding finding) const {
  const auto found = counts.find(finding);
  return found == counts.end() ? 0 : found->second;
}

std::vector<ExperimentDigest> digest(const std::vector<Comparison>& comparisons) {
  std::vector<ExperimentDigest> all;
  for (const Comparison& c : comparisons) {
    auto place = std::ranges::find(all, c.experiment, &ExperimentDigest::name);
    if (place == all.end()) {
      all.push_back({c.experiment, {}, {}});
      place = std::prev(all.end());
    }
    ++place->numbers;
    ++place->counts[c.finding];
    place->compared += is_compared(c) ? 1U : 0U;
    if (is_red(c) && std::ranges::count(place->red_engines, c.obtained.engine) == 0) {
      place->red_engines.push_back(c.obtained.engine);
    }
  }
  std::ranges::stable_sort(all, std::greater{}, [](const ExperimentDigest& experiment) {
    return !experiment.red_engines.empty();
  });
  return all;
}

std::vector<ChangedSetting> changed_settings(const std::vector<Comparison>& comparisons) {
  std::map<std::pair<std::string, std::string>, Sides> groups;  // experiment, engine
  for (const Comparison& c : comparisons) {
    Sides& sides = groups[{c.experiment, c.obtained.engine}];
    if (c.finding == Finding::missing) {
      ++sides.missing[c.reference.axes];
    } else if (c.finding == Finding::fresh) {
      ++sides.fresh[c.obtained.axes];
    } else {
      sides.any_other = true;
    }
  }
  std::vector<ChangedSetting> changes;
  for (const auto& [who, sides] : groups) {
    if (sides.any_other || sides.missing.size() != 1 || sides.fresh.size() != 1) continue;
    const auto& [before, missing] = *sides.missing.begin();
    const auto& [after, fresh] = *sides.fresh.begin();
    const std::string change = change_between(before, after);
    auto place = std::ranges::find_if(changes, [&](const ChangedSetting& known) {
      return known.experiment == who.first && known.change == change;
    });
    if (place == changes.end()) {
      changes.push_back({who.first, {}, change});
      place = std::prev(changes.end());
    }
    place->engines.push_back(who.second);
    place->missing += missing;
    place->fresh += fresh;
  }
  return changes;
}

bool is_told_by(const std::vector<ChangedSetting>& changes, const Comparison& comparison) {
  if (comparison.finding != Finding::missing && comparison.finding != Finding::fresh) return false;
  return std::ranges::any_of(changes, [&](const ChangedSetting& change) {
    return change.experiment == comparison.experiment &&
           std::ranges::count(change.engines, comparison.obtained.engine) > 0;
  });
}

std::vector<const Comparison*> loose_bounds(const std::vector<Comparison>& comparisons) {
  std::vector<const Comparison*> loose;
  for (const Comparison& c : comparisons) {
    if (c.reference.kind != Kind::bound || !is_compared(c)) continue;
    if (c.reference_value != 0.0 && c.bound > std::abs(c.reference_value)) loose.push_back(&c);
  }
  std::ranges::stable_sort(loose, std::greater{}, [](const Comparison* c) {
    return c->bound / std::abs(c->reference_value);
  });
  return loose;
}

}  // namespace brickbench::gate
