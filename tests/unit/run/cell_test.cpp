// Cells: whatever an engine does, every number that was asked for gets its row.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "experiments/record/csv.hpp"
#include "experiments/run/perturb.hpp"
#include "experiments/run/run_plan.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/run/fakes.hpp"

namespace brickbench::testing {
namespace {

constexpr const char* k_all_engines = R"(
title = "t"
[[experiment]]
scenario = "fall"
engines = ["all", "good/fancy"]
step_s = 0.01
except = [{ engine = "good/fancy", why = "left out, on purpose" }]
)";

RunResult run_text(const std::string& text) {
  const Catalogues catalogues = fake_catalogues();
  const auto plan = parse_plan(text, "p.toml", catalogues);
  EXPECT_TRUE(plan.has_value()) << plan.error().text();
  const auto cells = expand(*plan, catalogues);
  EXPECT_TRUE(cells.has_value()) << cells.error().text();
  return run_cells(*cells, catalogues, {"rev", "machine"});
}

TEST(Cell, EveryMishapBecomesRowsWithItsReason) {
  const RunResult result = run_text(k_all_engines);
  std::map<std::string, std::string> outcome;
  std::map<std::string, std::size_t> rows;
  for (const Row& row : result.rows) {
    const std::string label = row.engine + '/' + row.variant;
    ++rows[label];
    if (row.metric == "height_m") outcome[label] = row.outcome + ": " + row.reason;
  }
  const std::map<std::string, std::string> expected = {
      {"good/plain", "ok: "},
      {"good/fancy", "excluded: left out, on purpose"},
      {"nan/plain", "diverged: step 7 (0.07 s): the state of body 'ball' is not finite"},
      {"thrower/plain", "crashed: step 3 (0.03 s): the engine threw: solver, \"lost\"\nit"},
      {"failer/plain", "crashed: step 2 (0.02 s): LCP error, s <= 0"},
      {"odd/plain", "crashed: step 3 (0.03 s): the engine threw"},
      {"refuser/plain", "refused: friction 0.5 must be 0"}};
  EXPECT_EQ(outcome, expected);
  for (const auto& [label, count] : rows) EXPECT_EQ(count, 4U) << label;
}

TEST(Cell, RowsCarryThePrecisionOfTheirVariant) {
  std::map<std::string, std::set<std::string>> precisions;
  for (const Row& row : run_text(k_all_engines).rows) precisions[row.variant].insert(row.precision);
  const std::map<std::string, std::set<std::string>> expected = {{"plain", {"f64"}},
                                                                 {"fancy", {"f32"}}};
  EXPECT_EQ(precisions, expected);
  const Catalogues catalogues = fake_catalogues();
  for (const EngineRecord& engine : provenance_of({}, catalogues).engines) {
    EXPECT_EQ(engine.precision, "f64; fancy f32") << engine.name;
  }
}

TEST(Cell, NumbersThatAreNoneSayWhy) {
  const RunResult result = run_text(k_all_engines);
  std::map<std::string, std::string> outcome;
  for (const Row& row : result.rows) {
    if (row.engine != "good" || row.variant != "plain") continue;
    outcome[row.metric] = row.outcome + ": " + row.reason;
    EXPECT_EQ(row.value.has_value(), row.outcome == "ok") << row.metric;
  }
  EXPECT_EQ(outcome["never"], "not_applicable: not applicable: nothing here");
  EXPECT_EQ(outcome["forgotten"],
            "not_reported: metric fall declares this number but did not report it");
}

TEST(Cell, RefusalIsAnAnswerAndDivergenceAFailureUnlessExpected) {
  const RunResult result = run_text(k_all_engines);
  std::set<std::string> failed;
  for (const CellOutcome& cell : result.cells) {
    if (is_failure(cell)) failed.insert(cell.cell.engine.engine);
  }
  EXPECT_EQ(failed, (std::set<std::string>{"nan", "thrower", "failer", "odd"}));
  EXPECT_EQ(exit_code(result), 1);
  const std::string expecting = R"(
title = "t"
[[experiment]]
scenario = "fall"
engines = ["nan"]
step_s = 0.01
expect = [{ engine = "nan", outcome = "diverged", why = "that is what it is for" }]
)";
  EXPECT_EQ(exit_code(run_text(expecting)), 0);
  std::string wrongly = expecting;
  wrongly.replace(wrongly.find("diverged"), 8, "crashed");
  EXPECT_EQ(exit_code(run_text(wrongly)), 1);
}

