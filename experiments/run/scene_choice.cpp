#include "experiments/run/scene_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "experiments/scenes/scene_file.hpp"

namespace brickbench {
namespace {

namespace fs = std::filesystem;

tl::unexpected<InputError> complaint(const SourcePosition& at, std::string reason) {
  return tl::unexpected<InputError>({at, std::move(reason)});
}

// Where the path leads that stands in `file`; a plan from a pipe is as good as one here.
fs::path from_file(const fs::path& path, const fs::path& file) {
  std::error_code error;
  if (path.is_absolute() || !fs::is_regular_file(file, error)) return path;
  return (file.parent_path() / path).lexically_normal();
}

// The scene files in the folder of a path.
std::vector<std::string> files_beside(const fs::path& path) {
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (is_scene_file(name)) names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace

Checked<SceneChoice> choose_scene(const InputValue& name, const Catalogues& catalogues) {
  if (!is_scene_file(name.text)) {
    const Scenario* scenario = find_scenario(catalogues, name.text);
    if (scenario != nullptr) return SceneChoice{scenario, nullptr};
    return complaint(name.at,
                     fmt::format("no scenario '{}'{}; a scene file's name ends in .toml", name.text,
                                 known_names(name.text, names_of(catalogues.scenarios))));
  }
  const fs::path path = from_file(name.text, name.at.file);
  std::error_code error;
  if (!fs::exists(path, error) || fs::is_directory(path, error)) {
    return complaint(name.at,
                     fmt::format("no scene file {}{}", path.string(),
                                 known_names(path.filename().string(), files_beside(path))));
  }
  auto read = read_scene(path);
  if (!read) return tl::unexpected(read.error());
  if (find_scenario(catalogues, read->name) != nullptr) {
    return complaint(name.at, fmt::format("{} is called like the compiled scene {}: give the file "
                                          "another name",
                                          path.string(), read->name));
  }
  const auto file = std::make_shared<const Scenario>(std::move(*read));
  return SceneChoice{file.get(), file};
}

Checked<SceneChoice> choose_scene(const std::string& name, const std::string& option,
                                  const Catalogues& catalogues) {
  InputValue value;
  value.kind = ValueKind::text;
  value.text = name;
  value.at.file = option;
  return choose_scene(value, catalogues);
}

}  // namespace brickbench
