// The rules hold for this tree, and each rule sees the violation that it is there for.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/architecture/rules.hpp"

namespace brickbench::architecture {
namespace {

using Check = std::vector<Finding> (*)(const Tree&);

std::string text(const std::vector<Finding>& findings) {
  std::string lines;
  for (const Finding& finding : findings) {
    lines += "  " + finding.rule + ": " + finding.path + " " + finding.reason + "\n";
  }
  return lines;
}

const Tree& project() {
  static const Tree tree = read_tree(".");
  return tree;
}

void expect_clean(Check check) {
  const auto findings = check(project());
  EXPECT_TRUE(findings.empty()) << text(findings);
}

TEST(Project, IncludesFollowTheArrows) { expect_clean(check_includes); }
TEST(Project, RoomsLieOnFloors) { expect_clean(check_floors); }
TEST(Project, NobodyComparesWithAnEngine) { expect_clean(check_engine_names); }
TEST(Project, NoPathNamesAnEngineAndAScenario) { expect_clean(check_mixed_paths); }
TEST(Project, FilesAreShort) { expect_clean(check_lengths); }
TEST(Project, ATypeNameStandsForOneType) { expect_clean(check_type_names); }
TEST(Project, EveryBranchOnAShapeIsExhaustive) { expect_clean(check_shapes); }
TEST(Project, EnginesAreSteppedInOnePlace) { expect_clean(check_stepping); }
TEST(Project, DocumentsNameWhatExists) { expect_clean(check_documents); }

TEST(Project, IsSeenAtAll) {
  EXPECT_GT(project().files.size(), 50u);
  EXPECT_GE(engine_names(project()).size(), 4u);
  EXPECT_GE(scenario_names(project()).size(), 9u);
  const auto adapters = long_adapters(project());
  if (!adapters.empty()) std::cout << "over the budget of an adapter:\n" << text(adapters);
}

// A house that keeps every rule.
Tree good_house() {
  Tree tree;
  add_file(tree, "adapters/ode.cmake", "");
  add_file(tree, "adapters/ode.cpp",
           "#include <ode/ode.h>\n#include \"adapters/seam/world.hpp\"\n");
  add_file(tree, "adapters/ourengine.cmake", "");
  add_file(tree, "adapters/ourengine.cpp", "#include \"ourengine/baraff/step.hpp\"\n");
  add_file(tree, "adapters/seam/world.hpp", "using Shape = std::variant<BoxShape, PlaneShape>;\n");
  add_file(tree, "ourengine/baraff/step.hpp",
           "#include \"ourengine/baraff/body.hpp\"\nusing Solid = std::variant<Box, Plane>;\n");
  add_file(tree, "experiments/scenarios/catalog.cpp",
           "#include \"adapters/seam/world.hpp\"\nScenario brick_wall();\nScenario tower();\n");
  add_file(tree, "experiments/record/row.hpp",
           "namespace brickbench {\nstruct Row {\n};\nstruct Table;\n}  // namespace brickbench\n");
  add_file(
      tree, "experiments/record/file.cpp",
      "namespace brickbench {\nnamespace {\nstruct Row {\n};\n}  // namespace\n}  // namespace\n");
  add_file(tree, "cli/list.hpp", "namespace brickbench {\nstruct Table {\n};\n}  // namespace\n");
  add_file(tree, "reports/src/table.cpp",
           "#include \"experiments/record/row.hpp\"\n// not \"ode\" but every engine\n");
  add_file(tree, "cli/main.cpp", "#include \"reports/src/table.hpp\"\nauto s = \"mode\";\n");
  add_file(tree, "tests/unit/run/run_test.cpp", "plan = {\"ode\"};\n");
  add_file(tree, "docs/guide.md",
           "See `adapters/seam/`, `ode/quick` and `cli/main.cpp`; `build/x`.\n");
  return tree;
}

TEST(Rules, AGoodHousePassesAll) {
  for (const Check check :
       {check_includes, check_floors, check_engine_names, check_mixed_paths, check_lengths,
        check_type_names, check_shapes, check_stepping, check_documents, long_adapters}) {
    EXPECT_TRUE(check(good_house()).empty()) << text(check(good_house()));
  }
}

TEST(Rules, EachSeesTheViolationItIsThereFor) {
  struct Seed {
    Check check;
    const char* path;
    std::string content;
  };
  const std::string long_file(451, '\n');
  const std::string long_adapter(351, '\n');
  const Seed seeds[] = {
      {check_includes, "ourengine/baraff/body.cpp", "#include \"adapters/seam/world.hpp\"\n"},
      {check_includes, "adapters/seam/simulation.hpp", "#include \"adapters/catalog.hpp\"\n"},
      {check_includes, "adapters/ode_joint.cpp", "#include \"experiments/run/cell.hpp\"\n"},
      {check_includes, "adapters/remote/link.cpp", "#include \"adapters/catalog.hpp\"\n"},
      {check_includes, "adapters/ode_joint.cpp", "#include \"ourengine/baraff/body.hpp\"\n"},
      {check_includes, "adapters/ode_joint.cpp", "#include <mujoco/mujoco.h>\n"},
      {check_includes, "experiments/metrics/energy.cpp",
       "#include \"ourengine/baraff/body.hpp\"\n"},
      {check_includes, "experiments/run/cell.cpp", "#include \"adapters/catalog.hpp\"\n"},
      {check_includes, "experiments/run/cell.cpp", "#include \"reports/src/table.hpp\"\n"},
      {check_includes, "reports/src/plot.cpp", "#include \"experiments/metrics/metric.hpp\"\n"},
      {check_includes, "cli/verb_run.cpp", "#include <btBulletDynamicsCommon.h>\n"},
      {check_floors, "ourengine/contact/solve.cpp", "#include \"ourengine/fast/step.hpp\"\n"},
      {check_floors, "ourengine/fast/step.cpp", "#include \"ourengine/baraff/step.hpp\"\n"},
      {check_floors, "ourengine/bodies/body.cpp", ""},
      {check_floors, "experiments/metrics/energy.cpp", "#include \"experiments/run/cell.hpp\"\n"},
      {check_floors, "experiments/oracle/laws.cpp",
       "#include \"experiments/regression/check.hpp\"\n"},
      {check_engine_names, "cli/verb_run.cpp", "if (name == \"ode\") {}\n"},
      {check_engine_names, "experiments/run/cell.cpp", "skip(\"ourengine/baraff\");\n"},
      {check_engine_names, "reports/src/plot.cpp", "colour[\"ode\"] = 1;\n"},
      {check_engine_names, "tests/unit/run/cell_test.cpp", "if (engine != \"ode\") {}\n"},
      {check_mixed_paths, "experiments/plans/ode_tower.toml", ""},
      {check_mixed_paths, "tests/brick_wall/ode.cpp", ""},
      {check_lengths, "cli/verb_run.cpp", long_file},
      {check_lengths, "scripts/all.sh", long_file},
      {check_type_names, "reports/src/column.hpp",
       "namespace brickbench {\nclass Table final : public Base {\n}  // namespace brickbench\n"},
      {check_shapes, "reports/src/plot.cpp", "auto* box = std::get_if<BoxShape>(&shape);\n"},
      {check_shapes, "tests/unit/run/run_test.cpp",
       "if (std::holds_alternative<PlaneShape>(shape)) {}\n"},
      {check_shapes, "adapters/ode_scene.cpp", "std::get_if<engine::Box>(&body.solid);\n"},
      {check_stepping, "experiments/run/cell.cpp", "auto ok = simulation->step();\n"},
      {check_stepping, "cli/verb_run.cpp", "if (!one.step()) return;\n"},
      {check_documents, "README.md", "Look into `experiments/nothing/`.\n"},
      {check_documents, "docs/more.md", "Look into `cli/missing.cpp`.\n"},
      {check_documents, "README.md", "Look into `nowhere/`.\n"},
      {long_adapters, "adapters/ode_joint.cpp", long_adapter},
  };
  for (const Seed& seed : seeds) {
    Tree tree = good_house();
    add_file(tree, seed.path, seed.content);
    const auto findings = seed.check(tree);
    ASSERT_EQ(findings.size(), 1u)
        << seed.path << ": " << seed.content.substr(0, 80) << text(findings);
    EXPECT_EQ(findings[0].path, seed.path);
  }
}

}  // namespace
}  // namespace brickbench::architecture
