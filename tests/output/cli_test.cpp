// The program from outside: exit codes, what goes to which stream, files, bytes.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "adapters/catalog.hpp"
#include "experiments/exact/validation/open_questions.hpp"
#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "experiments/run/cell.hpp"
#include "experiments/run/plan_files.hpp"
#include "experiments/run/results.hpp"
#include "reports/src/markdown_report.hpp"
#include "tests/output/program.hpp"
#include "tests/output/results_reader.hpp"

namespace brickbench::testing {
namespace {

constexpr const char* k_plan = R"(
title = "t"
[[experiment]]
scenario = "free_brick"
engines = ["all"]
step_s = 0.01
duration_s = 0.1
)";

bool any_engine() { return !adapters().empty(); }

TEST_F(Program, RunWritesAFolderAndTheSameRowsTwice) {
  if (!any_engine()) GTEST_SKIP() << "no engine is linked";
  const std::string plan = put("plan.toml", k_plan);
  const Answer one = ask("run " + plan + " --out " + path("one"));
  ASSERT_EQ(one.code, 0) << one.err;
  EXPECT_NE(one.out.find("Results: " + path("one")), std::string::npos);
  EXPECT_NE(one.err.find("[1/"), std::string::npos) << "progress goes to standard error";
  EXPECT_EQ(one.out.find('\033'), std::string::npos) << "no colour into a file";
  ASSERT_EQ(ask("run " + plan + " --out " + path("two")).code, 0);
  for (const char* file : {"rows.csv", "series.csv", "plan.toml"}) {
    EXPECT_EQ(*read_file(folder_ / "one" / file), *read_file(folder_ / "two" / file)) << file;
  }
  const auto results = read_results(folder_ / "one");
  ASSERT_TRUE(results.has_value()) << results.error().reason;
  EXPECT_FALSE(results->rows.empty());
  EXPECT_EQ(markdown_report({results->rows, results->timings, &results->provenance}),
            *read_file(folder_ / "one" / "report.md"))
      << "the report follows from the files alone";
}

TEST_F(Program, RunEndsWithOneScreenAndKeepsTheRestForAll) {
  if (!any_engine()) GTEST_SKIP() << "no engine is linked";
  // Many scenes in every variant of every engine, some of which refuse a bounce.
  const std::string plan = put("plan.toml", R"(
title = "t"
[[experiment]]
scenario = "brick_drop"
engines = ["*/*"]
step_s = [0.01, 0.005]
duration_s = 0.1
parameters = { restitution = [0.0, 0.5] }
)");
  const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  const Answer screen = ask("run " + plan + " --out " + path("one"));
  ASSERT_LE(screen.code, 1) << screen.err;
  EXPECT_LE(lines(screen.out), 25) << screen.out;
  for (const char* part : {" cells ran to their end", "CPU ms per s", "Results: ",
                           "Page: brickbench report ", "With the motion: brickbench run "})
    EXPECT_NE(screen.out.find(part), std::string::npos) << part << screen.out;
  const Answer all = ask("run " + plan + " --all --out " + path("two"));
  EXPECT_GT(lines(all.out), 60);
  EXPECT_NE(all.out.find("energy_net_drift_j"), std::string::npos);
}

TEST_F(Program, FoldersWithoutMotionNameTheCommandThatRecordsIt) {
  if (!any_engine()) GTEST_SKIP() << "no engine is linked";
  const std::string plan = put("plan of mine.toml", k_plan);
  ASSERT_EQ(ask("run '" + plan + "' --set duration_s=0.2 --out " + path("still")).code, 0);
  const std::string command = "brickbench run '" + plan + "' --set duration_s=0.2 --record";
  const Answer drawn = ask("render " + path("still") + " --out " + path("pictures"));
  const Answer page = ask("report " + path("still") + " --no-pdf --out " + path("page"));
  if (drawn.err.find("not installed") == std::string::npos &&
      drawn.err.find("page's script") == std::string::npos) {
    EXPECT_EQ(drawn.code, 2);
    EXPECT_NE(drawn.err.find(command), std::string::npos) << drawn.err;
  }
  EXPECT_NE(page.out.find(command), std::string::npos) << page.out;
  const Answer moving =
      ask("run '" + plan + "' --set duration_s=0.2 --record --out " + path("moving"));
  if (moving.err.find("HDF5") != std::string::npos) GTEST_SKIP() << "built without HDF5";
  EXPECT_EQ(moving.code, 0) << moving.err;
  EXPECT_TRUE(fs::exists(folder_ / "moving" / "trajectories"));
  EXPECT_EQ(*read_file(folder_ / "moving" / "rows.csv"), *read_file(folder_ / "still" / "rows.csv"))
      << "recording changes no number";
}

TEST_F(Program, NothingIsWrittenOver) {
  const std::string plan = put("plan.toml", k_plan);
  fs::create_directories(folder_ / "there");
  const std::size_t before = files() + 2;  // out and err
  const Answer answer = ask("run " + plan + " --out " + path("there"));
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("exists already"), std::string::npos) << answer.err;
  EXPECT_EQ(files(), before);
}

