// What shells and manuals need to know of the program, made from its own verbs and options.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace brickbench {

// All from verbs_json(). Scripts for `eval` or for a file that the shell reads at its start.
std::string bash_completion(const nlohmann::ordered_json& verbs);
std::string zsh_completion(const nlohmann::ordered_json& verbs);
// A page for `man`, in the man macros of roff; `version` as the footer shows it.
std::string man_page(const nlohmann::ordered_json& verbs, const std::string& version);

}  // namespace brickbench
