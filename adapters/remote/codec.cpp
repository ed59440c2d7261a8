#include "adapters/remote/codec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "adapters/remote/frame.hpp"
#include "adapters/remote/world_json.hpp"
#include "adapters/seam/shape.hpp"

namespace brickbench::remote {
namespace {

constexpr std::size_t k_most_word_bytes = 64;
constexpr std::size_t k_most_line_bytes = 1000;
constexpr std::size_t k_most_variants = 64;
constexpr std::size_t k_most_knobs = 256;
constexpr std::size_t k_most_settings = 1000;
constexpr int k_most_threads = 4096;
constexpr double k_infinity = std::numeric_limits<double>::infinity();
constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

// The failures that an engine may report of itself; beyond time and energy the harness sees alone.
constexpr std::array k_reported = {Fault::unsupported, Fault::invalid, Fault::diverged,
                                   Fault::crashed, Fault::out_of_memory};

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// JSON knows no infinity: a knob that has such a value holds "inf" or "-inf".
Json value_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(value > 0.0 ? "inf" : "-inf");
}

double to_knob_value(const JsonValue& value) {
  if (!value.is_text()) return value.number();
  const std::string text = value.any_text(k_most_word_bytes);
  if (text == "inf") return k_infinity;
  if (text != "-inf") value.wrong("a number, inf or -inf");
  return -k_infinity;
}

// An infinite value is no one's choice, but may be the engine's own.
Expected<void> in_range(const Knob& knob, double value) {
  if (std::isinf(value) && knob.min <= value && value <= knob.max) return {};
  return validate(knob, value);
}

// No end of a range is null.
Json end_json(double end) { return std::isfinite(end) ? Json(end) : Json(nullptr); }

Json variant_json(const Variant& variant) {
  Json knobs = Json::object();
  for (const auto& [name, value] : variant.knobs) knobs[name] = value_json(value);
  return {{"name", variant.name},
          {"meaning", variant.meaning},
          {"precision", variant.precision},
          {"max_threads", variant.max_threads},
          {"knobs", knobs}};
}

Json knob_json(const Knob& knob) {
  return {{"name", knob.name},
          {"unit", knob.unit},
          {"engine_default", value_json(knob.engine_default)},
          {"min", end_json(knob.min)},
          {"max", end_json(knob.max)},
          {"whole", knob.whole},
          {"meaning", knob.meaning}};
}

Knob to_knob(const JsonValue& value) {
  value.only({"name", "unit", "engine_default", "min", "max", "whole", "meaning"});
  Knob knob;
  knob.name = value.at("name").word(k_most_word_bytes);
  knob.unit = value.at("unit").text(k_most_word_bytes);
  knob.engine_default = to_knob_value(value.at("engine_default"));
  knob.meaning = value.at("meaning").text(k_most_line_bytes);
  if (value.has("min")) knob.min = value.at("min").number_or(-k_infinity);
  if (value.has("max")) knob.max = value.at("max").number_or(k_infinity);
  knob.whole = value.has("whole") && value.at("whole").boolean();
  if (auto fits = in_range(knob, knob.engine_default); !fits) {
    value.at("engine_default").wrong("in the knob's range");
  }
  return knob;
}

Variant to_variant(const JsonValue& value, const std::vector<Knob>& known) {
  value.only({"name", "meaning", "precision", "max_threads", "knobs"});
  Variant variant;
  variant.name = value.at("name").word(k_most_word_bytes);
  variant.meaning = value.at("meaning").text(k_most_line_bytes);
  variant.precision = value.at("precision").text(k_most_word_bytes);
  if (variant.precision != "f64" && variant.precision != "f32") {
    value.at("precision").wrong("f64 or f32");
  }
  if (value.has("max_threads")) {
    variant.max_threads = value.at("max_threads").whole(1, k_most_threads);
  }
  if (!value.has("knobs")) return variant;
  for (const auto& [name, number] : value.at("knobs").entries(k_most_knobs)) {
    const auto knob = std::ranges::find(known, name, &Knob::name);
    if (knob == known.end()) number.wrong("the value of one of the knobs");
    if (auto fits = in_range(*knob, to_knob_value(number)); !fits) number.wrong(range_text(*knob));
    variant.knobs[name] = to_knob_value(number);
  }
  return variant;
}

template <typename Items>
void expect_distinct(const JsonValue& at, const Items& items) {
  std::set<std::string> names;
  for (const auto& item : items) {
    if (!names.insert(item.name).second) at.wrong("a list in which each name stands once");
  }
}

std::vector<std::string> to_shapes(const JsonValue& value) {
  std::vector<std::string> shapes;
  for (const JsonValue& item : value.items(k_most_variants)) {
    shapes.push_back(item.word(k_most_word_bytes));
  }
  return shapes;
}

BodyAudit to_body_audit(const JsonValue& value) {
  value.only({"fixed", "mass_kg", "inertia_kgm2", "shape", "linear_damping_hz",
              "angular_damping_hz", "can_sleep"});
  BodyAudit facts;
  facts.fixed = value.at("fixed").boolean();
  facts.mass_kg = value.at("mass_kg").number_or(k_nan);
  facts.inertia_kgm2 = value.at("inertia_kgm2").vector();
  facts.shape = to_shape(value.at("shape"));
  facts.linear_damping_hz = value.at("linear_damping_hz").number_or(k_nan);
  facts.angular_damping_hz = value.at("angular_damping_hz").number_or(k_nan);
  facts.can_sleep = value.at("can_sleep").boolean();
  return facts;
}

}  // namespace

