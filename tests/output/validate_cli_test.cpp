// The verb validate from outside: what it saves, draws, refuses, and which failures it calls known.
#include <algorithm>
#include <cmath>
#include <optional>

#include "experiments/exact/validation/open_questions.hpp"
#include "tests/output/program.hpp"

namespace brickbench::testing {
namespace {

// A cell that fails in an engine that is linked, with its open question not told: at the case's own
// values, or wherever it is drawn. Nothing if there is none.
std::optional<std::string> failing_cell(bool at_defaults) {
  const auto questions =
      exact::read_open_questions("reference_data/predictions/open_questions.csv");
  if (!questions) return std::nullopt;
  const auto all = adapters();
  for (const exact::OpenQuestion& question : *questions) {
    const bool everywhere = !question.region.at_defaults && question.region.ranges.empty();
    if (at_defaults ? !question.region.at_defaults : !everywhere) continue;
    if (std::ranges::find(all, question.engine, &Adapter::name) == all.end()) continue;
    return "validate --engine " + question.engine + '/' + question.variant + " --case " +
           question.case_id;
  }
  return std::nullopt;
}

constexpr const char* k_no_questions = "engine,variant,case,where,date,gone_with,question\n";

// What is saved is what was shown, with the settings that the live engine held.
TEST_F(Program, ValidateSavesItsTable) {
  const auto known = adapters();
  if (std::ranges::none_of(known, &Adapter::own)) GTEST_SKIP() << "no engine of ours is linked";
  const std::string engine = std::ranges::find(known, true, &Adapter::own)->name;
  const std::string asked = "validate --engine " + engine +
                            " --case impact.small_on_big --knob tolerance=1e-2 --json --out " +
                            path("fine");
  const Answer fine = ask(asked);
  EXPECT_EQ(fine.code, 0) << fine.out << fine.err;
  const std::string before = *read_file(folder_ / "fine" / "validation.json");
  const auto saved = nlohmann::json::parse(before);
  EXPECT_EQ(nlohmann::json::parse(fine.out)["cells"], saved["cells"]);
  EXPECT_EQ(saved["cells"][0]["case"], "impact.small_on_big");
  EXPECT_NE(saved["cells"][0]["reproduce"].get<std::string>().find("--knob tolerance=1e-2"),
            std::string::npos);
  EXPECT_NE(saved["engines"].dump().find(R"("name":"tolerance","unit":"1","value":"0.01")"),
            std::string::npos);
  const auto provenance = nlohmann::json::parse(*read_file(folder_ / "fine" / "provenance.json"));
  EXPECT_NE(provenance.dump().find("impact.small_on_big"), std::string::npos);

  const Answer again = ask(asked);
  EXPECT_EQ(again.code, 2) << again.err;
  EXPECT_NE(again.err.find("exists already"), std::string::npos) << again.err;
  EXPECT_EQ(*read_file(folder_ / "fine" / "validation.json"), before);
}

TEST_F(Program, ValidateFailsBeyondTheBound) {
  const auto asked = failing_cell(true);
  if (!asked) GTEST_SKIP() << "no engine with an open question is linked";
  const Answer loose = ask(*asked + " --questions " + put("none.csv", k_no_questions) +
                           " --json --out " + path("loose"));
  EXPECT_EQ(loose.code, 1) << loose.err;
  const auto saved = nlohmann::json::parse(*read_file(folder_ / "loose" / "validation.json"));
  EXPECT_EQ(saved["failed"], 1);
  EXPECT_EQ(saved["exit_code"], 1);
  const auto& cell = saved["cells"][0];
  EXPECT_TRUE(cell["failed"]);
  double worst = 0.0;
  for (const auto& score : cell["scores"]) {
    worst = std::max(worst, std::abs(score["unexplained"].get<double>()));
  }
  EXPECT_GT(worst, cell["bound"].get<double>());
}

TEST_F(Program, ValidateDrawsCasesAndRefusesUnknownKnobs) {
  EXPECT_EQ(ask("validate --case 'impact.*' --figures " + path("starts")).code, 0);
  const auto svg = read_file(folder_ / "starts" / "impact.cradle.svg");
  ASSERT_TRUE(svg);
  EXPECT_TRUE(svg->starts_with("<svg "));
  EXPECT_EQ(ask("validate --case 'impact.*' --figures " + path("starts")).code, 2);
  const Answer form = ask("validate --knob tolerance");
  EXPECT_EQ(form.code, 2);
  EXPECT_NE(form.err.find("name=number"), std::string::npos) << form.err;
  const Answer name = ask("validate --knob no_such_knob=1");
  EXPECT_EQ(name.code, 2);
  EXPECT_NE(name.err.find("no_such_knob"), std::string::npos) << name.err;
}

// A cell that fails is known where the list names it, and new where it does not.
TEST_F(Program, ValidateTellsKnownFailuresFromNewOnes) {
  const auto questions =
      exact::read_open_questions("reference_data/predictions/open_questions.csv");
  ASSERT_TRUE(questions) << questions.error().reason;
  const auto all = adapters();
  const auto listed = std::ranges::find_if(*questions, [&](const exact::OpenQuestion& question) {
    return question.region.at_defaults &&
           std::ranges::find(all, question.engine, &Adapter::name) != all.end();
  });
  if (listed == questions->end()) GTEST_SKIP() << "no engine with an open question is linked";
  const std::string cell =
      "validate --engine " + listed->engine + '/' + listed->variant + " --case " + listed->case_id;
  const Answer known = ask(cell);
  EXPECT_EQ(known.code, 0) << known.out << known.err;
  EXPECT_NE(known.out.find(" known "), std::string::npos) << known.out;
  EXPECT_NE(known.out.find(listed->question), std::string::npos) << known.out;
  const std::string none = put("none.csv", "engine,variant,case,where,date,gone_with,question\n");
  const Answer unknown = ask(cell + " --questions " + none);
  EXPECT_EQ(unknown.code, 1) << unknown.out << unknown.err;
  EXPECT_NE(unknown.out.find(" FAILED "), std::string::npos) << unknown.out;
  EXPECT_EQ(ask(cell + " --questions " + put("bad.csv", "engine\n")).code, 2);
}

// Every failure of a scan comes with a command that shows the same cell again, to the bit.
TEST_F(Program, ValidateScansCasesAndItsCommandsReproduce) {
  const auto cell_asked = failing_cell(false);
  if (!cell_asked) GTEST_SKIP() << "no engine with an open question is linked";
  const std::string scan =
      *cell_asked + " --questions " + put("none.csv", k_no_questions) + " --scan 3 --seed 7";
  const Answer answer = ask(scan + " --json");
  ASSERT_EQ(answer.code, 1) << answer.out << answer.err;
  EXPECT_EQ(ask(scan + " --json").out, answer.out);
  EXPECT_EQ(ask(scan).code, 1);
  const auto json = nlohmann::json::parse(answer.out);
  EXPECT_EQ(json["count"], 3);
  EXPECT_EQ(json["cases"][0]["inside"], 3);
  ASSERT_FALSE(json["cells"].empty());
  for (const auto& cell : json["cells"]) {
    const std::string command = cell["reproduce"];
    ASSERT_TRUE(command.starts_with("brickbench validate "));
    const Answer again = ask(command.substr(std::string("brickbench ").size()) + " --questions " +
                             path("none.csv") + " --json");
    EXPECT_EQ(again.code, 1) << command;
    const auto shown = nlohmann::json::parse(again.out)["cells"][0];
    EXPECT_EQ(shown["scores"], cell["scores"]) << command;
    EXPECT_EQ(shown["parameters"], cell["parameters"]) << command;
  }
}

TEST_F(Program, ValidateRefusesWhatDoesNotGoTogether) {
  const std::string corner = "validate --case impact.corner --parameter ";
  for (const std::string& wrong :
       {std::string("validate --scan 2 --order"), std::string("validate --scan 2 --predict"),
        std::string("validate --parameter speed_mps=1"), corner + "speed_mps=1 --scan 2",
        corner + "speed=1", corner + "speed_mps=1e9",
        corner + "speed_mps=20 --parameter step_s=0.1",
        std::string("validate --symmetry all --knob iterations=1"),
        std::string("validate --scan 2 --out ") + path("scan")}) {
    const Answer answer = ask(wrong);
    EXPECT_EQ(answer.code, 2) << wrong << answer.out;
    EXPECT_FALSE(answer.err.empty()) << wrong;
  }
  // A drawing outside the domain of its case is told with its reason.
  const Answer outside = ask(corner + "speed_mps=20 --parameter step_s=0.1");
  EXPECT_NE(outside.err.find("a step of the approach"), std::string::npos) << outside.err;
  EXPECT_FALSE(fs::exists(folder_ / "scan"));
}

}  // namespace
}  // namespace brickbench::testing
