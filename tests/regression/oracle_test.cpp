// `brickbench oracle` from outside: its JSON, its tables and its exit codes.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "adapters/catalog.hpp"
#include "experiments/record/file.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::json;

struct Answer {
  int code = -1;
  std::string out;
};

Answer ask(const std::string& arguments) {
  const auto file =
      std::filesystem::temp_directory_path() / ("brickbench_oracle." + std::to_string(::getpid()));
  const std::string command = std::string(BRICKBENCH_PROGRAM) + " oracle " + arguments + " >" +
                              file.string() + " 2>/dev/null";
  const int status = std::system(command.c_str());
  Answer answer{WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(file).value_or("")};
  std::filesystem::remove(file);
  return answer;
}

// An engine that has friction; statics and walls need it. Empty: none is linked.
std::string engine_with_friction() {
  World world;
  world.law.friction = 0.5;
  world.bodies = {ground_plane(), solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 1800.0)};
  world.bodies[1].initial.position_m.z() = 0.05;
  for (const Adapter& adapter : adapters()) {
    if (build(adapter, world, Settings{})) return adapter.name;
  }
  return {};
}

class Oracle : public ::testing::Test {
 protected:
  void SetUp() override {
    engine_ = engine_with_friction();
    if (engine_.empty()) GTEST_SKIP() << "no linked engine has friction";
  }
  std::string engine_;
};

TEST_F(Oracle, LawsAreFourRecordsPerVariant) {
  const Answer answer =
      ask("laws brick_wall --set courses=2 --set columns=2 --duration 0.02 "
          "--json --engine " +
          engine_);
  EXPECT_EQ(answer.code, 0);
  const Json records = Json::parse(answer.out, nullptr, false);
  ASSERT_EQ(records.size(), 4u) << answer.out;
  EXPECT_EQ(records[0]["law"], "contact_impulse");
  EXPECT_EQ(records[0]["steps_looked_at"], 2);
  EXPECT_EQ(records[1]["steps_looked_at"], 20);
  EXPECT_EQ(records[3]["unit"], "N s");
  EXPECT_GE(records[0]["worst"].get<double>(), records[0]["proven"].get<double>());
}

TEST_F(Oracle, StaticsCountEveryAssemblyOnce) {
  const Answer answer = ask("statics --count 8 --duration 0.25 --json --engine " + engine_);
  EXPECT_EQ(answer.code, 0);
  const Json records = Json::parse(answer.out, nullptr, false);
  ASSERT_EQ(records.size(), 1u) << answer.out;
  const Json& r = records[0];
  EXPECT_EQ(r["stands"], 4);
  EXPECT_EQ(r["stands_stood"].get<int>() + r["stands_moved"].get<int>(), 4);
  EXPECT_EQ(r["falls_stood"].get<int>() + r["falls_moved"].get<int>(), 4);
}

TEST_F(Oracle, MarkdownHasOneRowPerEngine) {
  const Answer answer = ask("statics --count 8 --duration 0.05 --markdown --engine " + engine_);
  EXPECT_EQ(answer.code, 0);
  EXPECT_NE(answer.out.find("| " + engine_ + "/"), std::string::npos) << answer.out;
}

TEST_F(Oracle, AnEngineContinuesItself) {
  const Answer answer =
      ask("defect brick_wall --set courses=2 --set columns=2 --duration 0.02 "
          "--json --engine " +
          engine_ + " --against " + engine_);
  EXPECT_EQ(answer.code, 0);
  const Json records = Json::parse(answer.out, nullptr, false);
  ASSERT_EQ(records.size(), 1u) << answer.out;
  EXPECT_EQ(records[0]["outcome"], "ok");
  EXPECT_EQ(records[0]["steps"].size(), 2u);
}

TEST_F(Oracle, BadInputIsExitTwo) {
  EXPECT_EQ(ask("laws no_such_scenario --engine " + engine_).code, 2);
  EXPECT_EQ(ask("laws --set courses --engine " + engine_).code, 2);
  EXPECT_EQ(ask("statics --engine no_such_engine").code, 2);
}

}  // namespace
}  // namespace brickbench