TEST_F(Program, BadInputIsExitTwoWithAReasonAndLeavesNothing) {
  const std::string plan = put("plan.toml", k_plan);
  const std::string file = put("file", "");
  const std::vector<std::pair<std::string, std::string>> table = {
      {"", "subcommand"},
      {"fly", "no verb 'fly'"},
      {"runn " + plan, "did you mean 'run'?"},
      {"sweep runn", "did you mean 'run'?"},
      {"oracle law", "did you mean 'laws'?"},
      {"run " + plan + " --set step_s=1e-300 --out " + path("x"), "at most 1e+09"},
      {"oracle laws brick_drop --step 1e-300", "at most 1e+09"},
      {"run", "plan"},
      {"run no_such_plan", "no such plan file"},
      {"run " + plan + " --set step_s=0 --out " + path("x"), "--set step_s=0:1:8: step_s = 0"},
      {"run " + plan + " --set stepp_s=1 --out " + path("x"), "did you mean 'step_s'?"},
      {"run " + plan + " --engine nobody --out " + path("x"), "no engine 'nobody'"},
      {"run " + plan + " --wrong", "--wrong"},
      {"run " + plan + " --out " + file + "/x", "cannot create folder"},
      {"run " + folder_.string(), "is a folder"},
      {"list moons", "moons"},
      {"run " + put("bad.toml", "title = 3\n"), "bad.toml:1:9: title must be a string"},
  };
  const std::size_t before = files() + 2;
  std::string wrong;
  for (const auto& [arguments, words] : table) {
    const Answer answer = ask(arguments);
    if (answer.code != 2 || answer.err.find(words) == std::string::npos || !answer.out.empty()) {
      wrong += arguments + " -> " + std::to_string(answer.code) + ": " + answer.err + answer.out;
    }
  }
  EXPECT_EQ(wrong, "");
  EXPECT_EQ(files(), before);
}

// Whatever a verb would write is asked for before its work, not after.
TEST_F(Program, ExistingOutputsAreRefusedBeforeTheRun) {
  const std::string plan = put("plan.toml", k_plan);
  fs::create_directories(folder_ / "there");
  const std::string file = put("file", "kept");
  const std::string there = path("there");
  const std::vector<std::string> verbs = {
      "run " + plan + " --out " + there,
      "check " + plan + " --reference " + path("none") + " --obtained " + there,
      "check " + plan + " --reference " + path("none") + " --obtained " + path("new") +
          " --junit " + file,
      "check " + plan + " --reference " + path("none") + " --obtained " + file + "/new",
      "validate --case impact.cradle --out " + there,
      "validate --figures " + there,
      "validate --case impact.cradle --out " + file + "/new",
      "report " + path("nothing") + " --out " + there,
      "render " + path("nothing") + " --out " + there,
      "compare " + path("nothing") + ' ' + path("nothing") + " --out " + there,
  };
  const std::size_t before = files() + 2;
  for (const std::string& verb : verbs) {
    const Answer answer = ask(verb);
    EXPECT_EQ(answer.code, 2) << verb;
    EXPECT_TRUE(answer.err.find("exists already") != std::string::npos ||
                answer.err.find("cannot ") != std::string::npos)
        << verb << ": " << answer.err;
    EXPECT_EQ(answer.err.find("[1/"), std::string::npos) << verb << " ran first";
    EXPECT_EQ(files(), before) << verb;
  }
  EXPECT_EQ(*read_file(file), "kept");
}

TEST_F(Program, NothingComparedIsNotSuccess) {
  if (!any_engine()) GTEST_SKIP() << "no engine is linked";
  const std::string plan = put("plan.toml", k_plan);
  ASSERT_EQ(ask("run " + plan + " --out " + path("whole")).code, 0);
  EXPECT_EQ(ask("compare " + path("whole") + ' ' + path("whole")).code, 0);
  ASSERT_EQ(ask("run " + plan + " --set time_limit_s=1e-12 --out " + path("none")).code, 1);
  const Answer answer = ask("compare " + path("none") + ' ' + path("none"));
  EXPECT_EQ(answer.code, 3) << answer.out;
  EXPECT_NE(answer.out.find("Nothing could be compared"), std::string::npos) << answer.out;
}

