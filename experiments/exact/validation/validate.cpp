#include "experiments/exact/validation/validate.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/exact/schemes/scheme_map.hpp"
#include "experiments/exact/validation/audit.hpp"

namespace brickbench::exact {
namespace {

double bound_of(const ExactCase& exact_case) {
  return exact_case.needs.contacts == Contacts::none ? k_contact_free_bound : k_contact_bound;
}

// An event that the one has and the other lacks is infinitely far; two lacking events agree.
double distance(double a, double b, double scale) {
  if (std::isnan(a) && std::isnan(b)) return 0.0;
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<double>::infinity();
  return std::abs(a - b) / scale;
}

Expected<void> check_audit(const Adapter& adapter, const Settings& settings, const World& world,
                           const Simulation& simulation) {
  const AuditView* view = simulation.audit_view();
  if (view == nullptr) return {};
  const std::vector<std::string> differences =
      audit_differences(world, *view, asked_of(adapter, world, settings));
  if (differences.empty()) return {};
  return fail(Fault::invalid, fmt::format("{}", fmt::join(differences, "; ")));
}

Expected<std::vector<double>> play(Stepper& stepper, const ExactCase& exact_case,
                                   const ExactRun& run) {
  const bool forces = exact_case.needs.contact_forces;
  Recorder recorder(run, exact_case.observables.size());
  recorder.see(stepper.sample(forces));
  while (stepper.done() < run.steps) {
    if (auto ok = stepper.advance(); !ok) return tl::unexpected(ok.error());
    recorder.see(stepper.sample(forces));
  }
  return recorder.values();
}

Score make_score(const Observable& observable, const Truth& truth) {
  Score score;
  score.observable = observable.name;
  score.unit = observable.unit;
  score.truth = truth.value;
  score.scale = truth.scale;
  return score;
}

void note(const Failure& failure, CellResult& cell) {
  cell.outcome = failure.fault == Fault::invalid ? "audit" : to_outcome(failure.fault);
  cell.reason = failure.reason;
}

// Halves the bracket until it is k_threshold_width of the critical value wide.
Expected<Bracket> bisect(const Adapter& adapter, const std::string& variant,
                         const ExactCase& exact_case, const ParameterValues& given,
                         const KnobValues& knobs) {
  const Threshold& threshold = *exact_case.threshold;
  const ParameterValues values = complete(exact_case, given).value();
  Bracket bracket;
  bracket.parameter = threshold.parameter;
  const Parameter& searched =
      *std::ranges::find(exact_case.parameters, threshold.parameter, &Parameter::name);
  bracket.unit = searched.unit;
  bracket.truth = threshold.critical(values);
  bracket.low = std::max(searched.minimum, bracket.truth * threshold.low_factor);
  bracket.high = std::min(searched.maximum, bracket.truth * threshold.high_factor);
  const auto happens = [&](double value) -> Expected<bool> {
    ParameterValues at = given;
    at[threshold.parameter] = value;
    const auto run = build(exact_case, at);
    if (!run) return tl::unexpected(run.error());
    const auto measured = measure(adapter, variant, exact_case, *run, knobs);
    if (!measured) return tl::unexpected(measured.error());
    return threshold.happened(*measured) == threshold.above;
  };
  const auto at_low = happens(bracket.low), at_high = happens(bracket.high);
  if (!at_low) return tl::unexpected(at_low.error());
  if (!at_high) return tl::unexpected(at_high.error());
  bracket.found = !*at_low && *at_high;
  // An odd factor: the midpoints avoid the exact critical value itself.
  while (bracket.found && bracket.high - bracket.low > k_threshold_width * bracket.truth) {
    const double middle = bracket.low + 0.4871 * (bracket.high - bracket.low);
    const auto above = happens(middle);
    if (!above) return tl::unexpected(above.error());
    (*above ? bracket.high : bracket.low) = middle;
  }
  return bracket;
}

}  // namespace

bool CellResult::failed() const {
  if (outcome == "refused") return false;
  if (outcome != "ok") return true;
  const auto worst = worst_unexplained();
  return worst && !(*worst <= bound);
}

std::optional<double> CellResult::worst_unexplained() const {
  std::optional<double> worst;
  for (const Score& score : scores) {
    if (!score.unexplained) continue;
    // What is not a number stays: it is within no bound.
    const double so_far = worst.value_or(0.0);
    worst = std::isnan(so_far) || *score.unexplained <= so_far ? so_far : *score.unexplained;
  }
  return worst;
}

Settings settings_of(const Adapter& adapter, const std::string& variant, const ExactRun& run,
                     const KnobValues& knobs) {
  Settings settings;
  settings.knobs = knobs;
  settings.step_s = run.step_s;
  settings.variant = variant.empty() ? adapter.variants.front().name : variant;
  return settings;
}

CellResult predict(const Adapter& adapter, const std::string& variant, const ExactCase& exact_case,
                   const ExactRun& run, const KnobValues& knobs) {
  const Settings settings = settings_of(adapter, variant, run, knobs);
  CellResult cell;
  cell.engine = adapter.name;
  cell.variant = settings.variant;
  cell.case_id = exact_case.id;
  cell.bound = bound_of(exact_case);
  for (std::size_t i = 0; i < run.truths.size(); ++i) {
    cell.scores.push_back(make_score(exact_case.observables[i], run.truths[i]));
  }
  const std::optional<Scheme> scheme = scheme_of(adapter, settings);
  if (!scheme) {
    cell.no_prediction = "the engine states no scheme";
    return cell;
  }
  const auto predicted = discrete_truth(exact_case, run, *scheme, &cell.no_prediction);
  if (!predicted) return cell;
  for (std::size_t i = 0; i < cell.scores.size(); ++i) {
    Score& score = cell.scores[i];
    score.predicted = (*predicted)[i];
    score.explained = distance((*predicted)[i], score.truth, score.scale);
  }
  return cell;
}

Expected<std::vector<double>> measure(const Adapter& adapter, const std::string& variant,
                                      const ExactCase& exact_case, const ExactRun& run,
                                      const KnobValues& knobs) {
  const Settings settings = settings_of(adapter, variant, run, knobs);
  auto stepper = Stepper::start(adapter, run.world, settings, run.load);
  if (!stepper) return tl::unexpected(stepper.error());
  if (auto ok = check_audit(adapter, settings, run.world, stepper->simulation()); !ok) {
    return tl::unexpected(ok.error());
  }
  return play(*stepper, exact_case, run);
}

CellResult validate_at(const Adapter& adapter, const std::string& variant,
                       const ExactCase& exact_case, const ParameterValues& given,
                       const KnobValues& knobs) {
  CellResult cell;
  cell.engine = adapter.name;
  cell.variant = variant.empty() ? adapter.variants.front().name : variant;
  cell.case_id = exact_case.id;
  const auto run = build(exact_case, given);
  if (!run) {
    note(run.error(), cell);
    return cell;
  }
  cell = predict(adapter, variant, exact_case, *run, knobs);
  const auto measured = measure(adapter, variant, exact_case, *run, knobs);
  if (!measured) {
    note(measured.error(), cell);
    return cell;
  }
  for (std::size_t i = 0; i < cell.scores.size(); ++i) {
    Score& score = cell.scores[i];
    score.measured = (*measured)[i];
    score.error = distance(score.measured, score.truth, score.scale);
    if (score.predicted) {
      score.unexplained = distance(score.measured, *score.predicted, score.scale);
    }
  }
  if (exact_case.classify != nullptr) cell.law = exact_case.classify(*measured, *run);
  return cell;
}

CellResult validate(const Adapter& adapter, const std::string& variant, const ExactCase& exact_case,
                    const ParameterValues& given, const KnobValues& knobs) {
  CellResult cell = validate_at(adapter, variant, exact_case, given, knobs);
  if (cell.outcome != "ok" || !exact_case.threshold) return cell;
  const auto bracket = bisect(adapter, variant, exact_case, given, knobs);
  if (bracket) {
    cell.bracket = *bracket;
  } else {
    note(bracket.error(), cell);
  }
  return cell;
}

std::vector<ExactCase> select_cases(const std::vector<ExactCase>& cases,
                                    const std::string& selector) {
  std::vector<ExactCase> chosen;
  const bool family = selector.ends_with(".*");
  const std::string prefix = family ? selector.substr(0, selector.size() - 1) : std::string();
  for (const ExactCase& exact_case : cases) {
    const bool fits = selector == "all" || selector == exact_case.id ||
                      (family && exact_case.id.starts_with(prefix));
    if (fits) chosen.push_back(exact_case);
  }
  return chosen;
}

}  // namespace brickbench::exact
