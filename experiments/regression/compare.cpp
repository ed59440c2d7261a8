#include "experiments/regression/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "adapters/seam/unit.hpp"

namespace brickbench::gate {
namespace {

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Trend trend_of(const Comparison& c) {
  if (c.finding != Finding::deviation || c.difference == 0.0) return Trend::none;
  if (c.reference.better == "lower") return c.difference < 0.0 ? Trend::better : Trend::worse;
  if (c.reference.better == "higher") return c.difference > 0.0 ? Trend::better : Trend::worse;
  return Trend::none;
}

void judge_hash(Comparison& c) {
  const Record& r = c.reference;
  const Record& o = c.obtained;
  if (r.engine_version != o.engine_version || r.precision != o.precision ||
      r.platform != o.platform) {
    c.finding = Finding::not_comparable;
    c.message =
        fmt::format("hash of {} {} on {}, here {} {} on {}: not comparable", r.engine_version,
                    r.precision, r.platform, o.engine_version, o.precision, o.platform);
    return;
  }
  if (r.hashes == o.hashes) return;
  c.finding = Finding::deviation;
  c.factor = HUGE_VAL;
  c.message =
      fmt::format("states are not bit for bit those of the reference: {} instead of {}",
                  o.hashes.empty() ? "none" : o.hashes[0], r.hashes.empty() ? "none" : r.hashes[0]);
}

void judge_bound(Comparison& c) {
  c.bound = c.reference.bound;
  for (std::size_t i = 0; i < c.obtained.seeds.size(); ++i) {
    const auto at = std::ranges::find(c.reference.seeds, c.obtained.seeds[i]);
    if (at == c.reference.seeds.end()) continue;
    const double before =
        c.reference.values[static_cast<std::size_t>(at - c.reference.seeds.begin())];
    const double difference = c.obtained.values[i] - before;
    if (i > 0 && std::abs(difference) <= std::abs(c.difference)) continue;
    c.difference = difference;
    c.reference_value = before;
    c.obtained_value = c.obtained.values[i];
  }
  if (std::abs(c.difference) <= c.bound) return;
  c.finding = Finding::deviation;
  c.factor = c.bound > 0.0 ? std::abs(c.difference) / c.bound : HUGE_VAL;
  const std::string unit = unit_suffix(c.reference.unit);
  c.message =
      fmt::format("{}{} instead of {}{}: difference {:.3g}, bound {:.3g}, {:.3g} times over",
                  c.obtained_value, unit, c.reference_value, unit, c.difference, c.bound, c.factor);
}

// Only the seeds that both sides have count, so that the starts are the same.
void common(const Record& reference, const Record& obtained, std::vector<double>& a,
            std::vector<double>& b) {
  for (std::size_t i = 0; i < obtained.seeds.size(); ++i) {
    const auto at = std::ranges::find(reference.seeds, obtained.seeds[i]);
    if (at == reference.seeds.end()) continue;
    a.push_back(reference.values[static_cast<std::size_t>(at - reference.seeds.begin())]);
    b.push_back(obtained.values[i]);
  }
}

void judge_sample(Comparison& c, const ComparePlan& plan) {
  std::vector<double> a, b;
  common(c.reference, c.obtained, a, b);
  if (a.size() < 2) {
    c.finding = Finding::missing;
    c.message = "fewer than two starts in common with the reference";
    return;
  }
  c.reference_value = mean(a);
  c.obtained_value = mean(b);
  c.difference = c.obtained_value - c.reference_value;
  const double margin = std::max(c.reference.margin, 1e-300);
  const Look look = look_at(a, b, margin, plan.sequential);
  c.identical = look.verdict == Verdict::identical;
  c.p_value = c.identical ? 1.0 : look.test.p_value;
  if (c.identical) {
    c.message = fmt::format("identical in {} starts", a.size());
  } else if (look.mean.equivalent) {
    c.message = fmt::format("same within {:.3g}{} ({} starts)", margin,
                            unit_suffix(c.reference.unit), a.size());
  } else {
    const std::size_t needed = look.mean.runs_needed;
    c.finding = Finding::open;
    c.message = fmt::format(
        "no difference found in {} starts (p = {:.3g}), but not enough for 'same within {:.3g}"
        "{}': "
        "{} more needed",
        a.size(), c.p_value, margin, unit_suffix(c.reference.unit),
        needed > a.size() ? needed - a.size() : std::size_t{1});
  }
}

bool is_sample(const Comparison& c) {
  return c.finding != Finding::fresh && c.reference.kind == Kind::distribution &&
         c.obtained.kind == Kind::distribution && c.reference.outcome == "ok" &&
         c.obtained.outcome == "ok";
}

bool is_identical(const Record& reference, const Record& obtained) {
  std::vector<double> a, b;
  common(reference, obtained, a, b);
  return a == b;
}

// The smallest p-value must be able to reject in the family that there is.
ComparePlan for_family(const std::vector<Comparison>& all, const ComparePlan& plan) {
  const auto tests = std::ranges::count_if(all, [](const Comparison& c) {
    return is_sample(c) && !is_identical(c.reference, c.obtained);
  });
  const double level = plan.alpha / static_cast<double>(plan.sequential.looks);
  ComparePlan fitted = plan;
  std::size_t& permutations = fitted.sequential.permutation.permutations;
  permutations = relabellings_for(static_cast<std::size_t>(tests), level, permutations);
  return fitted;
}

std::string validity_text(const std::optional<std::string>& validity) {
  if (!validity) return "unknown: the reference does not say";
  return validity->empty() ? "valid" : *validity;
}

// Whether flags decide: numbers that are not to be trusted are not compared, and a run that came to
// be so is a deviation.
bool judge_validity(Comparison& c) {
  const auto& before = c.reference.validity;
  const bool flagged = !c.obtained.validity.value_or("").empty();
  const bool was_flagged = before && !before->empty();
  if (!flagged && !was_flagged) return false;
  c.finding = before && !was_flagged ? Finding::deviation : Finding::flagged;
  if (c.finding == Finding::deviation) c.factor = HUGE_VAL;
  const bool same =
      c.reference.values == c.obtained.values && c.reference.hashes == c.obtained.hashes;
  c.message = fmt::format("not to be trusted: {} (reference: {}); bit for bit {}",
                          validity_text(c.obtained.validity), validity_text(before),
                          same ? "the same" : "not the same");
  return true;
}

void judge(Comparison& c, const ComparePlan& plan) {
  if (c.reference.outcome != c.obtained.outcome || c.reference.kind != c.obtained.kind) {
    c.finding = Finding::deviation;
    c.factor = HUGE_VAL;
    c.message =
        fmt::format("{} ({}) instead of {} ({})", c.obtained.outcome, to_word(c.obtained.kind),
                    c.reference.outcome, to_word(c.reference.kind));
    return;
  }
  if (c.reference.outcome != "ok") {
    c.finding = Finding::no_number;
    c.message = fmt::format("neither side has a number: {}", c.reference.outcome);
    return;
  }
  if (judge_validity(c)) return;
  if (c.reference.kind == Kind::hash) judge_hash(c);
  if (c.reference.kind == Kind::bound) judge_bound(c);
  if (c.reference.kind == Kind::distribution) judge_sample(c, plan);
}

// Rejections over the family of all samples of the suite that were tested.
void control_family(std::vector<Comparison>& all, const ComparePlan& plan) {
  std::vector<std::size_t> tested;
  std::vector<double> p_values;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].reference.kind != Kind::distribution || all[i].reference.outcome != "ok") continue;
    if (all[i].finding != Finding::fine && all[i].finding != Finding::open) continue;
    if (all[i].identical) continue;
    tested.push_back(i);
    p_values.push_back(all[i].p_value);
  }
  const double level = plan.alpha / static_cast<double>(plan.sequential.looks);
  const std::vector<bool> rejected = holm(p_values, level);
  for (std::size_t k = 0; k < tested.size(); ++k) {
    if (!rejected[k]) continue;
    Comparison& c = all[tested[k]];
    c.finding = Finding::deviation;
    c.bound = level / static_cast<double>(tested.size());
    c.factor = c.bound / c.p_value;
    c.message = fmt::format(
        "not the distribution of the reference: mean {:.6g} instead of {:.6g}{}, p = {:.2g} in a "
        "family of {} tests",
        c.obtained_value, c.reference_value, unit_suffix(c.reference.unit), c.p_value,
        tested.size());
  }
}

}  // namespace