// Counts, lengths and choices of every compiled scene, a little beyond either end.
TEST_F(Program, ParametersOutOfRangeAreRefusedWithTheirRange) {
  if (!any_engine()) GTEST_SKIP() << "no engine is linked";
  std::string wrong;
  for (const Scenario& scenario : scenarios()) {
    for (const Parameter& parameter : scenario.parameters) {
      if (parameter.kind != ParameterKind::integer) continue;
      for (const double value : {parameter.minimum - 1.0, parameter.maximum + 1.0, -1.5}) {
        const std::string plan =
            put("plan.toml", fmt::format("title = \"t\"\n[[experiment]]\nscenario = \"{}\"\n"
                                         "engines = [\"all\"]\nstep_s = 0.01\n"
                                         "parameters = {{ {} = {} }}\n",
                                         scenario.name, parameter.name, value));
        const auto read = read_plan(plan, {scenarios(), metrics(), adapters(), {}});
        if (read.has_value() && expand(*read, {scenarios(), metrics(), adapters(), {}})) {
          wrong += fmt::format("{}.{} = {}\n", scenario.name, parameter.name, value);
        }
      }
    }
  }
  EXPECT_EQ(wrong, "");
  const Answer answer = ask("oracle laws tower --set count=-1");
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("count"), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find("1 .. 1000"), std::string::npos) << answer.err;
}

TEST_F(Program, APlanFromAPipeRunsAndItsCellsAreRepeatedFromTheCopy) {
  if (!any_engine()) GTEST_SKIP() << "no engine is linked";
  const std::string plan = put("plan.toml", k_plan);
  const std::string program = BRICKBENCH_PROGRAM;
  const auto shell = [&](const std::string& line) {
    return std::system((line + " >" + path("out") + " 2>" + path("err")).c_str());
  };
  EXPECT_EQ(shell("cat " + plan + " | " + program + " run /dev/stdin --out " + path("piped")), 0)
      << *read_file(folder_ / "err");
  EXPECT_EQ(shell("bash -c '" + program + " run <(cat " + plan + ") --out " + path("fed") + "'"), 0)
      << *read_file(folder_ / "err");
  const auto results = read_results(folder_ / "piped");
  ASSERT_TRUE(results.has_value()) << results.error().reason;
  EXPECT_EQ(results->provenance.plan, path("piped/plan.toml"));
  const std::string again = reproduce_command(results->rows.front(), results->provenance);
  ASSERT_TRUE(again.starts_with("brickbench ")) << again;
  EXPECT_EQ(shell(program + again.substr(10) + " --out " + path("again")), 0) << again;
  const auto repeated = read_results(folder_ / "again");
  ASSERT_TRUE(repeated.has_value()) << repeated.error().reason;
  EXPECT_EQ(repeated->rows.front().state_hash, results->rows.front().state_hash);
}

TEST_F(Program, BlessSaysWhereThereIsNothingToBless) {
  for (const char* name : {"CI", "GITHUB_ACTIONS"}) ::unsetenv(name);  // there it is refused anyway
  const Answer answer = ask("bless --reason why --from " + folder_.string());
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("holds no suite"), std::string::npos) << answer.err;
}

TEST_F(Program, AFailedCellIsExitOneWithAllRows) {
  if (!any_engine()) GTEST_SKIP() << "no engine is linked";
  const Answer answer = ask("run " + put("plan.toml", k_plan) +
                            " --set time_limit_s=1e-12 --json --out " + path("x"));
  EXPECT_EQ(answer.code, 1) << answer.err;
  const auto json = nlohmann::json::parse(answer.out);
  EXPECT_EQ(json["exit_code"], 1);
  EXPECT_EQ(json["cells"].size(), adapters().size());
  EXPECT_EQ(json["cells"][0]["outcome"], "timed_out");
  EXPECT_TRUE(json["rows"][0]["value"].is_null());
  EXPECT_TRUE(fs::exists(folder_ / "x" / "rows.csv"));
}

// The page of the program names every verb and every option of it, and nothing else.
TEST_F(Program, PageOfTheProgramNamesEveryVerbAndOption) {
  const auto verbs = nlohmann::json::parse(ask("list verbs --json").out);
  EXPECT_GE(verbs.size(), 12u);
  std::string expected;
  for (const auto& verb : verbs) {
    expected += "### " + verb["id"].get<std::string>() + '\n';
    const Answer help = ask(verb["id"].get<std::string>() + " --help");
    EXPECT_EQ(help.code, 0);
    for (const auto& option : verb["options"]) {
      const std::string id = option["id"];
      EXPECT_NE(help.out.find(id), std::string::npos) << verb["id"] << ' ' << id;
      expected += id + '\n';
    }
  }
  const std::string page = *read_file("docs/cli.md");
  const std::regex entry("(^|\n)(### [^\n]+|\\| `(-?-?[a-zA-Z][a-z-]*)[^|]*\\|)");
  std::string found;
  const std::size_t from = page.find("<!-- BEGIN verbs -->"), to = page.find("<!-- END verbs -->");
  ASSERT_NE(to, std::string::npos);
  const std::string part = page.substr(from, to - from);
  for (std::sregex_iterator it(part.begin(), part.end(), entry), end; it != end; ++it) {
    found += ((*it)[3].matched ? (*it)[3].str() : (*it)[2].str()) + '\n';
  }
  EXPECT_EQ(found, expected) << "scripts/splice-cli.sh makes this part of the page anew";
}

