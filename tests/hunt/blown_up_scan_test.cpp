// No run that is right is called blown up: every engine and variant, scenes of every scenario drawn
// at random, exact cases drawn over their domains. What is right is said by others: the oracles of
// the hunt, where the scheme as stated keeps the energy, and the discrete and the continuous truth
// of a case. That a scheme explains an explosion does not make it right: explicit schemes make
// energy of spin. BRICKBENCH_SCAN=N looks at N scenes and N cases per variant and prints the table
// of docs/metrics.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>

#include "adapters/catalog.hpp"
#include "adapters/seam/shape.hpp"
#include "experiments/exact/validation/scan.hpp"
#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/hunt.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/metrics/energy_bound.hpp"
#include "experiments/metrics/mechanics.hpp"
#include "experiments/step/stepper.hpp"

namespace brickbench::hunt {
namespace {

constexpr std::uint64_t k_scan_seed = 1403;
constexpr std::uint64_t k_few = 12;  // scenes, and cases, of each variant in a plain test
constexpr DrawLimits k_scan_limits = {.bodies = 12, .body_steps = 2500.0, .most_steps = 600};

std::uint64_t wanted_scenes() {
  const char* text = std::getenv("BRICKBENCH_SCAN");
  return text == nullptr ? k_few : std::strtoull(text, nullptr, 10);
}

struct Tally {
  std::size_t runs = 0;
  std::size_t right = 0;
  std::size_t blown_up = 0;
  std::size_t false_alarms = 0;
  double largest_share = 0.0;  // X / S of a run that is right

  void add(bool is_right, bool is_blown_up, double share) {
    ++runs;
    right += is_right ? 1U : 0U;
    blown_up += is_blown_up ? 1U : 0U;
    false_alarms += is_right && is_blown_up ? 1U : 0U;
    if (is_right) largest_share = std::max(largest_share, share);
  }
  std::string text(const std::string& who) const {
    return fmt::format("| {} | {} | {} | {} | {} | {:.2g} |\n", who, runs, right, blown_up,
                       false_alarms, largest_share);
  }
};

// Whether the scheme, as stated, keeps the energy of this motion: what it admits to make in all
// steps is less than there was. Explicit schemes do not where spins are fast or rods thin.
bool keeps_energy(const Motion& motion) {
  const World& world = motion.scene.world;
  double admitted_j = 0.0;
  double given_j = 0.0;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    const gate::StepRecord record = motion.record(n);
    admitted_j += gate::energy_allowance_j(world, record, motion.scheme, k_rounding);
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      given_j += std::abs(
          work_of_step_j(record.wrenches[i], record.before[i], record.after[i], record.step_s));
    }
  }
  const double start_j = kinetic_j(world, motion.states.front()) + edge_energy_j(world);
  return admitted_j <= start_j + given_j + height_energy_j(world, motion.states.front());
}

// The scheme's prediction holds, and is no worse than half of the scale away from nature.
bool is_case_right(const exact::CellResult& cell) {
  constexpr double k_near = 0.5;
  return exact::verdict_of(cell, nullptr) == exact::Verdict::held &&
         std::ranges::none_of(cell.scores,
                              [](const exact::Score& score) { return score.error > k_near; });
}

bool is_blown_up(const Motion& motion, double& share) {
  EnergyBound bound(motion.scene, motion.step_s);
  const std::vector<Wrench> none(motion.scene.world.bodies.size());
  bool blown_up = false;
  for (std::size_t step = 0; step < motion.states.size() && !blown_up; ++step) {
    Sample sample;
    sample.step = step;
    sample.time_s = static_cast<double>(step) * motion.step_s;
    sample.states = motion.states[step];
    sample.wrenches = step == 0 ? none : motion.wrenches[step - 1];
    blown_up = bound.observe(sample).has_value();
  }
  share = bound.largest_share();
  return blown_up;
}

