#include "adapters/seam/adapter.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>

namespace brickbench {
namespace {

template <typename Items>
std::string names(const Items& items) {
  std::string text;
  for (const auto& item : items) {
    if (!text.empty()) text += ", ";
    text += item.name;
  }
  return text.empty() ? "none" : text;
}

template <typename Items>
bool contains(const Items& items, std::string_view name) {
  return std::ranges::any_of(items, [&](const auto& item) { return item.name == name; });
}

}  // namespace

double knob_or(const Settings& settings, std::string_view name, double otherwise) {
  const auto found = settings.knobs.find(name);
  return found == settings.knobs.end() ? otherwise : found->second;
}

Expected<void> validate(const Adapter& adapter, const Settings& settings) {
  if (!(std::isfinite(settings.step_s) && settings.step_s > 0.0)) {
    return fail(Fault::invalid, fmt::format("step {} s must be positive", settings.step_s));
  }
  if (settings.threads < 1) {
    return fail(Fault::invalid, fmt::format("{} threads: at least 1", settings.threads));
  }
  if (!settings.variant.empty() && !contains(adapter.variants, settings.variant)) {
    return fail(Fault::invalid, fmt::format("{} has no variant '{}'; it has {}", adapter.name,
                                            settings.variant, names(adapter.variants)));
  }
  for (const auto& [name, value] : settings.knobs) {
    if (!contains(adapter.knobs, name)) {
      return fail(Fault::invalid, fmt::format("{} has no knob '{}'; it has {}", adapter.name, name,
                                              names(adapter.knobs)));
    }
    if (!std::isfinite(value)) {
      return fail(Fault::invalid, fmt::format("knob {} of {} is not finite", name, adapter.name));
    }
  }
  return {};
}

Expected<std::unique_ptr<Simulation>> build(const Adapter& adapter, const World& world,
                                            Settings settings) {
  if (auto ok = validate(world); !ok) return tl::unexpected(ok.error());
  if (auto ok = validate(adapter, settings); !ok) return tl::unexpected(ok.error());
  if (settings.variant.empty()) settings.variant = adapter.variants.front().name;
  try {
    return adapter.build(world, settings);
  } catch (const std::bad_alloc&) {
    return fail(Fault::out_of_memory, fmt::format("{} ran out of memory", adapter.name));
  } catch (const std::exception& error) {
    return fail(Fault::crashed, fmt::format("{} threw: {}", adapter.name, error.what()));
  }
}

}  // namespace brickbench