std::string greeting() { return text_of({{"protocol", k_protocol}}); }

Expected<void> read_greeting(std::string_view json) {
  const auto version = checked([&] {
    const Json tree = JsonValue::parse("hello", json, k_most_json_bytes);
    return JsonValue("hello", tree).at("protocol").whole(0, std::numeric_limits<int>::max());
  });
  if (!version) return tl::unexpected(version.error());
  if (*version == k_protocol) return {};
  return fail(Fault::unsupported,
              fmt::format("the other side speaks protocol {}, this one {}", *version, k_protocol));
}

std::string to_json(const Hello& hello) {
  auto variants = Json::array(), knobs = Json::array();
  for (const Variant& variant : hello.variants) variants.push_back(variant_json(variant));
  for (const Knob& knob : hello.knobs) knobs.push_back(knob_json(knob));
  return text_of({{"protocol", k_protocol},
                  {"name", hello.name},
                  {"version", hello.version},
                  {"shapes", hello.shapes},
                  {"variants", variants},
                  {"knobs", knobs}});
}

Expected<Hello> to_hello(std::string_view json) {
  // The version comes first: another one may look quite different.
  if (auto same = read_greeting(json); !same) {
    return fail(Fault::crashed, same.error().reason);
  }
  return checked([&] {
    const Json tree = JsonValue::parse("hello", json, k_most_json_bytes);
    const JsonValue value("hello", tree);
    value.only({"protocol", "name", "version", "shapes", "variants", "knobs"});
    Hello hello;
    hello.name = value.at("name").text(k_most_word_bytes);
    hello.version = value.at("version").text(k_most_line_bytes);
    hello.shapes = to_shapes(value.at("shapes"));
    if (value.has("knobs")) {
      for (const JsonValue& item : value.at("knobs").items(k_most_knobs)) {
        hello.knobs.push_back(to_knob(item));
      }
      expect_distinct(value.at("knobs"), hello.knobs);
    }
    for (const JsonValue& item : value.at("variants").items(k_most_variants)) {
      hello.variants.push_back(to_variant(item, hello.knobs));
    }
    if (hello.variants.empty()) value.at("variants").wrong("a list of at least one variant");
    expect_distinct(value.at("variants"), hello.variants);
    return hello;
  });
}

std::string to_json(const Built& built) {
  auto views = Json::array();
  if (built.contacts) views.push_back("contacts");
  if (built.set_state) views.push_back("set_state");
  if (built.audit) views.push_back("audit");
  if (built.diagnostics) views.push_back("diagnostics");
  return text_of({{"views", views}, {"cpu_s", built.cpu_s}});
}

