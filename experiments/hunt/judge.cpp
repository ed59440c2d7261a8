#include "experiments/hunt/judge.hpp"

#include <algorithm>
#include <string>

#include "experiments/exact/validation/validate.hpp"
#include "experiments/hunt/image_oracle.hpp"
#include "experiments/hunt/motion.hpp"

namespace brickbench::hunt {
namespace {

// The number of states that differ in any bit is not told, only from which step on.
std::optional<Breach> repetition_breach(const Motion& first, const Motion& second) {
  if (fingerprint(first) == fingerprint(second)) return std::nullopt;
  std::size_t step = 0;
  const std::size_t common = std::min(first.states.size(), second.states.size());
  while (step < common && hash_states(first.states[step]) == hash_states(second.states[step])) {
    ++step;
  }
  return Breach{"repetition", 1.0, 0.0, "1", step, static_cast<double>(step) * first.step_s, ""};
}

Verdict judge_case(const Trial& trial, const Adapter& adapter) {
  Verdict verdict;
  const auto cases = exact::select_cases(exact::exact_cases(), trial.scene);
  if (cases.empty()) {
    verdict.outcome = to_outcome(Fault::invalid);
    verdict.reason = "there is no exact case '" + trial.scene + "'";
    return verdict;
  }
  const exact::CellResult cell =
      exact::validate(adapter, trial.engine.variant, cases.front(), trial.parameters, trial.knobs);
  verdict.outcome = cell.outcome;
  verdict.reason = cell.reason;
  const auto worst = cell.worst_unexplained();
  if (cell.outcome == "ok" && worst && !(*worst <= cell.bound)) {
    verdict.breaches.push_back({"scheme", *worst, cell.bound, "1", 0, 0.0, ""});
  }
  return verdict;
}

}  // namespace

const Breach* Verdict::find(std::string_view oracle) const {
  const auto found = std::ranges::find(breaches, oracle, &Breach::oracle);
  return found == breaches.end() ? nullptr : &*found;
}

void read_flags(const Motion& motion, Verdict& verdict) {
  if (verdict.outcome != "ok" || !motion.flag || verdict.breaches.empty()) return;
  const auto before = [&](const Breach& breach) { return breach.step < motion.flagged_step; };
  if (std::ranges::any_of(verdict.breaches, before)) return;
  verdict.outcome = to_word(*motion.flag);
  verdict.reason = "told in step " + std::to_string(motion.flagged_step);
}

Verdict judge_crash(const std::string& reason) {
  Verdict verdict;
  verdict.outcome = to_outcome(Fault::crashed);
  verdict.reason = reason;
  verdict.breaches.push_back({"process", 1.0, 0.0, "1", 0, 0.0, ""});
  return verdict;
}

Verdict judge(const Trial& trial, const Catalogues& catalogues) {
  Verdict verdict;
  const Adapter* adapter = find_adapter(catalogues, trial.engine.engine);
  if (adapter != nullptr && trial.source == Source::exact_case) {
    return judge_case(trial, *adapter);
  }
  const auto scene = scene_of(trial, catalogues);
  if (adapter == nullptr || !scene) {
    verdict.outcome = to_outcome(Fault::invalid);
    verdict.reason = scene ? "there is no such engine" : scene.error().reason;
    return verdict;
  }
  const Settings settings = settings_of(trial);
  const Motion motion = run_motion(*adapter, settings, *scene, trial.steps);
  verdict.outcome = motion.outcome;
  verdict.reason = motion.reason;
  if (motion.states.empty()) return verdict;
  for (const OracleInfo& oracle : oracles()) {
    if (oracle.judge == nullptr) continue;
    if (auto breach = oracle.judge(motion)) verdict.breaches.push_back(std::move(*breach));
  }
  if (auto breach = image_breach(*adapter, settings, motion)) verdict.breaches.push_back(*breach);
  const Motion again = run_motion(*adapter, settings, *scene, trial.steps);
  if (auto breach = repetition_breach(motion, again)) {
    verdict.breaches.push_back(*breach);
  } else {
    read_flags(motion, verdict);
  }
  return verdict;
}

}  // namespace brickbench::hunt
