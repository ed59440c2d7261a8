// Whether the numbers of a run are to be trusted: docs/metrics.md, section validity.
#include "experiments/metrics/validity.hpp"

#include <fmt/format.h>

#include <vector>

#include "experiments/metrics/entries.hpp"
#include "experiments/metrics/outputs.hpp"

namespace brickbench {
namespace {

std::string meaning_of(Flag flag) {
  switch (flag) {
    case Flag::unsolved:
      return "steps whose solver gave up or missed its tolerance, as the engine says";
    case Flag::clamped:
      return "steps in which the engine cut a state to what it can hold, as it says";
    case Flag::overlap_left:
      return "steps that left an overlap which the engine wanted to prevent, as it says";
    case Flag::contacts_dropped:
      return "steps in which contacts were found and left out, as the engine says";
    case Flag::tunnelled:
      return "steps in which a body passed another, from recorded poses alone";
  }
  return "";
}

const std::vector<OutputInfo>& outputs() {
  static const std::vector<OutputInfo> list = [] {
    std::vector<OutputInfo> all;
    for (const Flag flag : k_all_flags) {
      all.push_back({fmt::format("steps_{}", to_word(flag)), "1", Better::neither, meaning_of(flag),
                     "0: with any other, no number of the run is ranked, averaged or timed"});
    }
    return all;
  }();
  return list;
}

class ValidityMetric : public Metric {
 public:
  void observe(const Sample& sample) override { validity_.observe(sample); }

  void report(std::vector<Measurement>& out) const override {
    auto output = outputs().begin();
    for (const Flag flag : k_all_flags) {
      const auto& [steps, first] = validity_.of(flag);
      Value value = {static_cast<double>(steps)};
      if (steps > 0) value.note = fmt::format("from step {}", first);
      if (!validity_.is_told(flag)) {
        value = not_applicable("unsupported: neither the engine nor an observer tells this");
      }
      out.push_back({output->name, output->unit, value.value, value.note});
      ++output;
    }
  }

 private:
  Validity validity_;
};

}  // namespace

void Validity::observe(const Sample& sample) {
  if (sample.step == 0) return;
  ++steps_;
  tellable_ = sample.tellable;
  if (passage_.empty()) passage_ = sample.passage;
  for (const Flag flag : k_all_flags) {
    if (!sample.flags.has(flag)) continue;
    Tally& tally = tallies_[static_cast<std::size_t>(flag)];
    ++tally.steps;
    if (tally.first == 0) tally.first = sample.step;
  }
}

std::string Validity::text() const {
  std::string text;
  for (const Flag flag : k_all_flags) {
    const auto& [steps, first] = of(flag);
    if (steps == 0) continue;
    text += fmt::format("{}{} in {} of {} steps from step {}", text.empty() ? "" : "; ",
                        to_word(flag), steps, steps_, first);
    if (flag == Flag::tunnelled && !passage_.empty()) text += fmt::format(" ({})", passage_);
  }
  return text;
}

MetricInfo validity_metric() {
  return {.name = "validity",
          .meaning = "How many steps raised a flag: with one, no number of the run counts.",
          .outputs = outputs(),
          .curves = {},
          .make = [](const Scene&, double) -> std::unique_ptr<Metric> {
            return std::make_unique<ValidityMetric>();
          }};
}

}  // namespace brickbench
