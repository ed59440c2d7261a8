// Engine files: how an engine that is a program of its own is started. NAME.toml adds the engine
// NAME; docs/cli.md has the keys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/input/input.hpp"

namespace brickbench {

struct EngineFile {
  std::string name;  // of the engine: the file's, without .toml
  std::filesystem::path file;
  std::vector<std::string> command;          // program and arguments
  std::filesystem::path working_folder;      // absolute; the file's folder where none is stated
  std::vector<std::string> environment;      // NAME=value
  std::vector<std::string> version_command;  // its first line is added to the version; or empty
  std::string licence;
  double deadline_s = 60.0;        // wall-clock time for one answer
  std::uint64_t memory_mb = 4096;  // resident memory; 0: no limit
};

// `file` stands in messages and gives the name and the folder.
Checked<EngineFile> parse_engine_file(std::string_view text, const std::filesystem::path& file);
Checked<EngineFile> read_engine_file(const std::filesystem::path& file);

// All *.toml, by name, of the user's folder ($XDG_CONFIG_HOME/brickbench/engines, else
// ~/.config/brickbench/engines) and of the project's (adapters/engines above the program, where an
// installed program has it, and in the source tree); of equal names the first. Never of the current
// folder: what lies there by chance is not run.
std::vector<std::filesystem::path> all_engine_files();

}  // namespace brickbench