void scan_scenes(const EngineVariant& engine, const Catalogues& catalogues, Tally& tally) {
  Quarry quarry{k_scan_seed, {engine}, names_of(catalogues.scenarios), {}};
  for (std::uint64_t number = 0; number < wanted_scenes(); ++number) {
    const auto trial = trial_number(quarry, catalogues, number, k_scan_limits);
    if (!trial) continue;
    const auto scene = scene_of(*trial, catalogues);
    const Adapter& adapter = *find_adapter(catalogues, engine.engine);
    const Motion motion = run_motion(adapter, settings_of(*trial), *scene, trial->steps);
    if (motion.states.empty()) continue;
    const bool is_right =
        keeps_energy(motion) && !energy_breach(motion) && !kinematics_breach(motion);
    double share = 0.0;
    const bool blown_up = is_blown_up(motion, share);
    tally.add(is_right, blown_up, share);
    EXPECT_FALSE(is_right && blown_up) << label(*trial);
  }
}

Scene scene_around(const World& world) {
  Scene scene;
  scene.world = world;
  scene.length_scale_m = HUGE_VAL;
  for (const Body& body : world.bodies) {
    if (body.fixed || is_half_space(body.shape)) continue;
    scene.length_scale_m =
        std::min(scene.length_scale_m, 2.0 * half_extents_m(body.shape).minCoeff());
  }
  return scene;
}

void scan_case(const EngineVariant& engine, const Adapter& adapter,
               const exact::ExactCase& exact_case, std::uint64_t seed, Tally& tally) {
  for (const ParameterValues& values : exact::drawings_of(exact_case, seed, 1).inside) {
    const auto run = exact::build(exact_case, values);
    if (!run) continue;
    Motion motion;
    motion.scene = scene_around(run->world);
    motion.step_s = run->step_s;
    const Settings settings = exact::settings_of(adapter, engine.variant, *run);
    if (adapter.scheme != nullptr) motion.scheme = adapter.scheme(settings);
    auto stepper = Stepper::start(adapter, run->world, settings, run->load);
    if (!stepper) continue;
    motion.states.emplace_back(stepper->states().begin(), stepper->states().end());
    while (stepper->done() < run->steps && stepper->advance()) {
      motion.wrenches.emplace_back(stepper->wrenches().begin(), stepper->wrenches().end());
      motion.states.emplace_back(stepper->states().begin(), stepper->states().end());
    }
    double share = 0.0;
    const bool blown_up = is_blown_up(motion, share);
    const auto cell = exact::validate_at(adapter, engine.variant, exact_case, values);
    const bool is_right = is_case_right(cell) && keeps_energy(motion);
    tally.add(is_right, blown_up, share);
    EXPECT_FALSE(is_right && blown_up) << exact_case.id << " in " << engine.label();
  }
}

TEST(BlownUpScan, CallsNoRunThatIsRight) {
  Catalogues catalogues;
  catalogues.scenarios = scenarios();
  catalogues.adapters = adapters();
  const auto cases = exact::exact_cases();
  std::cout << "| engine | runs | right | blown up | right and blown up | largest X / S of a right "
               "run |\n|---|---:|---:|---:|---:|---:|\n";
  Tally all;
  for (const Adapter& adapter : catalogues.adapters) {
    for (const Variant& variant : adapter.variants) {
      const EngineVariant engine{adapter.name, variant.name};
      Tally tally;
      scan_scenes(engine, catalogues, tally);
      for (std::uint64_t n = 0; n < wanted_scenes(); ++n) {
        scan_case(engine, adapter, cases[n % cases.size()], k_scan_seed + n / cases.size(), tally);
      }
      std::cout << tally.text('`' + engine.label() + '`') << std::flush;
      all.runs += tally.runs;
      all.right += tally.right;
      all.blown_up += tally.blown_up;
      all.false_alarms += tally.false_alarms;
      all.largest_share = std::max(all.largest_share, tally.largest_share);
    }
  }
  std::cout << all.text("all");
  EXPECT_EQ(all.false_alarms, 0U);
  if (!catalogues.adapters.empty()) {
    EXPECT_GT(all.right, all.runs / 4) << "nothing is looked at";
  }
}

}  // namespace
}  // namespace brickbench::hunt
