#include "cli/cell_output.hpp"

#include <fmt/format.h>

#include <cmath>

#include "adapters/seam/unit.hpp"
#include "cli/json_number.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

std::string digits(double value) {
  return std::isnan(value) ? std::string("-") : fmt::format("{:.3g}", value);
}
std::string digits(const std::optional<double>& value) { return value ? digits(*value) : "-"; }

double largest(const exact::CellResult& cell, double exact::Score::*part) {
  double worst = std::nan("");
  for (const exact::Score& score : cell.scores) {
    const double value = score.*part;
    if (!std::isnan(value) && (std::isnan(worst) || value > worst)) worst = value;
  }
  return worst;
}

double largest_explained(const exact::CellResult& cell) {
  double worst = std::nan("");
  for (const exact::Score& score : cell.scores) {
    if (!score.explained || std::isnan(*score.explained)) continue;
    worst = std::isnan(worst) ? *score.explained : std::max(worst, *score.explained);
  }
  return worst;
}

void print_bracket(const exact::Bracket& bracket) {
  const std::string unit = unit_suffix(bracket.unit);
  if (bracket.found) {
    fmt::print("    {} between {:.6g} and {:.6g}{}, exact {:.6g}\n", bracket.parameter, bracket.low,
               bracket.high, unit, bracket.truth);
  } else {
    fmt::print("    {}: the same outcome at {:.6g} and {:.6g}{}, exact {:.6g}\n", bracket.parameter,
               bracket.low, bracket.high, unit, bracket.truth);
  }
}

Json scores_json(const exact::CellResult& cell) {
  auto scores = Json::array();
  for (const exact::Score& score : cell.scores) {
    scores.push_back({{"id", score.observable},
                      {"unit", score.unit},
                      {"truth", json_number(score.truth)},
                      {"predicted", json_number(score.predicted)},
                      {"measured", json_number(score.measured)},
                      {"scale", json_number(score.scale)},
                      {"error", json_number(score.error)},
                      {"explained", json_number(score.explained)},
                      {"unexplained", json_number(score.unexplained)}});
  }
  return scores;
}

}  // namespace

std::string reproduce_cell(const exact::CellResult& cell, const ParameterValues& given,
                           const std::vector<std::string>& knobs) {
  std::string line = fmt::format("brickbench validate --engine {}/{} --case {}", cell.engine,
                                 cell.variant, cell.case_id);
  for (const auto& [name, value] : given) {
    line += fmt::format(" --parameter {}={}", name, std::get<double>(value));
  }
  for (const std::string& knob : knobs) line += " --knob " + knob;
  return line;
}

Json cell_json(const JudgedCell& judged) {
  const exact::CellResult& cell = judged.cell;
  Json parameters = Json::object();
  for (const auto& [name, value] : judged.given) parameters[name] = std::get<double>(value);
  Json json = {{"id", fmt::format("{}/{}:{}", cell.engine, cell.variant, cell.case_id)},
               {"engine", cell.engine},
               {"variant", cell.variant},
               {"case", cell.case_id},
               {"parameters", parameters},
               {"verdict", exact::to_word(judged.verdict)},
               {"outcome", cell.outcome},
               {"reason", cell.reason},
               {"failed", cell.failed()},
               {"question", judged.question == nullptr ? "" : judged.question->question},
               {"bound", cell.bound},
               {"no_prediction", cell.no_prediction},
               {"law", cell.law},
               {"scores", scores_json(cell)}};
  if (cell.bracket) {
    json["threshold"] = {
        {"parameter", cell.bracket->parameter},      {"unit", cell.bracket->unit},
        {"truth", json_number(cell.bracket->truth)}, {"low", json_number(cell.bracket->low)},
        {"high", json_number(cell.bracket->high)},   {"found", cell.bracket->found}};
  }
  json["reproduce"] = judged.reproduce;
  return json;
}

void print_cell_header() {
  fmt::print("{:<30} {:<18} {:<8} {:>9} {:>9} {:>9}  {}\n", "case", "engine", "verdict", "error",
             "explained", "unexpl.", "reproduce with");
}

void print_cell(const JudgedCell& judged) {
  const exact::CellResult& cell = judged.cell;
  const bool ran = cell.outcome == "ok";
  fmt::print("{:<30} {:<18} {:<8} {:>9} {:>9} {:>9}  {}\n", cell.case_id,
             cell.engine + '/' + cell.variant, exact::to_word(judged.verdict),
             ran ? digits(largest(cell, &exact::Score::error)) : "-",
             digits(largest_explained(cell)), digits(cell.worst_unexplained()), judged.reproduce);
  if (!cell.law.empty()) fmt::print("    law of impact: {}\n", cell.law);
  if (!cell.reason.empty()) fmt::print("    {}\n", cell.reason);
  if (judged.verdict == exact::Verdict::known) {
    fmt::print("    open question: {}\n", judged.question->question);
  }
  if (ran && !cell.no_prediction.empty()) fmt::print("    no prediction: {}\n", cell.no_prediction);
  if (cell.bracket) print_bracket(*cell.bracket);
}

}  // namespace brickbench
