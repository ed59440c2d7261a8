#include "experiments/exact/validation/scan.hpp"

#include "experiments/exact/cases/draw.hpp"

namespace brickbench::exact {

Drawings drawings_of(const ExactCase& exact_case, std::uint64_t seed, std::size_t count) {
  Drawings drawings;
  for (std::size_t i = 0; i < count * k_most_drawings && drawings.inside.size() < count; ++i) {
    ParameterValues values = draw(exact_case, seed, i);
    std::string why;
    if (exact_case.outside != nullptr) {
      why = exact_case.outside(complete(exact_case, values).value());
    }
    if (why.empty()) {
      drawings.inside.push_back(std::move(values));
    } else {
      ++drawings.outside[why];
    }
  }
  return drawings;
}

Verdict verdict_of(const CellResult& cell, const OpenQuestion* question) {
  if (cell.outcome == "refused") return Verdict::refused;
  if (cell.failed()) return question != nullptr ? Verdict::known : Verdict::failed;
  return cell.worst_unexplained() ? Verdict::held : Verdict::open;
}

std::string_view to_word(Verdict verdict) {
  switch (verdict) {
    case Verdict::held:
      return "ok";
    case Verdict::open:
      return "open";
    case Verdict::known:
      return "known";
    case Verdict::refused:
      return "refused";
    case Verdict::failed:
      return "FAILED";
  }
  return "FAILED";
}

}  // namespace brickbench::exact
