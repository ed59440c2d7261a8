// Engines that are added by a file: the option --engine-file, and what this build can run with it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "experiments/input/input.hpp"
#include "experiments/run/catalogues.hpp"

namespace brickbench {

// Adds the option --engine-file, which may be repeated.
void add_engine_files(CLI::App& verb, std::vector<std::string>& files);

// All that is linked, and the engines of these files, of the user's folder and of the project's.
// A file that is named must be right; of the others one that is wrong, and any program that does
// not start, gets its reason in Catalogues::why_absent.
Checked<Catalogues> all_catalogues(const std::vector<std::string>& files);

// The same for verbs that run engines: complains on standard error of each engine that is absent.
Checked<Catalogues> running_catalogues(const std::vector<std::string>& files);

// The words with which a printed command names these files.
std::vector<std::string> engine_file_words(const std::vector<std::string>& files);

}  // namespace brickbench
