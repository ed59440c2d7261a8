#include "experiments/run/plan_files.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace brickbench {
namespace fs = std::filesystem;
namespace {

// A pipe is as good as a file on a disk: /dev/stdin, <(...).
bool is_readable(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error) && !fs::is_directory(path, error);
}

fs::path program_folder() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path();
}

fs::path shown(const fs::path& path) {
  std::error_code error;
  const fs::path relative = fs::proximate(path, error);
  return error || relative.string().starts_with("..") ? path : relative;
}

std::vector<fs::path> existing(const std::vector<fs::path>& candidates) {
  std::vector<fs::path> folders;
  std::vector<fs::path> real;
  for (const fs::path& candidate : candidates) {
    std::error_code error;
    const fs::path canonical = fs::canonical(candidate, error);
    if (error || std::ranges::find(real, canonical) != real.end()) continue;
    real.push_back(canonical);
    folders.push_back(candidate);
  }
  return folders;
}

}  // namespace

std::vector<fs::path> data_folders(const fs::path& below) {
  std::vector<fs::path> candidates;
  fs::path above = program_folder();
  for (int level = 0; level < 3 && !above.empty(); ++level) {
    candidates.push_back(above / below);
    above = above.parent_path();
  }
  candidates.push_back(program_folder().parent_path() / "share" / "brickbench" / below);
  candidates.push_back(fs::path(BRICKBENCH_SOURCE_DIR) / below);
  return existing(candidates);
}

std::vector<fs::path> plan_folders() {
  const fs::path plans = fs::path("experiments") / "plans";
  std::vector<fs::path> candidates = {plans};
  for (const fs::path& folder : data_folders(plans)) candidates.push_back(folder);
  return existing(candidates);
}

Checked<fs::path> find_plan(const std::string& name) {
  if (is_readable(name)) return fs::path(name);
  std::vector<std::string> known;
  for (const fs::path& file : all_plans()) {
    if (file.stem() == name || file.filename() == name) return file;
    known.push_back(file.stem().string());
  }
  std::error_code error;
  if (fs::is_directory(name, error)) {
    return file_error(name, "is a folder, not a plan");
  }
  return file_error(name, "no such plan file" + known_names(fs::path(name).stem().string(), known));
}

std::vector<fs::path> all_plans() {
  std::vector<fs::path> plans;
  for (const fs::path& folder : plan_folders()) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() != ".toml") continue;
      const bool known = std::ranges::any_of(
          plans, [&](const fs::path& plan) { return plan.stem() == entry.path().stem(); });
      if (!known) plans.push_back(shown(entry.path()));
    }
  }
  std::ranges::sort(plans, {}, [](const fs::path& plan) { return plan.stem(); });
  return plans;
}

}  // namespace brickbench
