// The verbs of the program with their options, as the parser knows them.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace brickbench {

// One object per verb, those below another ("sweep run") after it: id, meaning, and its options,
// each with id ("--engine", or PLAN for what has a place), value (the kind of what follows, empty
// for a switch), required and meaning. Without --help.
nlohmann::ordered_json verbs_json(const CLI::App& app);

}  // namespace brickbench
