// Engines of files, as the user of the program meets them.
#include "experiments/run/results.hpp"
#include "reports/src/markdown_report.hpp"
#include "tests/output/program.hpp"
#include "tests/output/results_reader.hpp"

namespace brickbench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;
using testing::Answer;
using testing::Program;
using testing::read_results;

constexpr const char* k_flight_plan = R"(
title = "Flight"
[[experiment]]
scenario = "free_brick"
engines = ["all"]
step_s = 0.002
duration_s = 0.1
)";

class EngineFiles : public Program {
 protected:
  // The starter kit, called mine.
  std::string mine() const {
    return put("mine.toml", std::string("command = [\"") + BRICKBENCH_STARTER + "\"]\n");
  }
  std::string hanging() const {
    return put("hanging.toml", "command = [\"sleep\", \"1000\"]\ndeadline_s = 0.2\n");
  }
};

TEST_F(EngineFiles, AnEngineOfAFileIsInEveryListAndCanBeChosen) {
  const std::string option = " --engine-file " + mine();
  const json listed = json::parse(ask("list engines --json" + option).out);
  ASSERT_EQ(listed.size(), adapters().size() + 1);
  EXPECT_EQ(listed.back()["id"], "mine");
  EXPECT_EQ(listed.back()["version"], "1");
  EXPECT_EQ(listed.back()["knobs"][0]["id"], "clearance_m");
  const json doctor = json::parse(ask("doctor --json" + option).out);
  EXPECT_EQ(doctor["engines"].back()["id"], "mine");

  const std::string plan = put("plan.toml", k_flight_plan);
  const Answer run = ask("run " + plan + " --engine mine --json --out " + path("x") + option);
  ASSERT_EQ(run.code, 0) << run.err;
  const json cells = json::parse(run.out)["cells"];
  ASSERT_EQ(cells.size(), 1U);
  EXPECT_EQ(cells[0]["outcome"], "ok");
  const auto results = read_results(folder_ / "x");
  ASSERT_TRUE(results.has_value()) << results.error().reason;
  const std::string again = reproduce_command(results->rows.front(), results->provenance);
  EXPECT_NE(again.find(option), std::string::npos) << again;
  const Answer unknown = ask("run " + plan + " --engine mine --out " + path("y"));
  EXPECT_EQ(unknown.code, 2) << "without the file there is no such engine";
}

TEST_F(EngineFiles, TheFolderOfTheUserIsAlwaysSearched) {
  fs::create_directories(folder_ / "config/brickbench/engines");
  fs::rename(mine(), folder_ / "config/brickbench/engines/mine.toml");
  const json listed = json::parse(ask("list engines --json").out);
  EXPECT_EQ(listed.back()["id"], "mine");
}

TEST_F(EngineFiles, AProgramThatDoesNotStartIsListedWithTheReason) {
  const std::string absent = put("absent.toml", "command = [\"no_such_program_anywhere\"]\n");
  const std::string options = " --engine-file " + absent + " --engine-file " + hanging();
  const json listed = json::parse(ask("list engines --json" + options).out);
  ASSERT_EQ(listed.size(), adapters().size() + 2);
  const json& first = listed[adapters().size()];
  EXPECT_EQ(first["id"], "absent");
  EXPECT_NE(first["problem"].get<std::string>().find("PATH has no such program"),
            std::string::npos);
  EXPECT_NE(listed.back()["problem"].get<std::string>().find("no answer to 'hello'"),
            std::string::npos);
  const Answer run = ask("run " + put("plan.toml", k_flight_plan) + " --engine absent" + options);
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("engine 'absent' does not run"), std::string::npos) << run.err;
}

TEST_F(EngineFiles, AWrongFileIsBadInput) {
  const std::string wrong = put("wrong.toml", "command = [\"a\"]\ncomand = [\"b\"]\n");
  for (const char* verb : {"list engines", "doctor", "conformance wrong", "check smoke", "validate",
                           "hunt", "oracle laws", "run smoke", "bench smoke", "sweep plan smoke"}) {
    const Answer answer = ask(std::string(verb) + " --engine-file " + wrong);
    EXPECT_EQ(answer.code, 2) << verb;
    EXPECT_NE(answer.err.find("wrong.toml:2:1: an engine file has no key 'comand'"),
              std::string::npos)
        << verb << ": " << answer.err;
  }
}

TEST_F(EngineFiles, ConformanceSaysWhetherAnEngineIsRight) {
  const Answer right = ask("conformance mine --json --engine-file " + mine());
  EXPECT_EQ(right.code, 0) << right.err;
  const json records = json::parse(right.out);
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(records[0]["id"], "mine/default");
  EXPECT_TRUE(records[0]["conforms"].get<bool>());
  EXPECT_TRUE(records[0]["symptoms"].empty());
  EXPECT_GE(records[0]["checks"].size(), 25U);
  EXPECT_EQ(ask("conformance nobody").code, 2);
}

// `serve` is an engine of a file, too: the same bits as the linked one.
TEST_F(EngineFiles, AServedEngineGivesTheBitsOfTheLinkedOne) {
  if (adapters().empty()) GTEST_SKIP() << "no engine is linked";
  const std::string name = adapters().front().name;
  const std::string served = put("served.toml", std::string("command = [\"") + BRICKBENCH_PROGRAM +
                                                    "\", \"serve\", \"" + name + "\"]\n");
  const Answer run = ask("run " + put("plan.toml", k_flight_plan) + " --engine " + name +
                         " --engine served --engine-file " + served + " --json --out " + path("x"));
  ASSERT_EQ(run.code, 0) << run.err;
  const auto results = read_results(folder_ / "x");
  ASSERT_TRUE(results.has_value()) << results.error().reason;
  ASSERT_GE(results->rows.size(), 2U);
  EXPECT_EQ(results->rows.front().state_hash, results->rows.back().state_hash);
  EXPECT_NE(results->rows.front().engine, results->rows.back().engine);
  EXPECT_EQ(json::parse(ask("serve " + name + " --json").out)["protocol"], 1);
  EXPECT_EQ(ask("serve nobody </dev/null").code, 2);
}

}  // namespace
}  // namespace brickbench
