// Where plans live and how a short name finds its file.
#pragma once

#include <filesystem>
#include <vector>

#include "experiments/input/input.hpp"

namespace brickbench {

// The folders `below` beside and above the program, where an installed program has them, and in the
// source tree that it was built from, in this order; those that exist.
std::vector<std::filesystem::path> data_folders(const std::filesystem::path& below);

// The folders that hold plans, in order of search: experiments/plans below the current folder,
// beside and above the program, where an installed program has them, and in the source tree that it
// was built from; those that exist.
std::vector<std::filesystem::path> plan_folders();

// `name` is a path, also of a pipe, or the name of a file in one of the folders, with or without
// ".toml". The path is relative to the current folder where the file lies below it.
Checked<std::filesystem::path> find_plan(const std::string& name);

// All *.toml of those folders, by name; of equal names the one that find_plan() would take.
std::vector<std::filesystem::path> all_plans();

}  // namespace brickbench
