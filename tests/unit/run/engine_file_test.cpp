// Files that add engines: what is read, and what is said of wrong ones.
#include "experiments/run/engine_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "experiments/run/catalogues.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {
namespace {

namespace fs = std::filesystem;

TEST(EngineFile, HoldsHowAProgramIsStarted) {
  const auto file = parse_engine_file(R"(
command = ["node", "engine.mjs", "--fast"]
working_folder = "js"
version_command = ["node", "--version"]
licence = "MIT"
deadline_s = 2.5
memory_mb = 0
[environment]
THREADS = "1"
EMPTY = ""
)",
                                      "/engines/my_engine_2.toml");
  ASSERT_TRUE(file) << file.error().text();
  EXPECT_EQ(file->name, "my_engine_2");
  EXPECT_EQ(file->command, (std::vector<std::string>{"node", "engine.mjs", "--fast"}));
  EXPECT_EQ(file->working_folder, "/engines/js");
  EXPECT_EQ(file->environment, (std::vector<std::string>{"THREADS=1", "EMPTY="}));
  EXPECT_EQ(file->version_command, (std::vector<std::string>{"node", "--version"}));
  EXPECT_EQ(file->licence, "MIT");
  EXPECT_EQ(file->deadline_s, 2.5);
  EXPECT_EQ(file->memory_mb, 0U);
}

TEST(EngineFile, RunsInItsOwnFolderUnlessItSaysOtherwise) {
  const auto beside = parse_engine_file("command = ['a']", "/engines/a.toml");
  EXPECT_EQ(beside->working_folder, "/engines");
  const auto elsewhere =
      parse_engine_file("command = ['a']\nworking_folder = '/opt/a'", "/engines/a.toml");
  EXPECT_EQ(elsewhere->working_folder, "/opt/a");
}

TEST(EngineFile, SaysWhereItIsWrongAndWhatIsAllowed) {
  struct Case {
    const char* text;
    const char* file;
    const char* words;
  };
  const Case cases[] = {
      {"", "a.toml", "a.toml: command is missing"},
      {"command = []", "a.toml", "a.toml:1:11: command is an empty list"},
      {"command = 'node'", "a.toml", "a.toml:1:11: command must be an array, not a string"},
      {"command = ['']", "a.toml", "command must not be empty"},
      {"command = ['a']\ncomand = ['b']", "a.toml",
       "a.toml:2:1: an engine file has no key 'comand'"},
      {"command = ['a']\nlicense = 'MIT'", "a.toml", "did you mean 'licence'?"},
      {"command = ['a']\ndeadline_s = 0", "a.toml", "a.toml:2:14: deadline_s = 0 must be positive"},
      {"command = ['a']\nmemory_mb = 1.5", "a.toml", "whole numbers from 0 (no limit)"},
      {"command = ['a']\nmemory_mb = -1", "a.toml", "whole numbers from 0 (no limit)"},
      {"command = ['a']\n[environment]\n'A=B' = 'c'", "a.toml", "has no '='"},
      {"command = ['a'", "a.toml", "a.toml:1:"},
      {"command = ['a']", "My-Engine.toml", "small letters, digits and _"},
      {"command = ['a']", "all.toml", "and not 'all'"},
      {"command = ['a']", "a.tml", "is called NAME.toml"},
  };
  for (const Case& one : cases) {
    const auto file = parse_engine_file(one.text, one.file);
    ASSERT_FALSE(file) << one.text;
    EXPECT_NE(file.error().text().find(one.words), std::string::npos) << file.error().text();
  }
}

TEST(EngineFile, AreFoundInTheFolderOfTheUserByName) {
  const fs::path config = fs::temp_directory_path() / ("engines." + std::to_string(::getpid()));
  fs::create_directories(config / "brickbench" / "engines");
  for (const char* name : {"zeta.toml", "alpha.toml", "notes.txt"}) {
    std::ofstream(config / "brickbench" / "engines" / name) << "command = ['a']\n";
  }
  ::setenv("XDG_CONFIG_HOME", config.c_str(), 1);
  const auto files = all_engine_files();
  ::unsetenv("XDG_CONFIG_HOME");
  fs::remove_all(config);
  ASSERT_GE(files.size(), 2U);
  EXPECT_EQ(files[0].filename(), "alpha.toml");
  EXPECT_EQ(files.back().filename(), "zeta.toml");
}

// Who names an engine whose program does not start is told why.
TEST(EngineFile, AnEngineThatDoesNotRunIsRefusedWithTheReason) {
  Catalogues catalogues;
  catalogues.known_engines = {"mine"};
  catalogues.why_absent = {{"mine", "PATH has no such program"}};
  const auto selector = parse_selector("mine/fast", {.file = "--engine"}, catalogues, true);
  ASSERT_FALSE(selector);
  EXPECT_EQ(selector.error().text(),
            "--engine: engine 'mine' does not run: PATH has no such program");
}

}  // namespace
}  // namespace brickbench
