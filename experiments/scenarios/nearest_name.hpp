// The known name that a misspelt one most likely meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace brickbench {

// Levenshtein distance: the fewest insertions, deletions and substitutions that turn a into b.
std::size_t edit_distance(std::string_view a, std::string_view b);

// The name of least edit distance, the first of equals; empty if `known` is.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

}  // namespace brickbench