Expected<Built> to_built(std::string_view json) {
  return checked([&] {
    const Json tree = JsonValue::parse("built", json, k_most_json_bytes);
    const JsonValue value("built", tree);
    value.only({"views", "cpu_s"});
    Built built;
    for (const JsonValue& item : value.at("views").items(k_most_variants)) {
      const std::string view = item.any_text(k_most_word_bytes);
      if (view == "contacts") {
        built.contacts = true;
      } else if (view == "set_state") {
        built.set_state = true;
      } else if (view == "audit") {
        built.audit = true;
      } else if (view == "diagnostics") {
        built.diagnostics = true;
      } else {
        item.wrong("one of contacts, set_state, audit, diagnostics");
      }
    }
    built.cpu_s = value.at("cpu_s").number();
    if (built.cpu_s < 0.0) value.at("cpu_s").wrong("a time of at least 0");
    return built;
  });
}

std::string to_json(const BuildOrder& order) {
  Json knobs = Json::object();
  for (const auto& [name, value] : order.settings.knobs) knobs[name] = value_json(value);
  return text_of({{"world", world_json(order.world)},
                  {"settings",
                   {{"step_s", order.settings.step_s},
                    {"variant", order.settings.variant},
                    {"knobs", knobs},
                    {"threads", order.settings.threads}}}});
}

Expected<BuildOrder> to_build_order(std::string_view json, std::size_t most_bytes) {
  return checked([&] {
    const Json tree = JsonValue::parse("build", json, most_bytes);
    const JsonValue value("build", tree);
    value.only({"world", "settings"});
    BuildOrder order;
    order.world = to_world(value.at("world"));
    const JsonValue settings = value.at("settings");
    settings.only({"step_s", "variant", "knobs", "threads"});
    order.settings.step_s = settings.at("step_s").number();
    order.settings.variant = settings.at("variant").word(k_most_word_bytes);
    order.settings.threads = settings.at("threads").whole(1, k_most_threads);
    for (const auto& [name, number] : settings.at("knobs").entries(k_most_knobs)) {
      order.settings.knobs[name] = to_knob_value(number);
    }
    return order;
  });
}

std::string to_json(const Audit& audit) {
  auto bodies = Json::array();
  for (const BodyAudit& facts : audit.bodies) {
    bodies.push_back({{"fixed", facts.fixed},
                      {"mass_kg", facts.mass_kg},
                      {"inertia_kgm2", vector_json(facts.inertia_kgm2)},
                      {"shape", shape_json(facts.shape)},
                      {"linear_damping_hz", facts.linear_damping_hz},
                      {"angular_damping_hz", facts.angular_damping_hz},
                      {"can_sleep", facts.can_sleep}});
  }
  auto settings = Json::array();
  for (const AuditFact& fact : audit.settings) {
    settings.push_back({{"name", fact.name}, {"unit", fact.unit}, {"value", fact.value}});
  }
  return text_of({{"gravity_mps2", vector_json(audit.gravity_mps2)},
                  {"bodies", bodies},
                  {"settings", settings}});
}

Expected<Audit> to_audit(std::string_view json, std::size_t most_bytes) {
  return checked([&] {
    const Json tree = JsonValue::parse("audit", json, most_bytes);
    const JsonValue value("audit", tree);
    value.only({"gravity_mps2", "bodies", "settings"});
    Audit audit;
    audit.gravity_mps2 = value.at("gravity_mps2").vector();
    for (const JsonValue& body : value.at("bodies").items(most_bytes)) {
      audit.bodies.push_back(to_body_audit(body));
    }
    for (const JsonValue& fact : value.at("settings").items(k_most_settings)) {
      fact.only({"name", "unit", "value"});
      audit.settings.push_back({fact.at("name").text(k_most_line_bytes),
                                fact.at("unit").any_text(k_most_word_bytes),
                                fact.at("value").any_text(k_most_line_bytes)});
    }
    return audit;
  });
}

std::string to_json(const Failure& failure) {
  return text_of({{"fault", to_outcome(failure.fault)}, {"reason", failure.reason}});
}

Expected<Failure> to_failure(std::string_view json) {
  return checked([&] {
    const Json tree = JsonValue::parse("failed", json, k_most_json_bytes);
    const JsonValue value("failed", tree);
    value.only({"fault", "reason"});
    const std::string word = value.at("fault").any_text(k_most_word_bytes);
    const auto fault = std::ranges::find(k_reported, word, &to_outcome);
    if (fault == k_reported.end()) {
      value.at("fault").wrong("one of refused, invalid, diverged, crashed, out_of_memory");
    }
    return Failure{*fault, readable(value.at("reason").any_text(k_most_json_bytes), 2000)};
  });
}

}  // namespace brickbench::remote
