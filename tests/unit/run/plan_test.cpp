// Plans: what is accepted, in which order it becomes cells, and where complaints point.
#include "experiments/run/plan.hpp"

#include <gtest/gtest.h>

#include <set>

#include "experiments/record/schema.hpp"
#include "experiments/run/cell.hpp"
#include "tests/unit/run/fakes.hpp"

namespace brickbench::testing {
namespace {

// Four lines before the keys of the experiment: its first key stands in line 4.
std::string plan_text(const std::string& keys) {
  return "title = \"t\"\n\n[[experiment]]\n" + keys;
}

constexpr const char* k_good =
    "scenario = \"fall\"\nengines = [\"good\"]\nstep_s = 0.01\nduration_s = 0.1\n";

Checked<std::vector<Cell>> cells_of(const std::string& text, const Overrides& overrides = {}) {
  const Catalogues catalogues = fake_catalogues();
  auto plan = parse_plan(text, "p.toml", catalogues, overrides);
  if (!plan) return tl::unexpected(plan.error());
  return expand(*plan, catalogues);
}

Checked<Plan> read(const std::string& text, const Overrides& overrides = {}) {
  return parse_plan(text, "p.toml", fake_catalogues(), overrides);
}

struct BadInput {
  const char* name;
  std::string text;
  const char* place;  // file:line:column:
  const char* words;  // must occur in the reason
};

void PrintTo(const BadInput& bad, std::ostream* out) { *out << bad.name; }

class BadPlan : public ::testing::TestWithParam<BadInput> {};

TEST_P(BadPlan, PointsAtTheMistakeAndSaysWhatIsAllowed) {
  const auto cells = cells_of(GetParam().text);
  ASSERT_FALSE(cells.has_value());
  const std::string text = cells.error().text();
  EXPECT_TRUE(text.starts_with(std::string(GetParam().place) + " ")) << text;
  EXPECT_NE(text.find(GetParam().words), std::string::npos) << text;
}

std::string with(const std::string& line) { return plan_text(k_good + line); }

INSTANTIATE_TEST_SUITE_P(
    Table, BadPlan,
    ::testing::Values(
        BadInput{"syntax", "title = \n", "p.toml:1:9:", ""},
        BadInput{"no_title", "[[experiment]]\n", "p.toml:", "needs the key 'title'"},
        BadInput{"no_experiment", "title = \"t\"\n", "p.toml:", "at least one [[experiment]]"},
        BadInput{"unknown_top_key", "titel = \"t\"\n", "p.toml:1:1:", "did you mean 'title'?"},
        BadInput{"unknown_key", with("stepp_s = 1"), "p.toml:8:1:", "did you mean 'step_s'?"},
        BadInput{"duplicate_key", with("step_s = 1"), "p.toml:8:10:", "step_s"},
        BadInput{"range_without_count", with("parameters = { mass_kg = { from = 1, to = 2 } }"),
                 "p.toml:8:26:", "needs 'count'"},
        BadInput{"range_of_one", with("parameters = { mass_kg = { from = 1, to = 2, count = 1 } }"),
                 "p.toml:8:54:", "must be from 2"},
        BadInput{
            "range_beyond_log",
            with("parameters = { push_ns = { from = 0, to = 2, count = 3, scale = \"log\" } }"),
            "p.toml:8:26:", "must be positive"},
        BadInput{"range_of_parts", with("parameters = { balls = { from = 1, to = 2, count = 3 } }"),
                 "p.toml:8:24:", "a whole number"},
        BadInput{"range_key", with("parameters = { mass_kg = { from = 1, to = 2, cuont = 3 } }"),
                 "p.toml:8:46:", "did you mean 'count'?"},
        BadInput{"zip_of_unequal",
                 with("parameters = { balls = [1, 2], mass_kg = [1.0] }\n"
                      "zip = [[\"balls\", \"mass_kg\"]]"),
                 "p.toml:9:18:", "balls has 2 values, mass_kg has 1"},
        BadInput{"zip_unknown",
                 with("parameters = { balls = [1, 2] }\nzip = [[\"balls\", \"bals\"]]"),
                 "p.toml:9:18:", "did you mean 'balls'?"},
        BadInput{"no_scenario", plan_text("engines = [\"good\"]\nstep_s = 1\n"),
                 "p.toml:3:1:", "'scenario'"},
        BadInput{"unknown_scenario", plan_text("scenario = \"fal\"\n"),
                 "p.toml:4:12:", "did you mean 'fall'?"},
        BadInput{"unknown_engine", plan_text("scenario = \"fall\"\nengines = [\"goud\"]\n"),
                 "p.toml:5:12:", "did you mean 'good'?"},
        BadInput{"engine_not_linked", plan_text("scenario = \"fall\"\nengines = [\"absent\"]\n"),
                 "p.toml:5:12:", "'absent' is not linked in this build; linked: good"},
        BadInput{"unknown_variant", plan_text("scenario = \"fall\"\nengines = [\"good/fance\"]\n"),
                 "p.toml:5:12:", "did you mean 'fancy'?"},
        BadInput{"no_match", plan_text("scenario = \"fall\"\nengines = [\"*/other\"]\n"),
                 "p.toml:5:11:", "matches nothing"},
        BadInput{"unknown_knob",
                 plan_text("scenario = \"fall\"\nengines = [{ engine = \"good\", knobs = { "
                           "iteration = 3 } }]\n"),
                 "p.toml:5:41:", "did you mean 'iterations'?"},
        BadInput{"knob_out_of_range",
                 plan_text("scenario = \"fall\"\nengines = [{ engine = \"good\", knobs = { "
                           "iterations = [3, 1001] } }]\n"),
                 "p.toml:5:58:",
                 "good: knob iterations = 1001: allowed are whole numbers from 1 to 1000"},
        BadInput{"knob_not_whole",
                 plan_text("scenario = \"fall\"\nengines = [{ engine = \"*/*\", knobs = { "
                           "iterations = 2.5 } }]\n"),
                 "p.toml:5:53:", "knob iterations = 2.5: allowed are whole numbers"},
        BadInput{"unknown_parameter", with("parameters = { mas_kg = 1 }"),
                 "p.toml:8:16:", "did you mean 'mass_kg'?"},
        BadInput{"negative_mass", with("parameters = { mass_kg = -1 }"), "p.toml:8:26:", "0.001"},
        BadInput{"nan", with("parameters = { mass_kg = nan }"), "p.toml:8:26:", "finite"},
        BadInput{"wrong_type", with("parameters = { mass_kg = true }"),
                 "p.toml:8:26:", "must be a number, not true or false"},
        BadInput{"not_whole", with("parameters = { balls = 1.5 }"),
                 "p.toml:8:24:", "must be a whole number"},
        BadInput{"bad_word", with("parameters = { kind = \"boxx\" }"),
                 "p.toml:8:23:", "did you mean 'box'?"},
        BadInput{"value_twice", with("parameters = { balls = [1, 2, 1] }"),
                 "p.toml:8:31:", "same value twice"},
        BadInput{"empty_list", with("parameters = { balls = [] }"), "p.toml:8:24:", "empty list"},
        BadInput{"no_scene", with("parameters = { sticky = true }"),
                 "p.toml:8:14:", "sticky balls make no scene"},
        BadInput{"zero_step", plan_text("scenario = \"fall\"\nengines = [\"good\"]\nstep_s = 0\n"),
                 "p.toml:6:10:", "must be positive"},
        BadInput{"bad_fraction",
                 plan_text("scenario = \"fall\"\nengines = [\"good\"]\nstep_s = \"1/0\"\n"),
                 "p.toml:6:10:", "1/240"},
        BadInput{"not_whole_steps",
                 plan_text("scenario = \"fall\"\nengines = [\"good\"]\nstep_s = 0.03\n"),
                 "p.toml:6:10:", "whole number of steps"},
        BadInput{"negative_limit", with("time_limit_s = -1"), "p.toml:8:16:", "must be positive"},
        BadInput{"seeds_alone", with("seeds = 4"), "p.toml:8:9:", "repeat the same run"},
        BadInput{"seed_zero", with("perturb = { position_m = 1 }\nseeds = 0"),
                 "p.toml:9:9:", "at least 1"},
        BadInput{"perturb_alone", with("perturb = { position_m = 1 }"),
                 "p.toml:8:11:", "needs seeds"},
        BadInput{"bad_distribution",
                 with("seeds = 2\nperturb = { position_m = 1, distribution = \"norml\" }"),
                 "p.toml:9:44:", "did you mean 'normal'?"},
        BadInput{"except_without_why", with("except = [{ engine = \"good\" }]"),
                 "p.toml:8:11:", "needs 'why'"},
        BadInput{"bad_condition", with("except = [{ when = \"balls>3\", why = \"x\" }]"),
                 "p.toml:8:20:", "name op value"},
        BadInput{"unknown_quantity", with("except = [{ when = \"ball > 3\", why = \"x\" }]"),
                 "p.toml:8:20:", "did you mean 'balls'?"},
        BadInput{"bad_outcome",
                 with("expect = [{ engine = \"nan\", outcome = \"diverge\", why = \"x\" }]"),
                 "p.toml:8:39:", "did you mean 'diverged'?"},
        BadInput{"unknown_metric", with("metrics = [\"fal\"]"),
                 "p.toml:8:12:", "did you mean 'fall'?"},
        BadInput{"step_of_nothing",
                 plan_text("scenario = \"fall\"\nengines = [\"good\"]\nstep_s = 1e-300\n"),
                 "p.toml:6:10:", "at most 1e+09"},
        BadInput{"infinite_quotient",
                 plan_text("scenario = \"fall\"\nengines = [\"good\"]\nstep_s = 1e-300\n"
                           "duration_s = 1e300\n"),
                 "p.toml:6:10:", "inf steps"},
        BadInput{"same_name_twice", plan_text(std::string(k_good) + "\n[[experiment]]\n" + k_good),
                 "p.toml:9:1:", "are called 'fall'"}),
    [](const auto& info) { return std::string(info.param.name); });

// Names become files and words of commands: none leaves its folder or is an option.
TEST(Plan, NamesOfExperimentsStayInTheirFolder) {
  const auto named = [](const std::string& name) {
    return read(plan_text("name = '" + name + "'\n" + k_good));
  };
  for (const std::string& bad : std::vector<std::string>{
           "../../../escaped", "/etc/passwd", "a/b", "a\\b", ".", "..", ".hidden", "-o", " a",
           "a\tb", "a=b", "a;b", "a|b", "$(a)", "knob", "a.knob"}) {
    const auto plan = named(bad);
    ASSERT_FALSE(plan.has_value()) << bad;
    EXPECT_TRUE(plan.error().text().starts_with("p.toml:4:8: ")) << plan.error().text();
  }
  EXPECT_FALSE(named(std::string(101, 'a')).has_value());
  for (const std::string& good : std::vector<std::string>{"a", "hit_10", "wall 5x5", "M\u00fcller",
                                                          "v1.2", "a-b+c", std::string(100, 'a')}) {
    EXPECT_TRUE(named(good).has_value()) << good;
  }
}

// A knob set from outside acts or is refused, however the plan writes its engines.
TEST(Plan, SetTurnsAKnobHoweverEnginesAreWritten) {
  for (const std::string& engines : std::vector<std::string>{
           "\"good\"", "[\"good\"]", "{ engine = \"good\" }", "[{ engine = \"good\" }]",
           "{ engine = \"good\", knobs = { iterations = [1, 2] } }",
           "[{ engine = \"good\", knobs = { iterations = 1 } }, \"good/fancy\"]"}) {
    const std::string text =
        plan_text("scenario = \"fall\"\nengines = " + engines + "\nstep_s = 0.1\n");
    for (const std::string key : {"knob.iterations", "fall.knob.iterations"}) {
      const auto plan = read(text, {.set = {key + "=7"}, .engines = {}, .only = {}});
      ASSERT_TRUE(plan.has_value()) << engines << plan.error().text();
      for (const EngineChoice& choice : plan->experiments[0].engines) {
        ASSERT_EQ(choice.knobs.size(), 1U) << engines;
        EXPECT_EQ(choice.knobs[0].values, std::vector<ParameterValue>{7.0}) << engines;
      }
      const auto wrong = read(text, {.set = {"knob.iteration=7"}, .engines = {}, .only = {}});
      ASSERT_FALSE(wrong.has_value()) << engines;
      EXPECT_NE(wrong.error().text().find("did you mean 'iterations'?"), std::string::npos);
    }
  }
}

TEST(Plan, MissingFileIsNamed) {
  const auto plan = read_plan("no/such.toml", fake_catalogues());
  ASSERT_FALSE(plan.has_value());
  EXPECT_EQ(plan.error().text(),
            "no/such.toml: cannot read 'no/such.toml': No such file or directory");
}

TEST(Plan, CellsComeInTheStatedOrder) {
  const auto cells = cells_of(plan_text(
      "scenario = \"fall\"\nengines = [\"good\", \"nan/fancy\"]\nstep_s = [0.1, \"1/20\"]\n"
      "duration_s = 0.1\nparameters = { mass_kg = [1, 2], balls = [3, 4] }\n"));
  ASSERT_TRUE(cells.has_value()) << cells.error().text();
  ASSERT_EQ(cells->size(), 16U);
  std::string order;
  for (const Cell& cell : *cells) {
    order += cell.axes + ' ' + shortest(cell.step_s) + ' ' + cell.engine.label() + '\n';
  }
  EXPECT_TRUE(
      order.starts_with("balls=3;mass_kg=1 0.1 good/plain\n"
                        "balls=3;mass_kg=1 0.1 nan/fancy\n"
                        "balls=3;mass_kg=1 0.05 good/plain\n"
                        "balls=3;mass_kg=1 0.05 nan/fancy\n"
                        "balls=4;mass_kg=1 0.1 good/plain\n"))
      << order;
}

TEST(Plan, RangesHaveBothEndsAndTheStatedSpacing) {
  const auto masses = [](const std::string& range) {
    std::vector<double> values;
    const auto cells = cells_of(with("parameters = { mass_kg = " + range + " }"));
    EXPECT_TRUE(cells.has_value()) << cells.error().text();
    for (const Cell& cell : *cells) values.push_back(number(cell.parameters, "mass_kg"));
    return values;
  };
  EXPECT_EQ(masses("{ from = 1, to = 0.5, count = 6 }"),
            (std::vector<double>{1.0, 0.9, 0.8, 0.7, 0.6, 0.5}));
  EXPECT_EQ(masses("{ from = 0.001, to = 1000, count = 7, scale = \"log\" }"),
            (std::vector<double>{0.001, 0.01, 0.1, 1.0, 10.0, 100.0, 1000.0}));
  const auto balls = cells_of(with("parameters = { balls = { from = 1, to = 9, count = 3 } }"));
  ASSERT_TRUE(balls.has_value()) << balls.error().text();
  EXPECT_EQ(balls->at(1).axes, "balls=5");
  const auto steps =
      cells_of(plan_text("scenario = \"fall\"\nengines = [\"good\"]\nduration_s = 0.1\n"
                         "step_s = { from = 0.001, to = 0.1, count = 3, scale = \"log\" }\n"));
  ASSERT_TRUE(steps.has_value()) << steps.error().text();
  EXPECT_EQ(steps->at(1).step_s, 0.01);
}

TEST(Plan, ZippedAxesAdvanceTogether) {
  const auto cells = cells_of(
      with("parameters = { balls = [1, 2, 3], push_ns = [0.0, 1.0], mass_kg = [1.0, 2.0, 3.0] }\n"
           "zip = [[\"balls\", \"mass_kg\"]]"));
  ASSERT_TRUE(cells.has_value()) << cells.error().text();
  std::vector<std::string> axes;
  for (const Cell& cell : *cells) axes.push_back(cell.axes);
  EXPECT_EQ(axes, (std::vector<std::string>{
                      "balls=1;mass_kg=1;push_ns=0", "balls=1;mass_kg=1;push_ns=1",
                      "balls=2;mass_kg=2;push_ns=0", "balls=2;mass_kg=2;push_ns=1",
                      "balls=3;mass_kg=3;push_ns=0", "balls=3;mass_kg=3;push_ns=1"}));
}

TEST(Plan, SelectorsMeanWhatTheySay) {
  const Catalogues catalogues = fake_catalogues();
  const auto count = [&](const char* text) {
    return select(*parse_selector(text, {}, catalogues, true), catalogues).size();
  };
  EXPECT_EQ(count("all"), 6U);
  EXPECT_EQ(count("good"), 1U);
  EXPECT_EQ(count("good/*"), 2U);
  EXPECT_EQ(count("*/fancy"), 6U);
  EXPECT_EQ(count("*/*"), 12U);
  for (const char* text : {"nobody", "good/nothing", "good/", "/", ""}) {
    EXPECT_FALSE(parse_selector(text, {}, catalogues, true).has_value()) << text;
  }
}

TEST(Plan, AnEngineIsTakenOnceHoweverOftenItIsNamed) {
  const auto cells = cells_of(plan_text(
      "scenario = \"fall\"\nengines = [\"all\", \"good\", \"good/plain\"]\nstep_s = 0.1\n"));
  ASSERT_TRUE(cells.has_value()) << cells.error().text();
  EXPECT_EQ(cells->size(), 6U);
}

TEST(Plan, ExcludedCellsStayWithTheirReason) {
  const auto cells = cells_of(
      with("parameters = { balls = [1, 5] }\nexcept = [{ engine = \"good\", when = \"balls > 3 and "
           "step_s "
           "<= 0.01\", why = \"too many\" }, { engine = \"absent\", why = \"not here\" }]"));
  ASSERT_TRUE(cells.has_value()) << cells.error().text();
  ASSERT_EQ(cells->size(), 2U);
  EXPECT_EQ(cells->at(0).excluded_why, "");
  EXPECT_EQ(cells->at(1).excluded_why, "too many");
}

TEST(Plan, CellsOfOneIdDoNotExistTwice) {
  const auto cells =
      cells_of(plan_text("scenario = \"fall\"\nengines = [\"*/*\", { engine = \"good\", knobs = { "
                         "iterations = [1, 2] } }]\n"
                         "step_s = [0.01, 0.02]\nseeds = 3\nperturb = { position_m = 1e-5 "
                         "}\nparameters = { balls = [1, 2] }\n"));
  ASSERT_TRUE(cells.has_value()) << cells.error().text();
  std::set<std::string> ids;
  for (const Cell& cell : *cells) ids.insert(cell_id(cell_key(cell, "1.0", "r")));
  EXPECT_EQ(cells->size(), 14U * 2U * 3U * 2U);
  EXPECT_EQ(ids.size(), cells->size());
}

TEST(Plan, KeyHoldsEverythingThatDecides) {
  const auto cells = cells_of(with(""));
  ASSERT_TRUE(cells.has_value());
  EXPECT_EQ(cell_key(cells->front(), "1.0", "abc"),
            "schema=2;revision=abc;experiment=fall;scenario=fall;engine=good;variant=plain;"
            "version=1.0;step_s=0.01;duration_s=0.1;time_limit_s=0;seed=0;balls=1;kind=sphere;"
            "mass_kg=1;push_ns=0;sticky=0;metrics=fall");
}

struct Override {
  const char* set;
  const char* axes;  // of the first cell; or the start of the complaint
  bool good;
};

TEST(Plan, SetOverridesWithTypes) {
  const std::vector<Override> table = {
      {"mass_kg=2.5", "mass_kg=2.5", true},
      {"kind=box", "kind=box", true},
      {"fall.balls=[2,3]", "balls=2", true},
      {"sticky=0", "sticky=0", true},
      {"knob.iterations=7", "knob.iterations=7", true},
      {"fall.knob.iterations=7", "knob.iterations=7", true},
      {"knob.iterations=0", "--set knob.iterations=0:1:17: good: knob iterations = 0: allowed",
       false},
      {"mas_kg=1", "--set mas_kg=1:1:1: no experiment has 'mas_kg'; did you mean 'mass_kg'?",
       false},
      {"mass_kg=heavy", "--set mass_kg=heavy:1:9: fall: mass_kg must be a number", false},
      {"wall.balls=2", "--set wall.balls=2:1:1: no experiment 'wall'; did you mean 'fall'?", false},
      {"balls", "--set balls: --set needs key=value", false},
      {"knob.foo=1", "--set knob.foo=1:1:1: engine good as a knob has no key 'foo'", false}};
  std::string wrong;
  for (const Override& entry : table) {
    const auto cells = cells_of(with(""), {.set = {entry.set}, .engines = {}, .only = ""});
    const std::string got = cells ? cells->front().axes : cells.error().text();
    if (cells.has_value() != entry.good || !got.starts_with(entry.axes)) {
      wrong += std::string(entry.set) + " gave " + got + '\n';
    }
  }
  EXPECT_EQ(wrong, "");
}

TEST(Plan, EngineOptionReplacesThePlans) {
  const auto cells = cells_of(with(""), {.set = {}, .engines = {"nan/fancy"}, .only = "fall"});
  ASSERT_TRUE(cells.has_value()) << cells.error().text();
  ASSERT_EQ(cells->size(), 1U);
  EXPECT_EQ(cells->front().engine.label(), "nan/fancy");
  EXPECT_FALSE(cells_of(with(""), {.set = {}, .engines = {}, .only = "fal"}).has_value());
}

// A printed command brings all settings along and names the one experiment that it is about.
TEST(Plan, ASettingOfAnExperimentThatIsLeftOutIsReadAndDoesNothing) {
  const std::string two = with("") +
                          "\n[[experiment]]\nname = \"other\"\nscenario = \"fall\"\nengines = "
                          "[\"good\"]\nstep_s = 0.01\n";
  const auto axes_with = [&](const std::vector<std::string>& set) {
    const auto cells = cells_of(two, {.set = set, .engines = {"good"}, .only = "fall"});
    return cells ? cells->front().axes : cells.error().text();
  };
  const std::string plain = axes_with({});
  EXPECT_EQ(axes_with({"other.balls=3"}), plain);
  EXPECT_EQ(axes_with({"other.knob.iterations=7"}), plain);
  EXPECT_NE(axes_with({"balls=3"}), plain);
  EXPECT_NE(axes_with({"other.mass_kg=2", "fall.balls=3"}), plain);
  EXPECT_NE(axes_with({"other.ball=3"}).find("no experiment has 'ball'"), std::string::npos);
  EXPECT_NE(axes_with({"othr.balls=3"}).find("no experiment 'othr'"), std::string::npos);
}

}  // namespace
}  // namespace brickbench::testing