TEST(Cell, RowsAndCurvesAreTheSameBytesEveryTime) {
  const RunResult one = run_text(k_all_engines);
  const RunResult two = run_text(k_all_engines);
  EXPECT_EQ(to_csv<Row>(one.rows), to_csv<Row>(two.rows));
  EXPECT_EQ(to_csv<SeriesPoint>(one.series), to_csv<SeriesPoint>(two.series));
}

TEST(Cell, ABlowGivesItsImpulseWhateverTheStep) {
  // 7.3 N s on 3.1 kg: a division by the step, one by the mass, a product with the step and a sum
  // round by half an ulp of 2.35 m/s (2.2e-16) each, the sum over a step once more.
  const Tolerance tolerance{"blow_mps", 2e-15, 4.5e-16, "five roundings of 2.35 m/s"};
  Worst worst;
  const RunResult result = run_text(R"(
title = "t"
[[experiment]]
scenario = "fall"
engines = ["good"]
step_s = [0.05, 0.01, 0.001, "1/3000"]
parameters = { push_ns = 7.3, mass_kg = 3.1 }
)");
  for (const Row& row : result.rows) {
    if (row.metric == "speed_mps")
      worst.see(*row.value - 7.3 / 3.1, "step " + shortest(row.step_s));
  }
  EXPECT_TRUE(worst.within(tolerance));
}

TEST(Cell, CurvesAreThinned) {
  const RunResult result = run_text(R"(
title = "t"
[[experiment]]
scenario = "fall"
engines = ["good"]
step_s = [0.01, 0.0001]
)");
  std::map<double, std::size_t> points;
  for (const SeriesPoint& point : result.series) ++points[point.step_s];
  EXPECT_EQ(points[0.01], 11U);
  EXPECT_LE(points[0.0001], k_series_points);
  EXPECT_GE(points[0.0001], k_series_points / 2);
}

TEST(Cell, ATimeLimitEndsIt) {
  const RunResult result = run_text(R"(
title = "t"
[[experiment]]
scenario = "fall"
engines = ["good"]
step_s = 0.001
time_limit_s = 1e-12
)");
  EXPECT_EQ(result.cells.front().outcome, "timed_out");
}

World two_balls() {
  World world;
  world.bodies = {solid_body("a", SphereShape{0.1}, 1.0), ground_plane(),
                  solid_body("b", SphereShape{0.1}, 1.0)};
  return world;
}

TEST(Perturb, DependsOnSeedAndBodyOnly) {
  Perturbation p;
  p.position_m = 1e-3;
  p.angle_rad = 1e-3;
  World one = two_balls();
  World two = two_balls();
  two.bodies.push_back(solid_body("c", SphereShape{0.2}, 5.0));
  perturb(one, p, 5);
  perturb(two, p, 5);
  EXPECT_EQ(one.bodies[0].initial.position_m, two.bodies[0].initial.position_m);
  EXPECT_EQ(one.bodies[2].initial.orientation.coeffs(), two.bodies[2].initial.orientation.coeffs());
  EXPECT_NE(one.bodies[0].initial.position_m, one.bodies[2].initial.position_m);
  EXPECT_EQ(one.bodies[1].initial.position_m, Eigen::Vector3d::Zero()) << "fixed bodies stay";
  EXPECT_TRUE(validate(one).has_value());
  World other = two_balls();
  perturb(other, p, 6);
  EXPECT_NE(one.bodies[0].initial.position_m, other.bodies[0].initial.position_m);
}

TEST(Perturb, HasTheStatedMoments) {
  constexpr std::size_t n = 20000;
  // Standard errors: mean 1/sqrt(n) = 0.0071, variance sqrt(2/n) = 0.01 for the normal one.
  for (const auto& [distribution, variance] :
       std::vector<std::pair<std::string, double>>{{"normal", 1.0}, {"uniform", 1.0 / 3.0}}) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double x = random_component(distribution, 1 + i / 12, i % 7, i % 12);
      sum += x;
      squares += x * x;
    }
    EXPECT_LT(std::abs(sum / n), 0.03) << distribution;
    EXPECT_LT(std::abs(squares / n - variance), 0.04) << distribution;
  }
}

}  // namespace
}  // namespace brickbench::testing
