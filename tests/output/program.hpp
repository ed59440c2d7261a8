// The program as a user has it: asked in a folder of its own, answering with exit code and streams.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "adapters/catalog.hpp"
#include "experiments/record/file.hpp"
#include "experiments/run/catalogues.hpp"

namespace brickbench::testing {

namespace fs = std::filesystem;

struct Answer {
  int code = -1;
  std::string out;
  std::string err;
};

class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("brickbench_cli." + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    // Engines of whoever runs the tests are not part of them.
    ::setenv("XDG_CONFIG_HOME", (folder_ / "config").c_str(), 1);
  }
  void TearDown() override {
    std::error_code error;
    fs::permissions(folder_ / "locked", fs::perms::owner_all, error);
    fs::remove_all(folder_);
  }

  Answer ask(const std::string& arguments) const {
    const std::string command = std::string(BRICKBENCH_PROGRAM) + ' ' + arguments + " >" +
                                path("out") + " 2>" + path("err");
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, *read_file(folder_ / "out"),
            *read_file(folder_ / "err")};
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string put(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return path(name);
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::recursive_directory_iterator(folder_), {}));
  }

  // What this build links and what it knows of, as the program says.
  Catalogues linked() const {
    Catalogues catalogues{scenarios(), metrics(), adapters(), {}};
    const auto json = nlohmann::json::parse(ask("doctor --json").out);
    for (const char* list : {"engines", "absent"}) {
      for (const auto& engine : json[list]) catalogues.known_engines.push_back(engine["id"]);
    }
    return catalogues;
  }

  fs::path folder_;
};

}  // namespace brickbench::testing
