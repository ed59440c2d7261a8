// A printed command reproduces what it stands beside: of check, of a report, of a hunt. (Of
// validate: validate_cli_test.cpp.)
#include <algorithm>
#include <regex>

#include "reports/src/report_source.hpp"
#include "tests/output/program.hpp"

namespace brickbench::testing {
namespace {

constexpr const char* k_checked_plan = R"(
title = "What is checked"
[[experiment]]
name = "slide"
scenario = "incline"
engines = ["all"]
step_s = 0.002
duration_s = 0.2
parameters = { friction = 0.3, angle_rad = [0.4, 0.5] }
metrics = ["displaced"]
seeds = [1, 2, 3, 4]
perturb = { position_m = 1e-12, distribution = "uniform" }
[[experiment]]
name = "fall"
scenario = "free_brick"
engines = ["all"]
step_s = 0.01
duration_s = 0.1
metrics = ["displaced"]
)";

std::string arguments_of(const std::string& command) {
  const std::string program = "brickbench ";
  EXPECT_TRUE(command.starts_with(program)) << command;
  return command.substr(program.size());
}

class Reproduce : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    for (const char* name : {"CI", "GITHUB_ACTIONS"}) ::unsetenv(name);
    if (adapters().empty()) GTEST_SKIP() << "no engine is linked";
  }

  // References in `ref`, with one digit of each value of the first experiment turned.
  bool bless_wrong_references(const std::string& plan) const {
    const Answer fresh =
        ask("check " + plan + " --reference " + path("ref") + " --obtained " + path("obtained"));
    if (fresh.code != 3) return false;
    const Answer blessed =
        ask("bless --from " + path("obtained") + " --reference " + path("ref") + " --reason test");
    EXPECT_EQ(blessed.code, 0) << blessed.err;
    // Pure numbers have no unit, which rows call "1".
    EXPECT_FALSE(std::regex_search(blessed.out, std::regex(" new 1(\\n| )"))) << blessed.out;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "ref")) {
      if (entry.path().filename() != "slide.json") continue;
      const std::string text = *read_file(entry.path());
      std::ofstream(entry.path()) << std::regex_replace(
          text, std::regex("\"values\":\\[([0-9.e-]+)"), "\"values\":[7$1");
    }
    return true;
  }
};

TEST_F(Reproduce, EachDeviationOfACheckIsShownAgainByItsCommand) {
  const std::string plan = put("gate_two.toml", k_checked_plan);
  ASSERT_TRUE(bless_wrong_references(plan));
  const std::string check =
      "check " + plan + " --reference " + path("ref") + " --set fall.step_s=0.02";
  const Answer answer = ask(check + " --json --obtained " + path("first"));
  ASSERT_EQ(answer.code, 1) << answer.out << answer.err;
  const auto all = nlohmann::json::parse(answer.out)["records"];
  std::size_t tried = 0;
  for (const auto& one : all) {
    if (one["finding"] != "deviation") continue;
    if (tried == 3) break;
    const std::string command = one["reproduce"];
    const Answer again = ask(arguments_of(command) + " --json --obtained " +
                             path("again" + std::to_string(tried++)));
    EXPECT_EQ(again.code, 1) << command << again.err;
    const auto shown = nlohmann::json::parse(again.out)["records"];
    const auto same = std::find_if(shown.begin(), shown.end(),
                                   [&](const auto& other) { return other["id"] == one["id"]; });
    ASSERT_NE(same, shown.end()) << command;
    for (const char* part : {"finding", "got", "reference", "message"}) {
      EXPECT_EQ((*same)[part], one[part]) << command;
    }
  }
  EXPECT_EQ(tried, 3U);
}

TEST_F(Reproduce, EachFailedCellOfAReportIsShownAgainByItsCommand) {
  const std::string plan = put("two.toml", k_checked_plan);
  const Answer run =
      ask("run " + plan + " --set slide.time_limit_s=1e-12 --set 'slide.seeds=[4]' --out " +
          path("run"));
  ASSERT_EQ(run.code, 1) << run.err;
  ASSERT_EQ(ask("report " + path("run") + " --no-pdf --out " + path("page")).code, 0);
  const std::string text = *read_file(folder_ / "page" / "report.md");
  const std::regex repeat("timed_out[^`]*`(brickbench run [^`]*)`");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, repeat)) << text;
  const std::string command = found[1];
  const Answer again = ask(arguments_of(command) + " --json --out " + path("again"));
  ASSERT_TRUE(again.code == 0 || again.code == 1) << command << again.err;
  const auto cells = nlohmann::json::parse(again.out)["cells"];
  ASSERT_EQ(cells.size(), 1U) << command;
  EXPECT_EQ(cells[0]["outcome"], "timed_out") << command;
}

TEST_F(Reproduce, EachFindingOfAHuntIsShownAgainByItsCommand) {
  std::string engines;
  for (const Adapter& adapter : adapters()) {
    if (!adapter.own) engines += " --engine '" + adapter.name + "/*'";
  }
  if (engines.empty()) GTEST_SKIP() << "no engine of others is linked";
  const Answer hunt =
      ask("hunt" + engines + " --scene two_bricks --scene brick_drop --scene impact.corner " +
          "--trials 60 --budget 10min --seed 3 --json --out " + path("hunt"));
  ASSERT_TRUE(hunt.code == 0 || hunt.code == 1) << hunt.err;
  const auto findings = nlohmann::json::parse(hunt.out)["findings"];
  for (const auto& finding : findings) {
    const std::string plan = path("hunt/" + finding["id"].get<std::string>() + ".toml");
    const std::string text = *read_file(plan);
    ASSERT_TRUE(text.starts_with("# brickbench hunt --replay " + plan + '\n')) << text;
    const Answer again = ask("hunt --replay " + plan);
    EXPECT_EQ(again.code, 1) << plan << again.err;
    const auto& breach = finding["breach"];
    const std::regex wanted("\n  " + finding["oracle"].get<std::string>() + ": observed ([^ ,]+)");
    std::smatch seen;
    ASSERT_TRUE(std::regex_search(again.out, seen, wanted)) << plan << again.out;
    EXPECT_NEAR(std::stod(seen[1]) / breach["observed"].get<double>(), 1.0, 1e-5) << plan;
    if (text.find("\n# brickbench run " + plan + '\n') == std::string::npos) continue;
    const Answer run =
        ask("run " + plan + " --out " + path("run-" + finding["id"].get<std::string>()));
    EXPECT_TRUE(run.code == 0 || run.code == 1) << plan << run.err;
  }
  const bool all_known =
      std::ranges::all_of(findings, [](const auto& finding) { return finding["question"] != ""; });
  EXPECT_EQ(all_known, hunt.code == 0);
}

}  // namespace
}  // namespace brickbench::testing
