#include "experiments/run/engine_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "experiments/record/file.hpp"
#include "experiments/run/plan_files.hpp"

namespace brickbench {
namespace fs = std::filesystem;
namespace {

const std::vector<std::string>& engine_file_keys() {
  static const std::vector<std::string> keys = {"command",  "working_folder",  "environment",
                                                "licence",  "version_command", "deadline_s",
                                                "memory_mb"};
  return keys;
}

// Selectors are engine/variant: a name is one word of small letters, digits and _.
std::string engine_name_of(const fs::path& file) {
  const std::string name = file.stem().string();
  const bool plain = std::ranges::all_of(
      name, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
  if (plain && !name.empty() && name != "all" && file.extension() == ".toml") return name;
  reject(
      {.file = file.string()},
      fmt::format("an engine file is called NAME.toml, with NAME of small letters, digits and _, "
                  "and not 'all'; this one is '{}'",
                  file.filename().string()));
}

std::vector<std::string> words_of(const InputValue& value, std::string_view name) {
  expect(value, name, ValueKind::array);
  std::vector<std::string> words;
  for (const InputValue& item : value.items) words.push_back(filled_text(item, name));
  if (words.empty()) reject(value.at, fmt::format("{} is an empty list", name));
  return words;
}

std::vector<std::string> environment_of(const InputValue& value) {
  expect(value, "environment", ValueKind::table);
  std::vector<std::string> all;
  for (const Entry& entry : value.entries) {
    expect(entry.value, entry.name, ValueKind::text);
    if (entry.name.empty() || entry.name.find('=') != std::string::npos) {
      reject(entry.at, "a name in environment is not empty and has no '='");
    }
    all.push_back(entry.name + '=' + entry.value.text);
  }
  return all;
}

std::uint64_t megabytes(const InputValue& value) {
  constexpr double most_mb = 1e9;
  const double number = finite_number(value, "memory_mb");
  if (number < 0.0 || number > most_mb || number != std::floor(number)) {
    reject(value.at,
           fmt::format("memory_mb = {}: allowed are whole numbers from 0 (no limit) to {}", number,
                       most_mb));
  }
  return static_cast<std::uint64_t>(number);
}

EngineFile to_engine_file(const InputValue& table, const fs::path& file) {
  reject_unknown(table, "an engine file", engine_file_keys());
  EngineFile engine;
  engine.name = engine_name_of(file);
  engine.file = file;
  engine.working_folder = fs::absolute(file).parent_path();
  const InputValue* command = table.find("command");
  if (command == nullptr) {
    reject({.file = file.string()}, "command is missing: a list of the program and its arguments");
  }
  engine.command = words_of(*command, "command");
  if (const InputValue* value = table.find("working_folder")) {
    engine.working_folder /= filled_text(*value, "working_folder");
  }
  if (const InputValue* value = table.find("environment")) {
    engine.environment = environment_of(*value);
  }
  if (const InputValue* value = table.find("version_command")) {
    engine.version_command = words_of(*value, "version_command");
  }
  if (const InputValue* value = table.find("licence")) {
    engine.licence = filled_text(*value, "licence");
  }
  if (const InputValue* value = table.find("deadline_s")) {
    engine.deadline_s = positive_number(*value, "deadline_s");
    constexpr double most_s = 1e6;
    if (engine.deadline_s > most_s)
      reject(value->at, fmt::format("deadline_s: at most {}", most_s));
  }
  if (const InputValue* value = table.find("memory_mb")) engine.memory_mb = megabytes(*value);
  return engine;
}

std::vector<fs::path> engine_folders() {
  const fs::path below = fs::path("brickbench") / "engines";
  std::vector<fs::path> folders;
  const char* config = std::getenv("XDG_CONFIG_HOME");
  const char* home = std::getenv("HOME");
  if (config != nullptr && *config != '\0') {
    folders.push_back(config / below);
  } else if (home != nullptr && *home != '\0') {
    folders.push_back(fs::path(home) / ".config" / below);
  }
  for (const fs::path& folder : data_folders(fs::path("adapters") / "engines")) {
    folders.push_back(folder);
  }
  return folders;
}

}  // namespace

Checked<EngineFile> parse_engine_file(std::string_view text, const fs::path& file) {
  const auto table = parse_toml(text, file.string());
  if (!table) return tl::unexpected(table.error());
  try {
    return to_engine_file(*table, file);
  } catch (const InputError& error) {
    return tl::unexpected(error);
  }
}

Checked<EngineFile> read_engine_file(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return file_error(file.string(), text.error().reason);
  return parse_engine_file(*text, file);
}

std::vector<fs::path> all_engine_files() {
  std::vector<fs::path> files;
  for (const fs::path& folder : engine_folders()) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() != ".toml") continue;
      const bool known = std::ranges::any_of(
          files, [&](const fs::path& file) { return file.stem() == entry.path().stem(); });
      if (!known) files.push_back(entry.path());
    }
  }
  std::ranges::sort(files, {}, [](const fs::path& file) { return file.stem(); });
  return files;
}

}  // namespace brickbench
