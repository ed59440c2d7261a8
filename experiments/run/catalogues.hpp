// Catalogues: everything that a plan can name. Passed in by value or reference, never global.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "adapters/seam/adapter.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

struct Catalogues {
  std::vector<Scenario> scenarios;
  std::vector<MetricInfo> metrics;
  std::vector<Adapter> adapters;           // linked into this build, and programs that run
  std::vector<std::string> known_engines;  // that the project has an adapter for, linked or not
  std::map<std::string, std::string> why_absent = {};  // known engine -> why its program is no use
};

// nullptr if there is none of that name.
const Scenario* find_scenario(const Catalogues& catalogues, std::string_view name);
const MetricInfo* find_metric(const Catalogues& catalogues, std::string_view name);
const Adapter* find_adapter(const Catalogues& catalogues, std::string_view name);

template <typename Items>
std::vector<std::string> names_of(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

}  // namespace brickbench
