#include "reports/src/ensembles.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "experiments/statistics/measurement.hpp"
#include "reports/src/replay_source.hpp"
#include "reports/src/scene_names.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

// One contender in one scene.
struct Group {
  std::string experiment;
  std::string scene;
  std::string contender;
  auto operator<=>(const Group&) const = default;
};

// A number, or a curve, of a group.
struct Measured {
  Group group;
  std::string name;
  std::string unit;
  std::string better;
};

struct NumberSample {
  Measured what;
  StartSample sample;
};

struct CurveFan {
  Measured what;
  Fan fan;
};

Group group_of(const Row& row, const SceneNames& names) {
  return {row.experiment, names.brief(scene_of(row)), contender_of(row)};
}

void sort_by_start(StartSample& sample) {
  std::vector<std::pair<std::uint64_t, double>> both;
  for (std::size_t i = 0; i < sample.values.size(); ++i) {
    both.emplace_back(sample.starts[i], sample.values[i]);
  }
  std::ranges::sort(both);
  for (std::size_t i = 0; i < both.size(); ++i) {
    std::tie(sample.starts[i], sample.values[i]) = both[i];
  }
}

// In the order of the rows; numbers that are not applicable are left out.
std::vector<NumberSample> samples_of(const ReportSource& source, const SceneNames& names) {
  std::vector<NumberSample> samples;
  std::map<std::pair<Group, std::string>, std::size_t> known;
  for (const Row& row : source.rows) {
    const Group group = group_of(row, names);
    const auto [place, is_new] = known.emplace(std::pair{group, row.metric}, samples.size());
    if (is_new) samples.push_back({{group, row.metric, row.unit, row.better}, {}});
    StartSample& sample = samples[place->second].sample;
    if (row.value && std::isfinite(*row.value) && row.validity.empty()) {
      sample.starts.push_back(row.seed);
      sample.values.push_back(*row.value);
    } else {
      ++sample.without_value;
    }
  }
  std::erase_if(samples,
                [](const NumberSample& s) { return s.sample.values.size() < k_least_starts; });
  std::map<Group, std::vector<std::string>> names_of;
  for (const NumberSample& s : samples) names_of[s.what.group].push_back(s.what.name);
  std::erase_if(samples, [&](const NumberSample& s) {
    return !statistics::counts_once(s.what.name, names_of.at(s.what.group));
  });
  for (NumberSample& sample : samples) sort_by_start(sample.sample);
  return samples;
}

// Times that not every run reached are judged by the runs that did, as long as an ensemble is left.
Fan fan_of(const std::map<double, std::vector<double>>& values_at) {
  Fan fan;
  for (const auto& [time_s, unsorted] : values_at) {
    std::vector<double> values = unsorted;
    std::ranges::sort(values);
    fan.runs = std::max(fan.runs, values.size());
    if (values.size() < k_least_starts) continue;
    fan.time_s.push_back(time_s);
    fan.q05.push_back(quantile(values, 0.05));
    fan.q25.push_back(quantile(values, 0.25));
    fan.median.push_back(quantile(values, 0.5));
    fan.q75.push_back(quantile(values, 0.75));
    fan.q95.push_back(quantile(values, 0.95));
  }
  return fan;
}

std::vector<CurveFan> fans_of(const ReportSource& source, const SceneNames& names) {
  std::map<std::string, Group> groups;
  for (const Row& row : source.rows) {
    if (row.validity.empty()) groups.try_emplace(row.cell, group_of(row, names));
  }
  std::vector<Measured> order;
  std::map<std::pair<Group, std::string>, std::map<double, std::vector<double>>> values;
  for (const SeriesPoint& point : source.series) {
    const auto group = groups.find(point.cell);
    if (group == groups.end() || !std::isfinite(point.value)) continue;
    const auto [place, is_new] = values.try_emplace(std::pair{group->second, point.curve});
    if (is_new) order.push_back({group->second, point.curve, point.unit, "neither"});
    place->second[point.time_s].push_back(point.value);
  }
  std::vector<CurveFan> fans;
  for (const Measured& what : order) {
    Fan fan = fan_of(values.at({what.group, what.name}));
    if (fan.time_s.size() > 1) fans.push_back({what, std::move(fan)});
  }
  return fans;
}

