// What the engine says about itself: docs/metrics.md, section contacts.
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/metrics/compensated_sum.hpp"
#include "experiments/metrics/entries.hpp"
#include "experiments/metrics/outputs.hpp"

namespace brickbench {
namespace {

const std::vector<OutputInfo>& outputs() {
  static const std::vector<OutputInfo> list = {
      {"contacts_mean", "1", Better::neither, "mean number of contact points per step",
       "four per touching face: fewer may not hold a stack, more only cost time"},
      {"contacts_max", "1", Better::neither, "largest number of contact points in a step",
       "below the engine's buffer: at its limit contacts were dropped"}};
  return list;
}

const std::vector<OutputInfo>& curves() {
  static const std::vector<OutputInfo> list = {{"contacts_now", "1", Better::neither,
                                                "contact points of the last step",
                                                "constant while a wall stands"}};
  return list;
}

// Mean and maximum of a number that may be NaN: then both are.
struct Statistic {
  CompensatedSum sum;
  double largest = -std::numeric_limits<double>::infinity();
  double largest_s = 0.0;
  double count = 0.0;

  void see(double value, double time_s) {
    sum += value;
    count += 1.0;
    if (std::isnan(largest) || !(std::isnan(value) || value > largest)) return;
    largest = value;
    largest_s = time_s;
  }
};

class Contacts : public Metric {
 public:
  void observe(const Sample& sample) override {
    if (sample.step == 0) return;
    told_ = sample.contacts != nullptr;
    if (told_) {
      now_ = static_cast<double>(sample.contacts->size());
      contacts_.see(now_, sample.time_s);
    }
    for (const Diagnostic& diagnostic : sample.diagnostics) see(diagnostic, sample.time_s);
  }

  void report(std::vector<Measurement>& out) const override {
    if (contacts_.count == 0.0) {
      emit_none(out, outputs(), not_applicable("the engine does not tell its contacts").note);
    } else {
      emit(out, outputs(),
           {{contacts_.sum.value() / contacts_.count},
            {contacts_.largest, at_time(contacts_.largest_s)}});
    }
    for (const auto& [diagnostic, statistic] : diagnostics_) {
      const std::string stem = "diag_" + diagnostic.name;
      const double mean = statistic.sum.value() / statistic.count;
      const std::string when = at_time(statistic.largest_s);
      const std::string bad = std::string(k_not_finite) + "the engine told it " + when;
      out.push_back({stem + "_max", diagnostic.unit, statistic.largest,
                     std::isfinite(statistic.largest) ? when : bad});
      out.push_back({stem + "_mean", diagnostic.unit, mean, std::isfinite(mean) ? "" : bad});
    }
  }

  void trace(std::vector<Measurement>& out) const override {
    if (!told_) {
      return emit_none(out, curves(), not_applicable("the engine does not tell its contacts").note);
    }
    emit(out, curves(), {{now_}});
  }

 private:
  struct Told {
    Diagnostic diagnostic;
    Statistic statistic;
  };

  // An engine tells a handful of diagnostics, so a linear look-up is enough.
  void see(const Diagnostic& diagnostic, double time_s) {
    auto told = std::find_if(diagnostics_.begin(), diagnostics_.end(), [&](const Told& known) {
      return known.diagnostic.name == diagnostic.name;
    });
    if (told == diagnostics_.end()) told = diagnostics_.insert(told, {diagnostic, {}});
    told->statistic.see(diagnostic.value, time_s);
  }

  Statistic contacts_;
  double now_ = 0.0;
  bool told_ = false;
  std::vector<Told> diagnostics_;
};

}  // namespace

MetricInfo contacts_metric() {
  return {
      .name = "contacts",
      .meaning =
          "Contact points, and for every diagnostic X of the engine diag_X_max and diag_X_mean: "
          "what the engine says about itself, passed on unchecked.",
      .outputs = outputs(),
      .curves = curves(),
      .make = [](const Scene&, double) -> std::unique_ptr<Metric> {
        return std::make_unique<Contacts>();
      }};
}

}  // namespace brickbench
