#include "cli/engine_files.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "adapters/remote/remote_adapter.hpp"
#include "cli/build_facts.hpp"
#include "experiments/run/engine_file.hpp"

namespace brickbench {
namespace {

remote::Command program_of(const EngineFile& file, const std::vector<std::string>& words) {
  return {.words = words,
          .folder = file.working_folder.string(),
          .environment = file.environment,
          .deadline_s = file.deadline_s,
          .memory_mb = file.memory_mb};
}

Expected<Adapter> started_engine(const EngineFile& file) {
  auto adapter = remote::remote_adapter(file.name, program_of(file, file.command));
  if (!adapter || file.version_command.empty()) return adapter;
  const auto line = remote::first_line_of(program_of(file, file.version_command));
  if (!line) return tl::unexpected(line.error());
  adapter->version += fmt::format(" ({})", *line);
  return adapter;
}

void add_engine(const EngineFile& file, Catalogues& catalogues) {
  auto& known = catalogues.known_engines;
  const bool linked = find_adapter(catalogues, file.name) != nullptr;
  if (std::ranges::find(known, file.name) == known.end()) known.push_back(file.name);
  if (linked) {
    fmt::print(stderr, "brickbench: {}: there is an engine '{}' already; the file is left out\n",
               file.file.string(), file.name);
    return;
  }
  auto adapter = started_engine(file);
  if (adapter) {
    catalogues.adapters.push_back(std::move(*adapter));
  } else {
    catalogues.why_absent[file.name] = adapter.error().reason;
  }
}

}  // namespace

void add_engine_files(CLI::App& verb, std::vector<std::string>& files) {
  verb.add_option("--engine-file", files,
                  "NAME.toml of an engine that is a program; may be repeated")
      ->expected(1)
      ->take_all();
}

Checked<Catalogues> all_catalogues(const std::vector<std::string>& files) {
  Catalogues catalogues = all_catalogues();
  for (const std::string& path : files) {
    const auto file = read_engine_file(path);
    if (!file) return tl::unexpected(file.error());
    const bool twice = std::ranges::any_of(
        catalogues.adapters, [&](const Adapter& adapter) { return adapter.name == file->name; });
    if (twice) {
      return file_error(
          path,
          fmt::format("there is an engine '{}' already; call the file otherwise", file->name));
    }
    add_engine(*file, catalogues);
  }
  for (const std::filesystem::path& path : all_engine_files()) {
    const auto file = read_engine_file(path);
    if (file) {
      const bool named = std::ranges::any_of(files, [&](const std::string& one) {
        return std::filesystem::path(one).stem() == path.stem();
      });
      if (!named) add_engine(*file, catalogues);
    } else {
      catalogues.known_engines.push_back(path.stem().string());
      catalogues.why_absent[path.stem().string()] = file.error().text();
    }
  }
  return catalogues;
}

Checked<Catalogues> running_catalogues(const std::vector<std::string>& files) {
  auto catalogues = all_catalogues(files);
  if (!catalogues) return catalogues;
  for (const auto& [name, why] : catalogues->why_absent) {
    fmt::print(stderr, "brickbench: engine '{}' does not run: {}\n", name, why);
  }
  return catalogues;
}

std::vector<std::string> engine_file_words(const std::vector<std::string>& files) {
  std::vector<std::string> words;
  for (const std::string& file : files) {
    words.emplace_back("--engine-file");
    words.push_back(file);
  }
  return words;
}

}  // namespace brickbench
