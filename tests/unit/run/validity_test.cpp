// Validity: a run that is not to be believed says so in every row, and one that explodes ends.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/run/run_plan.hpp"
#include "tests/support/dubious_engine.hpp"

namespace brickbench::testing {
namespace {

RunResult run_dubious(const std::string& engines) {
  const Catalogues catalogues = dubious_catalogues();
  const auto plan = parse_plan("title = \"t\"\n[[experiment]]\nscenario = \"fall\"\nengines = [" +
                                   engines + "]\nstep_s = 0.01\n",
                               "p.toml", catalogues);
  EXPECT_TRUE(plan.has_value()) << plan.error().text();
  const auto cells = expand(*plan, catalogues);
  EXPECT_TRUE(cells.has_value()) << cells.error().text();
  return run_cells(*cells, catalogues, {"rev", "machine"});
}

TEST(RunValidity, StandsInEveryRowAndTimingOfTheRun) {
  const RunResult result = run_dubious("\"all\"");
  std::map<std::string, std::set<std::string>> said;
  for (const Row& row : result.rows) said[row.engine].insert(row.validity);
  using Words = std::set<std::string>;
  const std::map<std::string, Words> expected = {
      {"good", Words{""}},
      {"unsolved", Words{"unsolved in 3 of 10 steps from step 4"}},
      {"clamped", Words{"clamped in 3 of 10 steps from step 4"}},
      {"overlap_left", Words{"overlap_left in 3 of 10 steps from step 4"}},
      {"contacts_dropped", Words{"contacts_dropped in 3 of 10 steps from step 4"}},
      {"exploder", Words{""}}};
  EXPECT_EQ(said, expected);
  for (std::size_t i = 0; i < result.timings.size(); ++i) {
    const std::string& engine = result.timings[i].engine;
    EXPECT_EQ(result.timings[i].validity, *expected.at(engine).begin());
    EXPECT_EQ(result.cells[i].validity, *expected.at(engine).begin());
    EXPECT_EQ(result.cells[i].outcome, engine == "exploder" ? "blown_up" : "ok");
  }
}

TEST(RunValidity, ARunThatExplodesEndsThereAndNamesBodyStepAndTime) {
  const RunResult result = run_dubious("\"exploder\"");
  ASSERT_EQ(result.cells.size(), 1U);
  const CellOutcome& cell = result.cells.front();
  EXPECT_EQ(cell.outcome, "blown_up");
  EXPECT_TRUE(cell.reason.starts_with("after step 4 (0.04 s) there are 2e+06 J more"))
      << cell.reason;
  EXPECT_TRUE(cell.reason.ends_with("body 'ball' gained most")) << cell.reason;
  EXPECT_EQ(result.timings.front().steps, 4U) << "the run goes on";
  EXPECT_TRUE(is_failure(cell));
  for (const Row& row : result.rows) EXPECT_FALSE(row.value.has_value()) << row.metric;
}

TEST(RunValidity, WhatNobodyCanTellIsNotMeasuredZero) {
  const RunResult result = run_dubious("\"good\", \"unsolved\", \"clamped\"");
  std::map<std::string, std::string> steps;
  for (const Row& row : result.rows) {
    if (row.metric != "steps_unsolved") continue;
    steps[row.engine] =
        row.value ? shortest(*row.value) + ' ' + row.note : row.outcome + ": " + row.reason;
  }
  const std::string unsupported =
      "not_applicable: not applicable: unsupported: neither the engine nor an observer tells this";
  EXPECT_EQ(steps,
            (std::map<std::string, std::string>{
                {"good", unsupported}, {"unsolved", "3 from step 4"}, {"clamped", unsupported}}));
}

TEST(RunValidity, WhatTheEngineSaysOfItselfReachesTheRows) {
  std::map<std::string, double> told;
  for (const Row& row : run_dubious("\"unsolved\"").rows) {
    if (row.metric.starts_with("diag_")) told[row.group + ' ' + row.metric] = *row.value;
  }
  EXPECT_EQ(told, (std::map<std::string, double>{{"contacts diag_residual_max", 0.5},
                                                 {"contacts diag_residual_mean", 0.35}}));
}

// Falls freely and shows other settings than it was asked for.
class AuditedSimulation final : public FakeSimulation<Mishap::none>, AuditView {
 public:
  using FakeSimulation::FakeSimulation;
  const AuditView* audit_view() const override { return this; }

 private:
  Audit audit() const override {
    Audit audit;
    audit.settings = {{"step_s", "s", "0.01"}, {"sweeps", "1", "20"}, {"solver", "", "other"}};
    return audit;
  }
  ContactLaw pair_law(std::size_t, std::size_t) const override { return {}; }
};

TEST(RunValidity, MethodAskedAndMethodUsedStandSideBySide) {
  Catalogues catalogues = dubious_catalogues();
  Adapter audited = dubious_adapter<AuditedSimulation>("audited");
  audited.asked = [](const World&, const Settings&) -> std::vector<AuditFact> {
    return {{"step_s", "s", "0.01"}, {"sweeps", "1", "50"}, {"margin_m", "m", "0"}};
  };
  catalogues.adapters.push_back(audited);
  catalogues.known_engines.push_back("audited");
  const auto plan = parse_plan(
      "title = \"t\"\n[[experiment]]\nscenario = \"fall\"\nengines = [\"audited\", "
      "\"good\"]\nstep_s = [0.01, 0.02]\n",
      "p.toml", catalogues);
  ASSERT_TRUE(plan.has_value()) << plan.error().text();
  const RunResult result = run_cells(*expand(*plan, catalogues), catalogues, {"rev", "machine"});
  const MethodRecord expected = {"audited/plain",
                                 {{"sweeps", "1", "50", "20"},
                                  {"margin_m", "m", "0", "unsupported"},
                                  {"solver", "", "not stated", "other"}}};
  EXPECT_EQ(result.methods, std::vector<MethodRecord>{expected}) << "once, without the step";
  Provenance provenance;
  provenance.methods = result.methods;
  const auto back = provenance_from_json(to_json(provenance));
  ASSERT_TRUE(back.has_value()) << back.error().reason;
  EXPECT_EQ(back->methods, result.methods);
}

}  // namespace
}  // namespace brickbench::testing
