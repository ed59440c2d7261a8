#include "experiments/regression/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "adapters/seam/unit.hpp"
#include "experiments/statistics/measurement.hpp"

namespace brickbench::gate {
namespace {

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

std::string runs_text(std::size_t more) {
  constexpr std::size_t k_nobody_runs = 10000;
  return more > k_nobody_runs ? fmt::format("over {}", k_nobody_runs) : fmt::format("{}", more);
}

// "some/variant 0.31 m, the reference 0.29 m (means of 24 starts), p = 1.2e-06, threshold 8.3e-06".
std::string both_means(const Comparison& c, std::size_t starts) {
  const std::string unit = unit_suffix(c.reference.unit);
  return fmt::format(
      "{} has {:.6g}{}, its reference {:.6g}{} (means of {} starts); p = {:.2g}, "
      "threshold {:.2g}",
      c.obtained.engine, c.obtained_value, unit, c.reference_value, unit, starts, c.p_value,
      c.bound);
}

void tell_sample(Comparison& c, const statistics::Look& look, std::size_t starts) {
  const std::string within =
      fmt::format("within {:.3g}{}", c.reference.margin, unit_suffix(c.reference.unit));
  switch (look.verdict) {
    case statistics::Verdict::identical:
      c.message = fmt::format("identical in {} starts", starts);
      return;
    case statistics::Verdict::same:
      c.message = fmt::format("same {}: {}", within, both_means(c, starts));
      return;
    case statistics::Verdict::different:
      c.finding = Finding::deviation;
      c.factor = c.bound / c.p_value;
      c.message = "another distribution: " + both_means(c, starts);
      return;
    case statistics::Verdict::not_enough_runs:
      c.finding = Finding::open;
      c.message = fmt::format(
          "open: {}. A difference of this size would be shown by {} more starts, 'same {}' by {} "
          "more",
          both_means(c, starts), runs_text(look.more_for_difference), within,
          runs_text(look.more_for_same));
      return;
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
  c.reference_value = statistics::moments(a).mean;
  c.obtained_value = statistics::moments(b).mean;
  c.difference = c.obtained_value - c.reference_value;
  const statistics::LookPlan levels = look_plan(plan, c.reference.seeds.size());
  const statistics::Look look = statistics::look_at(a, b, c.reference.margin, levels);
  c.identical = look.verdict == statistics::Verdict::identical;
  c.p_value = look.test.p_value;
  c.bound = levels.level_different;
  tell_sample(c, look, a.size());
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

}  // namespace

statistics::LookPlan look_plan(const ComparePlan& plan, std::size_t starts) {
  const auto before_last =
      std::ranges::count_if(plan.looks, [&](std::size_t look) { return look < starts; });
  const double looks = 1.0 + static_cast<double>(before_last);
  statistics::LookPlan levels;
  levels.level_different =
      std::max(plan.alpha_different / looks, statistics::least_p(starts, starts));
  levels.level_same = plan.alpha_same / looks;
  levels.permutation = plan.permutation;
  levels.permutation.permutations =
      statistics::relabellings_for(levels.level_different, plan.permutation.permutations);
  return levels;
}

Suite counted_once(const Suite& suite) {
  Suite kept;
  for (const Suite::Experiment& experiment : suite.experiments) {
    std::map<std::string, std::vector<std::string>> names;
    for (const Record& r : experiment.records) names[r.engine + '|' + r.axes].push_back(r.metric);
    kept.experiments.push_back({experiment.name, {}});
    for (const Record& r : experiment.records) {
      if (!statistics::counts_once(r.metric, names.at(r.engine + '|' + r.axes))) continue;
      kept.experiments.back().records.push_back(r);
    }
  }
  return kept;
}

std::vector<Comparison> compare(const Suite& references, const Suite& numbers,
                                const ComparePlan& plan, bool complete) {
  const Suite reference = counted_once(references);
  const Suite obtained = counted_once(numbers);
  std::vector<Comparison> all;
  for (const Suite::Experiment& experiment : obtained.experiments) {
    for (const Record& record : experiment.records) {
      Comparison c;
      c.experiment = experiment.name;
      c.obtained = record;
      if (const Record* known = reference.find(experiment.name, record.key())) {
        c.reference = *known;
        judge(c, plan);
      } else {
        c.reference = record;
        c.finding = Finding::fresh;
        c.message = "no reference yet";
      }
      all.push_back(std::move(c));
    }
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
