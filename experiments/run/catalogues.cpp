#include "experiments/run/catalogues.hpp"

#include <algorithm>

namespace brickbench {
namespace {

template <typename Items>
auto find_in(const Items& items, std::string_view name) -> const typename Items::value_type* {
  const auto found =
      std::ranges::find_if(items, [&](const auto& item) { return item.name == name; });
  return found == items.end() ? nullptr : &*found;
}

}  // namespace

const Scenario* find_scenario(const Catalogues& catalogues, std::string_view name) {
  return find_in(catalogues.scenarios, name);
}

const MetricInfo* find_metric(const Catalogues& catalogues, std::string_view name) {
  return find_in(catalogues.metrics, name);
}

const Adapter* find_adapter(const Catalogues& catalogues, std::string_view name) {
  return find_in(catalogues.adapters, name);
}

}  // namespace brickbench
