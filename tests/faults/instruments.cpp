#include "tests/faults/instruments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "experiments/exact/validation/validate.hpp"
#include "experiments/hunt/hunt.hpp"
#include "experiments/run/run_plan.hpp"
#include "tests/faults/seeded_faults.hpp"

namespace brickbench::testing {
namespace {

// Resultants of contact forces at rest are exact without a discrete map: the correct engine meets
// them to 1e-9, so a per mille is a fault.
constexpr double k_resultant_bound = 1e-3;
const std::set<std::string> k_resultants = {"statics.slope", "friction.pull_apart"};

// Scenes as anyone would run them, each with a contact of another kind.
constexpr const char* k_ordinary_plan = R"(
title = "ordinary runs"
[[experiment]]
name = "plastic_hit"
scenario = "two_bricks"
engines = ["all"]
step_s = 0.001
duration_s = 0.2
parameters = { gap_m = 0.5 }
[[experiment]]
name = "elastic_hit"
scenario = "two_bricks"
engines = ["all"]
step_s = 0.001
duration_s = 0.2
parameters = { restitution = 1.0 }
[[experiment]]
name = "light_drop"
scenario = "brick_drop"
engines = ["all"]
step_s = 0.001
duration_s = 2.5
parameters = { restitution = 0.5, density_kgpm3 = 200.0 }
[[experiment]]
name = "blow"
scenario = "explosion"
engines = ["all"]
step_s = 0.001
duration_s = 0.8
parameters = { count_x = 2, count_y = 2, count_z = 1 }
)";

// The hunt of one fault: so many small trials, of a seed that knows nothing of the fault.
constexpr std::uint64_t k_seed = 2026;
constexpr std::uint64_t k_trials = 40;
constexpr hunt::DrawLimits k_small = {.bodies = 8, .body_steps = 1500.0, .most_steps = 400};

bool fails(const exact::CellResult& cell) {
  if (cell.failed()) return true;
  if (!k_resultants.contains(cell.case_id)) return false;
  return std::ranges::any_of(
      cell.scores, [](const exact::Score& score) { return !(score.error <= k_resultant_bound); });
}

void look_at_cases(std::size_t index, Caught& caught) {
  const auto cases = exact::exact_cases();
  const KnobValues turned = turned_knob();
  for (const std::string& id : judged_cases()) {
    const exact::ExactCase exact_case = exact::select_cases(cases, id).front();
    const auto open = exact::validate(faulty_adapter(index, true), "", exact_case, {}, turned);
    caught.audit = caught.audit || open.outcome == "audit";
    if (fails(exact::validate(faulty_adapter(index, false), "", exact_case))) {
      caught.cases.push_back(id);
    }
  }
}

Catalogues catalogues_with(Adapter adapter) {
  Catalogues catalogues;
  catalogues.scenarios = scenarios();
  catalogues.metrics = metrics();
  catalogues.adapters = {std::move(adapter)};
  return catalogues;
}

std::vector<std::string> scenes_of(const std::string& words) {
  if (words.empty()) return names_of(scenarios());
  std::istringstream stream(words);
  std::vector<std::string> scenes;
  for (std::string word; stream >> word;) scenes.push_back(word);
  return scenes;
}

std::optional<hunt::Trial> trial_of(const std::string& engine, const std::string& scenes,
                                    std::uint64_t number, const Catalogues& catalogues) {
  hunt::Quarry quarry;
  quarry.seed = k_seed;
  quarry.engines = {{engine, catalogues.adapters.front().variants.front().name}};
  quarry.scenes = scenes_of(scenes);
  return hunt::trial_number(quarry, catalogues, number, k_small);
}

std::optional<hunt::Verdict> judge_trial(Adapter adapter, const std::string& scenes,
                                         std::uint64_t number) {
  const std::string name = adapter.name;
  const Catalogues catalogues = catalogues_with(std::move(adapter));
  const auto trial = trial_of(name, scenes, number, catalogues);
  if (!trial) return std::nullopt;
  return hunt::judge(*trial, catalogues);
}

}  // namespace

const std::vector<std::string>& judged_cases() {
  static const std::vector<std::string> cases = {
      "free_flight.projectile", "free_flight.constant_force", "free_flight.explosion",
      "rotation.spin_up",       "rotation.torque_free_3",     "impact.ball_apexes",
      "impact.corner",          "impact.central_spheres",     "impact.off_centre",
      "friction.sliding_stop",  "friction.diagonal_slide",    "friction.incline_slide",
      "rolling.slide_to_roll",  "friction.pull_apart",        "statics.slope"};
  return cases;
}

std::string said_by_runs(std::size_t index) {
  Adapter adapter = faulty_adapter(index, false);
  adapter.variants.resize(1);
  const Catalogues catalogues = catalogues_with(std::move(adapter));
  const auto plan = parse_plan(k_ordinary_plan, "ordinary.toml", catalogues);
  if (!plan) return plan.error().text();
  const auto cells = expand(*plan, catalogues);
  if (!cells) return cells.error().text();
  for (const CellOutcome& cell : run_cells(*cells, catalogues, {}).cells) {
    const std::string& said = cell.outcome == "ok" ? cell.validity : cell.outcome;
    if (said.empty()) continue;
    return fmt::format("{} ({})", said.substr(0, said.find(' ')), cell.cell.experiment);
  }
  return "";
}

const hunt::Verdict* Instruments::innocent(const std::string& scenes, std::uint64_t number) {
  auto [at, is_new] = innocent_.try_emplace({scenes, number});
  if (is_new) at->second = judge_trial(correct_adapter(), scenes, number);
  return at->second ? &*at->second : nullptr;
}

std::string Instruments::hunt_for(std::size_t index) {
  const std::string scenes = seeded_faults()[index].hunted_in;
  for (std::uint64_t number = 0; number < k_trials; ++number) {
    const hunt::Verdict* right = innocent(scenes, number);
    if (right == nullptr) continue;
    const auto verdict = judge_trial(faulty_adapter(index, false), scenes, number);
    if (verdict->is_told()) continue;
    for (const hunt::Breach& breach : verdict->breaches) {
      if (right->find(breach.oracle) == nullptr) {
        return fmt::format("{} (trial {})", breach.oracle, number);
      }
    }
  }
  return "";
}

Caught Instruments::look_at(std::size_t index) {
  Caught caught;
  look_at_cases(index, caught);
  caught.run = said_by_runs(index);
  caught.hunt = hunt_for(index);
  return caught;
}

}  // namespace brickbench::testing
