// Shrinking, with judges whose fault is known.
#include "experiments/hunt/shrink.hpp"

#include <gtest/gtest.h>

#include "experiments/hunt/cause.hpp"

namespace brickbench::hunt {
namespace {

Catalogues shrink_catalogues() {
  Catalogues catalogues;
  catalogues.scenarios = scenarios();
  return catalogues;
}

double parameter_or(const Trial& trial, const std::string& name, double otherwise) {
  const auto found = trial.parameters.find(name);
  return found == trial.parameters.end() ? otherwise : std::get<double>(found->second);
}

Verdict broken(std::size_t step) {
  Verdict verdict;
  verdict.breaches = {{"energy", 2.0, 1.0, "J", step, 0.0, ""}};
  return verdict;
}

Trial crowded() {
  Trial trial;
  trial.scene = "tower";
  trial.engine = {"any", "plain"};
  trial.step_s = 0.00123;
  trial.steps = 900;
  trial.knobs = {{"iterations", 7.0}, {"erp", 0.3}};
  trial.parameters = {{"count", 17.0},           {"restitution", 0.6789},
                      {"friction", 0.123},       {"brick_length_m", 0.4321},
                      {"density_kgpm3", 1234.0}, {"gap_m", 0.01234}};
  return trial;
}

TEST(Shrink, LeavesWhatIsNeededAndNothingElse) {
  // Three bricks or more with restitution above a half, whatever else.
  const Judge judge = [](const Trial& trial) {
    const bool bad = parameter_or(trial, "count", 10.0) >= 3.0 &&
                     parameter_or(trial, "restitution", 0.0) > 0.5 && trial.steps >= 40;
    return bad ? broken(100) : Verdict{};
  };
  const Shrunk shrunk = shrink(crowded(), broken(100), "energy", shrink_catalogues(), judge, 1000);
  EXPECT_TRUE(shrunk.trial.knobs.empty());
  EXPECT_EQ(shrunk.trial.parameters, (ParameterValues{{"count", 3.0}, {"restitution", 1.0}}));
  // Larger ones would leave fewer than the forty steps that it takes.
  EXPECT_EQ(shrunk.trial.step_s, 0.001);
  EXPECT_LT(shrunk.trial.steps, 80u);
  EXPECT_EQ(needed(shrunk.trial), "count, restitution");
  EXPECT_LT(shrunk.probes, 100u);
}

TEST(Shrink, KeepsTheKnobThatIsNeededAndCoarseNumbers) {
  const Judge judge = [](const Trial& trial) {
    const bool bad = trial.knobs.contains("erp") &&
                     std::abs(parameter_or(trial, "density_kgpm3", 2000.0) - 1234.0) < 40.0;
    return bad ? broken(5) : Verdict{};
  };
  const Shrunk shrunk = shrink(crowded(), broken(5), "energy", shrink_catalogues(), judge, 1000);
  EXPECT_EQ(shrunk.trial.knobs, (KnobValues{{"erp", 0.3}}));
  // One brick instead of the ten of the default: no brick more than needed.
  EXPECT_EQ(shrunk.trial.parameters, (ParameterValues{{"count", 1.0}, {"density_kgpm3", 1200.0}}));
  EXPECT_LT(shrunk.probes, 100u);
}

TEST(Shrink, StopsAtItsProbesAndAtATrialThatTellsItself) {
  std::size_t asked = 0;
  const Judge judge = [&](const Trial&) {
    ++asked;
    Verdict verdict = broken(5);
    verdict.outcome = "diverged";
    return verdict;
  };
  const Shrunk shrunk = shrink(crowded(), broken(5), "energy", shrink_catalogues(), judge, 10);
  EXPECT_EQ(asked, 10u);
  EXPECT_EQ(shrunk.trial, crowded());
}

TEST(Cause, CountsEdgesAndAxesAsOne) {
  Trial a = crowded();
  Trial b = crowded();
  a.parameters = {{"brick_length_m", 1.0}, {"spin_x_radps", 2.0}};
  b.parameters = {{"brick_height_m", 3.0}, {"spin_z_radps", 4.0}, {"spin_y_radps", 4.0}};
  a.knobs.clear();
  b.knobs.clear();
  EXPECT_EQ(cause_key("energy", a), cause_key("energy", b));
  EXPECT_NE(cause_key("energy", a), cause_key("overlap", a));
  a.parameters.clear();
  EXPECT_EQ(needed(a), "nothing");
}

}  // namespace
}  // namespace brickbench::hunt
