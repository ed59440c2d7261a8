// Every setting that an engine offers arrives in its live objects, and one that does not is named.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "adapters/catalog.hpp"
#include "experiments/exact/validation/audit.hpp"

namespace brickbench::exact {
namespace {

// A knob that allows a law to be left out and changes nothing in the engine; pair_law() shows it.
const std::set<std::string> k_permissions = {"ignore_friction"};

World brick_above_ground() {
  World world;
  State above;
  above.position_m.z() = 1.0;
  world.bodies = {ground_plane(), solid_body("brick", BoxShape{{0.125, 0.06, 0.0325}}, 2.0, above)};
  return world;
}

struct Subject {
  Adapter adapter;
  Settings settings;
  World world = brick_above_ground();

  std::string label() const { return adapter.name + '/' + settings.variant; }
  std::vector<AuditFact> asked() const { return asked_of(adapter, world, settings); }
  // What differs between the live engine and the settings asked for; nullopt: it was not built.
  std::optional<std::vector<std::string>> differences(const std::vector<AuditFact>& asked) const {
    const auto built = build(adapter, world, settings);
    if (!built || (*built)->audit_view() == nullptr) return std::nullopt;
    return audit_differences(world, *(*built)->audit_view(), asked);
  }
};

std::vector<Subject> subjects() {
  std::vector<Subject> all;
  for (const Adapter& adapter : adapters()) {
    for (const Variant& variant : adapter.variants) {
      Subject subject{.adapter = adapter, .settings = {}};
      subject.settings.variant = variant.name;
      all.push_back(subject);
    }
  }
  return all;
}

std::string text(const std::vector<std::string>& sentences) {
  std::string all;
  for (const std::string& sentence : sentences) all += sentence + "; ";
  return all;
}

bool same(const std::vector<AuditFact>& a, const std::vector<AuditFact>& b) {
  return std::ranges::equal(a, b, [](const AuditFact& x, const AuditFact& y) {
    return x.name == y.name && x.value == y.value;
  });
}

TEST(SettingsAudit, OwnValuesOfEveryVariantArrive) {
  std::string wrong;
  for (const Subject& subject : subjects()) {
    if (!subject.adapter.asked || subject.asked().empty()) {
      wrong += subject.label() + " does not say what it asks for; ";
      continue;
    }
    const auto differences = subject.differences(subject.asked());
    if (!differences) wrong += subject.label() + " has no audit; ";
    if (differences) wrong += text(*differences);
  }
  EXPECT_EQ(wrong, "");
}

// The number that the text begins with, else `otherwise`.
double number_in(const std::string& text, double otherwise) {
  std::from_chars(text.data(), text.data() + text.size(), otherwise);
  return otherwise;
}

// Turned: the knob arrives. Compared with what stands without it: the audit names one setting.
void turn(const Subject& plain, const Knob& knob, std::set<std::string>& seen, std::string& wrong) {
  const std::vector<AuditFact> asked = plain.asked();
  const auto now = std::ranges::find(asked, knob.name, &AuditFact::name);
  const double value =
      now == asked.end() ? knob.engine_default : number_in(now->value, knob.engine_default);
  for (const double other : {2.0 * value, 0.5 * value, 1.0 - value, value + 1.0, value - 1.0}) {
    Subject turned = plain;
    turned.settings.knobs[knob.name] = other;
    if (other == value || !validate(turned.adapter, turned.settings)) continue;
    const auto arrived = turned.differences(turned.asked());
    if (!arrived || same(turned.asked(), asked)) continue;
    seen.insert(plain.adapter.name + ' ' + knob.name);
    if (!arrived->empty()) wrong += plain.label() + ": " + text(*arrived);
    const auto named = turned.differences(asked);
    if (named->size() != 1) wrong += plain.label() + " does not miss " + knob.name + "; ";
    return;
  }
}

TEST(SettingsAudit, EveryKnobArrivesAndIsMissedWhereItIsNotAskedFor) {
  std::set<std::string> seen;
  std::string wrong;
  for (const Subject& subject : subjects()) {
    for (const Knob& knob : subject.adapter.knobs) turn(subject, knob, seen, wrong);
  }
  for (const Adapter& adapter : adapters()) {
    for (const Knob& knob : adapter.knobs) {
      if (k_permissions.contains(knob.name) || seen.contains(adapter.name + ' ' + knob.name)) {
        continue;
      }
      wrong += adapter.name + " never shows its knob " + knob.name + "; ";
    }
  }
  EXPECT_EQ(wrong, "");
}

TEST(SettingsAudit, StepIsAmongThem) {
  std::string wrong;
  for (Subject subject : subjects()) {
    subject.settings.step_s = 0.004;
    const auto asked = subject.asked();
    subject.settings.step_s = 0.002;
    const auto differences = subject.differences(asked);
    const bool named =
        differences && std::ranges::any_of(*differences, [](const auto& sentence) {
          return sentence.find("'step_s': 0.002 s instead of 0.004 s") != std::string::npos;
        });
    if (!named) wrong += subject.label() + "; ";
  }
  EXPECT_EQ(wrong, "");
}

}  // namespace
}  // namespace brickbench::exact