// The item of `items` that `what` is to be compared with; nullptr if there is none.
template <typename Item>
const Item* partner_of(const Measured& what, const std::vector<Item>& items,
                       const std::vector<Item>& own) {
  const Item* same_experiment = nullptr;
  std::size_t candidates = 0;
  for (const Item& item : items) {
    if (item.what.name != what.name || item.what.group.experiment != what.group.experiment ||
        item.what.group.contender != what.group.contender)
      continue;
    if (item.what.group.scene == what.group.scene) return &item;
    same_experiment = &item;
    ++candidates;
  }
  const auto rivals = std::ranges::count_if(own, [&](const Item& item) {
    return item.what.name == what.name && item.what.group.experiment == what.group.experiment &&
           item.what.group.contender == what.group.contender;
  });
  return candidates == 1 && rivals == 1 ? same_experiment : nullptr;
}

FanGroup& fan_group(std::vector<FanGroup>& groups, const std::string& scene,
                    const std::string& subject, const Measured& what) {
  for (FanGroup& group : groups) {
    if (group.scene == scene && group.subject == subject && group.curve == what.name) return group;
  }
  groups.push_back({scene, subject, what.name, what.unit, {}});
  return groups.back();
}

}  // namespace

double quantile(const std::vector<double>& sorted, double probability) {
  const double at = probability * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double share = at - static_cast<double>(below);
  return share == 0.0 ? sorted[below] : (1.0 - share) * sorted[below] + share * sorted[above];
}

Ensembles ensembles_within(const ReportSource& source, const std::string& reference) {
  const SceneNames names(summarize(source.rows));
  const std::vector<NumberSample> samples = samples_of(source, names);
  Ensembles all;
  using Place = std::pair<std::string, std::string>;  // scene, number
  std::map<Place, const NumberSample*> references;
  for (const NumberSample& s : samples) {
    const auto [place, is_new] = references.emplace(Place{s.what.group.scene, s.what.name}, &s);
    if (!is_new && s.what.group.contender == reference) place->second = &s;
  }
  for (const NumberSample& s : samples) {
    const NumberSample* against = references.at({s.what.group.scene, s.what.name});
    if (against == &s) continue;
    EnsemblePair pair{s.what.group.scene, "", s.what.name, s.what.unit, s.what.better, {}, {}, {}};
    pair.reference = against->sample;
    pair.reference.label = against->what.group.contender;
    pair.judged = s.sample;
    pair.judged.label = s.what.group.contender;
    all.pairs.push_back(std::move(pair));
  }
  for (CurveFan& fan : fans_of(source, names)) {
    fan.fan.label = fan.what.group.contender;
    fan_group(all.fans, fan.what.group.scene, "", fan.what).fans.push_back(std::move(fan.fan));
  }
  return all;
}

Ensembles ensembles_between(const ReportSource& a, const ReportSource& b,
                            const std::string& label_a, const std::string& label_b) {
  const SceneNames names_a(summarize(a.rows));
  const SceneNames names_b(summarize(b.rows));
  Ensembles all;
  const auto samples_a = samples_of(a, names_a);
  const auto samples_b = samples_of(b, names_b);
  for (const NumberSample& judged : samples_b) {
    const NumberSample* before = partner_of(judged.what, samples_a, samples_b);
    if (before == nullptr) continue;
    const Measured& what = judged.what;
    EnsemblePair pair{what.group.scene, what.group.contender, what.name,     what.unit,
                      what.better,      before->sample,       judged.sample, {}};
    pair.reference.label = label_a;
    pair.judged.label = label_b;
    all.pairs.push_back(std::move(pair));
  }
  const auto fans_a = fans_of(a, names_a);
  const auto fans_b = fans_of(b, names_b);
  for (const CurveFan& judged : fans_b) {
    const CurveFan* before = partner_of(judged.what, fans_a, fans_b);
    if (before == nullptr) continue;
    const Group& group = judged.what.group;
    FanGroup& fans = fan_group(all.fans, group.scene, group.contender, judged.what);
    fans.fans = {before->fan, judged.fan};
    fans.fans[0].label = label_a;
    fans.fans[1].label = label_b;
  }
  return all;
}

}  // namespace brickbench
