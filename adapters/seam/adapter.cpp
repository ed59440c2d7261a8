#include "adapters/seam/adapter.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "adapters/seam/guard.hpp"
#include "adapters/seam/unit.hpp"

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
  return fmt::format("{}{}", value, unit_suffix(unit));
}

}  // namespace

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
  const Variant& variant = variant_of(adapter, settings.variant);
  for (const auto& [name, value] : settings.knobs) {
    const auto known = std::ranges::find(adapter.knobs, name, &Knob::name);
    if (known == adapter.knobs.end()) {
      return fail(Fault::invalid, fmt::format("{} has no knob '{}'; it has {}", adapter.name, name,
                                              names(adapter.knobs)));
    }
    if (auto ok = validate(*known, value); !ok) return ok;
    if (!variant.knobs.contains(name)) {
      return fail(Fault::invalid, fmt::format("variant '{}' has no knob '{}'; other variants do",
                                              variant.name, name));
    }
  }
  if (settings.threads > variant.max_threads) {
    return fail(Fault::unsupported,
                fmt::format("{} threads: {}/{} can have {} at most", settings.threads, adapter.name,
                            variant.name, variant.max_threads));
  }
  return {};
}

Settings settled(const Adapter& adapter, Settings settings) {
  const Variant& variant = variant_of(adapter, settings.variant);
  settings.variant = variant.name;
  settings.knobs.insert(variant.knobs.begin(), variant.knobs.end());  // keeps what is turned
  return settings;
}

double knob(const Settings& settings, std::string_view name) {
  const auto found = settings.knobs.find(name);
  assert(found != settings.knobs.end());
  return found->second;
}

Expected<std::unique_ptr<Simulation>> build(const Adapter& adapter, const World& world,
                                            const Settings& settings) {
  if (auto ok = validate(world); !ok) return tl::unexpected(ok.error());
  if (auto ok = validate(adapter, settings); !ok) return tl::unexpected(ok.error());
  return build_guarded(adapter, world, settled(adapter, settings));
}

std::optional<Scheme> scheme_of(const Adapter& adapter, const Settings& settings) {
  return adapter.scheme ? adapter.scheme(settled(adapter, settings)) : std::nullopt;
}

std::vector<AuditFact> asked_of(const Adapter& adapter, const World& world,
                                const Settings& settings) {
  if (!adapter.asked) return {};
  return adapter.asked(world, settled(adapter, settings));
}

}  // namespace brickbench