std::vector<Comparison> compare(const Suite& reference, const Suite& obtained,
                                const ComparePlan& plan, bool complete) {
  std::vector<Comparison> all;
  for (const Suite::Experiment& experiment : obtained.experiments) {
    for (const Record& record : experiment.records) {
      Comparison c;
      c.experiment = experiment.name;
      c.obtained = record;
      if (const Record* known = reference.find(experiment.name, record.key())) {
        c.reference = *known;
      } else {
        c.reference = record;
        c.finding = Finding::fresh;
        c.message = "no reference yet";
      }
      all.push_back(std::move(c));
    }
  }
  const ComparePlan fitted = for_family(all, plan);
  for (Comparison& c : all) {
    if (c.finding != Finding::fresh) judge(c, fitted);
  }
  for (const Suite::Experiment& experiment : reference.experiments) {
    for (const Record& record : experiment.records) {
      if (!complete || obtained.find(experiment.name, record.key()) != nullptr) continue;
      Comparison c;
      c.experiment = experiment.name;
      c.reference = c.obtained = record;
      c.finding = Finding::missing;
      c.message = "the reference has this, the run does not";
      all.push_back(std::move(c));
    }
  }
  control_family(all, plan);
  for (Comparison& c : all) c.trend = trend_of(c);
  std::ranges::stable_sort(all, [](const Comparison& a, const Comparison& b) {
    if (is_red(a) != is_red(b)) return is_red(a);
    return a.factor > b.factor;
  });
  return all;
}

bool is_compared(const Comparison& comparison) {
  return comparison.finding == Finding::fine || comparison.finding == Finding::open ||
         comparison.finding == Finding::deviation;
}

bool is_red(const Comparison& comparison) {
  return comparison.finding == Finding::deviation || comparison.finding == Finding::missing;
}

std::string_view to_word(Finding finding) {
  switch (finding) {
    case Finding::fine:
      return "fine";
    case Finding::open:
      return "open";
    case Finding::not_comparable:
      return "not_comparable";
    case Finding::flagged:
      return "flagged";
    case Finding::no_number:
      return "no_number";
    case Finding::deviation:
      return "deviation";
    case Finding::missing:
      return "missing";
    case Finding::fresh:
      return "fresh";
  }
  return "fine";
}

std::string_view to_word(Trend trend) {
  switch (trend) {
    case Trend::none:
      return "";
    case Trend::better:
      return "better";
    case Trend::worse:
      return "worse";
  }
  return "";
}

}  // namespace brickbench::gate
