#include "cli/known_questions.hpp"

#include <fmt/core.h>

#include <filesystem>

#include "experiments/run/plan_files.hpp"

namespace brickbench {
namespace {

constexpr const char* k_questions = "reference_data/predictions/open_questions.csv";

}  // namespace

Expected<std::vector<exact::OpenQuestion>> known_questions(const std::string& asked) {
  if (!asked.empty()) return exact::read_open_questions(asked);
  for (const std::filesystem::path& plans : plan_folders()) {
    const auto file = plans.parent_path().parent_path() / k_questions;
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) return exact::read_open_questions(file);
  }
  fmt::print(stderr, "brickbench: no {}: every failure counts as new\n", k_questions);
  return std::vector<exact::OpenQuestion>{};
}

}  // namespace brickbench
