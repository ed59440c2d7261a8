#include "adapters/seam/adapter.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
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

// "0.5 m", and "0.5" for pure numbers.
std::string with_unit(double value, const std::string& unit) {
  return unit == "1" || unit.empty() ? fmt::format("{}", value) : fmt::format("{} {}", value, unit);
}

}  // namespace

double knob_or(const Settings& settings, std::string_view name, double otherwise) {
  const auto found = settings.knobs.find(name);
  return found == settings.knobs.end() ? otherwise : found->second;
}

const Variant& variant_of(const Adapter& adapter, std::string_view name) {
  if (name.empty()) return adapter.variants.front();
  const auto found = std::ranges::find(adapter.variants, name, &Variant::name);
  assert(found != adapter.variants.end());
  return *found;
}

std::string precision_text(const Adapter& adapter) {
  if (adapter.variants.empty()) return "";
  const std::string& first = adapter.variants.front().precision;
  std::string text = first;
  for (const Variant& variant : adapter.variants) {
    if (variant.precision == first) continue;
    text += fmt::format("{} {} {}", text == first ? ";" : ",", variant.name, variant.precision);
  }
  return text;
}

std::string range_text(const Knob& knob) {
  std::string text = knob.whole ? "whole numbers" : "numbers";
  const bool below = std::isfinite(knob.min), above = std::isfinite(knob.max);
  if (below)
    text += (above ? " from " : " of at least ") + with_unit(knob.min, above ? "1" : knob.unit);
  if (above) text += (below ? " to " : " of at most ") + with_unit(knob.max, knob.unit);
  return text;
}

Expected<void> validate(const Knob& knob, double value) {
  if (!std::isfinite(value)) {
    return fail(Fault::invalid, fmt::format("knob {} is not finite", knob.name));
  }
  if (value < knob.min || value > knob.max || (knob.whole && value != std::floor(value))) {
    return fail(Fault::invalid, fmt::format("knob {} = {}: allowed are {}", knob.name,
                                            with_unit(value, knob.unit), range_text(knob)));
  }
  return {};
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
    const auto knob = std::ranges::find(adapter.knobs, name, &Knob::name);
    if (knob == adapter.knobs.end()) {
      return fail(Fault::invalid, fmt::format("{} has no knob '{}'; it has {}", adapter.name, name,
                                              names(adapter.knobs)));
    }
    if (auto ok = validate(*knob, value); !ok) return ok;
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
