// Scenes of files in plans: found from where the plan lies, an axis like any other, known by what
// is in the file.
#include "experiments/run/scene_choice.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiments/record/file.hpp"
#include "experiments/run/run_plan.hpp"
#include "tests/unit/run/fakes.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_scene = R"(title = "balls"
duration_s = 0.1
[parameters]
count = { default = 2, minimum = 1, maximum = 5, whole = true, meaning = "balls" }
[law]
friction = 0
restitution = 0
[[body]]
name = "ball_{i}"
repeat = { i = "count" }
shape = "sphere"
radius_m = 0.1
mass_kg = 1
position_m = ["i", 0, 0]
)";

class SceneFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("brickbench_scenes_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "plans");
    fs::create_directories(folder_ / "worlds");
    put("worlds/balls.toml", k_scene);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void put(const std::string& name, const std::string& text) {
    ASSERT_TRUE(replace_file(folder_ / name, text).has_value());
  }

  Checked<Plan> plan(const std::string& scenarios_and_keys, const Overrides& overrides = {}) {
    put("plans/p.toml", "title = \"t\"\n" + scenarios_and_keys);
    return read_plan(folder_ / "plans/p.toml", catalogues_, overrides);
  }

  std::vector<Cell> cells(const std::string& text, const Overrides& overrides = {}) {
    const auto read = plan(text, overrides);
    if (!read) {
      ADD_FAILURE() << read.error().text();
      return {};
    }
    const auto expanded = expand(*read, catalogues_);
    if (expanded) return *expanded;
    ADD_FAILURE() << expanded.error().text();
    return {};
  }

  static Overrides setting(const std::string& text) {
    Overrides overrides;
    overrides.set = {text};
    return overrides;
  }

  static std::string experiment(const std::string& scene, const std::string& more = "") {
    return "[[experiment]]\nscenario = \"" + scene + "\"\nengines = [\"good\"]\nstep_s = 0.01\n" +
           more;
  }

  fs::path folder_;
  Catalogues catalogues_ = fake_catalogues();
};

TEST_F(SceneFiles, AreFoundFromThePlanAndRun) {
  const auto all = cells(experiment("../worlds/balls.toml", "parameters = { count = [1, 3] }\n") +
                         experiment("fall"));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].scenario, "balls");
  EXPECT_EQ(all[0].experiment, "balls");
  EXPECT_EQ(all[0].duration_s, 0.1) << "the file's";
  EXPECT_EQ(all[1].axes, "count=3");
  EXPECT_EQ(all[2].file_scene, nullptr);
  const RunResult result = run_cells(all, catalogues_, {"rev", "machine"});
  for (const CellOutcome& cell : result.cells) EXPECT_EQ(cell.outcome, "ok") << cell.reason;
  EXPECT_EQ(result.rows.front().scenario, "balls");
}

TEST_F(SceneFiles, TakeSettingsOfTheCommandLine) {
  const std::string text = experiment("../worlds/balls.toml");
  EXPECT_EQ(number(cells(text, setting("count=4"))[0].parameters, "count"), 4.0);
  const auto bad = plan(text, setting("cuont=4"));
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().text().find("did you mean 'count'"), std::string::npos)
      << bad.error().text();
}

TEST_F(SceneFiles, AreKnownByTheirBytes) {
  const std::string text = experiment("../worlds/balls.toml");
  const auto key = [&] { return cell_key(cells(text)[0], "1.0", "rev"); };
  const std::string first = key();
  EXPECT_EQ(first, key());
  EXPECT_NE(first.find(";scene="), std::string::npos);
  put("worlds/balls.toml", std::string(k_scene) + "# a remark\n");
  EXPECT_NE(first, key());
  EXPECT_EQ(cell_key(cells(experiment("fall"))[0], "1.0", "rev").find(";scene="),
            std::string::npos);
}

TEST_F(SceneFiles, StandInTheProvenance) {
  const auto read = plan(experiment("../worlds/balls.toml") +
                         experiment("../worlds/balls.toml", "name = \"again\"\n"));
  ASSERT_TRUE(read);
  const Provenance provenance = provenance_of(*read, catalogues_);
  ASSERT_EQ(provenance.scenes.size(), 1u) << "once";
  EXPECT_EQ(provenance.scenes[0].name, "balls");
  EXPECT_EQ(provenance.scenes[0].text, k_scene);
  EXPECT_EQ(provenance.scenes[0].hash, read->experiments[0].file_scene->hash);
  const auto back = provenance_from_json(to_json(provenance));
  ASSERT_TRUE(back) << back.error().reason;
  EXPECT_EQ(back->scenes, provenance.scenes);
}

TEST_F(SceneFiles, AreRefusedWithAPlace) {
  put("worlds/fall.toml", k_scene);
  put("worlds/bad.toml", "title = 3\n");
  fs::create_directories(folder_ / "other");
  put("other/balls.toml", std::string(k_scene) + "# another\n");
  struct Case {
    std::string text;
    const char* place;
    const char* words;
  };
  const Case cases[] = {
      {experiment("../worlds/bals.toml"), "plans/p.toml:3:12: ", "did you mean 'balls.toml'"},
      {experiment("../worlds"), "plans/p.toml:3:12: ", "no scenario"},
      {experiment("../worlds/fall.toml"), "plans/p.toml:3:12: ", "compiled scene fall"},
      {experiment("../worlds/bad.toml"), "worlds/bad.toml:1:9: ", "title must be a string"},
      {experiment("../worlds/balls.toml", "parameters = { count = 9 }\n"),
       "plans/p.toml:6:", "1 .. 5"},
      {experiment("../worlds/balls.toml") + experiment("../other/balls.toml", "name = \"b\"\n"),
       "plans/p.toml:7:12: ", "different scenes of one name"}};
  for (const Case& bad : cases) {
    const auto read = plan(bad.text);
    ASSERT_FALSE(read) << bad.text;
    const std::string text = read.error().text();
    EXPECT_NE(text.find(bad.place), std::string::npos) << text;
    EXPECT_NE(text.find(bad.words), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace brickbench::testing
