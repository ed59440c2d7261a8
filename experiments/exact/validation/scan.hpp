// Scan: an exact case as a family. It is drawn over its domain and each drawing is one cell per
// engine; what the drawings outside the domain were is counted, not hidden.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "experiments/exact/validation/open_questions.hpp"

namespace brickbench::exact {

struct Drawings {
  std::vector<ParameterValues> inside;
  std::map<std::string, std::size_t> outside;  // why: how many
};

// Drawings 0, 1, ... of the case under the seed until `count` are inside its domain; gives up after
// k_most_drawings for each that was asked for.
inline constexpr std::size_t k_most_drawings = 50;
Drawings drawings_of(const ExactCase& exact_case, std::uint64_t seed, std::size_t count);

enum class Verdict { held, open, known, refused, failed };

// `open`: without prediction. `known`: failed, as a question says. A refusal is not a failure.
Verdict verdict_of(const CellResult& cell, const OpenQuestion* question);
std::string_view to_word(Verdict verdict);

}  // namespace brickbench::exact
