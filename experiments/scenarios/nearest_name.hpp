// The known name that a misspelt one most likely meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace brickbench {

// Levenshtein distance: the fewest insertions, deletions and substitutions that turn a into b.
std::size_t edit_distance(std::string_view a, std::string_view b);

// The name of least edit distance if that is a slip of the fingers, at most a third of the letters;
// else the name that shares the longest run of letters, three or more; else the nearest after all.
// The first of equals; empty if `known` is.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

}  // namespace brickbench