// What the pages say of numbers of the engines is what the engines have.
TEST_F(Program, PageOfChoicesTellsTheSubStepOfOurs) {
  const std::string page = *read_file("docs/bias.md");
  for (const Adapter& adapter : adapters()) {
    const auto knob = std::ranges::find(adapter.knobs, "substep_s", &Knob::name);
    if (!adapter.own || knob == adapter.knobs.end()) continue;
    const std::string told = "1/" + shortest(std::round(1.0 / knob->engine_default)) + " s";
    EXPECT_NE(page.find(told + " (knob `substep_s`)"), std::string::npos) << told;
  }
}

TEST_F(Program, PageOfOursNamesTheShapesOfEveryVariant) {
  const std::string page = *read_file("ourengine/README.md");
  ASSERT_NE(page.find("All variants have boxes, spheres and fixed planes."), std::string::npos);
  World world;
  State above;
  above.position_m.z() = 1.0;
  world.bodies = {fixed_body("plane", PlaneShape{}, State{}),
                  solid_body("ball", SphereShape{0.1}, 1000.0, above)};
  above.position_m.x() = 1.0;
  world.bodies.push_back(solid_body("box", BoxShape{{0.1, 0.1, 0.1}}, 1000.0, above));
  for (const Adapter& adapter : adapters()) {
    if (!adapter.own) continue;
    for (const Variant& variant : adapter.variants) {
      const auto built =
          build(adapter, world, {.step_s = 0.001, .variant = variant.name, .knobs = {}});
      EXPECT_TRUE(built) << variant.name << ": " << built.error().reason;
    }
  }
}

TEST_F(Program, ListsAreArraysOfObjectsWithIds) {
  for (const char* what : {"engines", "scenarios", "metrics", "plans", "verbs", "cases"}) {
    const Answer answer = ask(std::string("list ") + what + " --json");
    ASSERT_EQ(answer.code, 0) << what;
    const auto json = nlohmann::json::parse(answer.out);
    ASSERT_TRUE(json.is_array());
    for (const auto& entry : json) EXPECT_TRUE(entry.contains("id")) << what;
    const Answer text = ask(std::string("list ") + what);
    EXPECT_EQ(text.code, 0);
    for (const auto& entry : json) {
      EXPECT_NE(text.out.find(entry["id"].get<std::string>()), std::string::npos) << what;
    }
  }
  const auto engines = nlohmann::json::parse(ask("list engines --json").out);
  EXPECT_EQ(engines.size(), adapters().size());
}

TEST_F(Program, DoctorKnowsTheMachine) {
  const Answer answer = ask("doctor --json");
  ASSERT_EQ(answer.code, 0);
  const auto json = nlohmann::json::parse(answer.out);
  EXPECT_GE(json["machine"]["cores"].get<int>(), 1);
  EXPECT_EQ(json["engines"].size(), adapters().size());
  EXPECT_EQ(ask("doctor").code, 0);
  EXPECT_EQ(ask("--help").code, 0);
}

TEST_F(Program, AllPlansThatShipAreReadAndExpanded) {
  if (!any_engine()) GTEST_SKIP() << "no engine is linked";
  std::string wrong, left_out;
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator("experiments/plans")) {
    ++count;
    const auto plan = read_plan(entry.path(), linked());
    if (!plan && plan.error().text().find("is not linked in this build") != std::string::npos)
      left_out += plan.error().text() + '\n';
    else if (!plan)
      wrong += plan.error().text() + '\n';
    else if (const auto cells = expand(*plan, linked()); !cells)
      wrong += cells.error().text() + '\n';
  }
  EXPECT_EQ(wrong, "");
  EXPECT_GE(count, 2U);
  if (!left_out.empty()) GTEST_SKIP() << "not read beyond engines left out:\n" << left_out;
}

TEST_F(Program, ExamplesOfTheDocumentationAreValid) {
  if (!any_engine()) GTEST_SKIP() << "no engine is linked";
  const std::string text = *read_file("docs/format.md");
  const std::regex block("```toml\n([^`]*)```");
  std::size_t count = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), block), end; it != end; ++it, ++count) {
    const auto plan = parse_plan((*it)[1], "docs/format.md", linked());
    ASSERT_TRUE(plan.has_value()) << plan.error().text();
    const auto cells = expand(*plan, linked());
    ASSERT_TRUE(cells.has_value()) << cells.error().text();
  }
  EXPECT_EQ(count, 3U);
}

}  // namespace
}  // namespace brickbench::testing
