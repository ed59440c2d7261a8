// Validation in reports: what `validate --out` saved, as matrix, table, CSV and figures.
#pragma once

#include <string>
#include <vector>

#include "reports/src/figure.hpp"
#include "reports/src/palette.hpp"
#include "reports/src/report_source.hpp"
#include "reports/src/table.hpp"

namespace brickbench {

// Cells of a validation by what became of them. The five other numbers add up to `all`.
struct ValidationCount {
  std::size_t all = 0;
  std::size_t within = 0;  // unexplained part within its bound
  std::size_t beyond = 0;  // unexplained part above its bound: an open question
  std::size_t failed = 0;  // no numbers although the engine took the case
  std::size_t open = 0;    // measured, but the scheme predicts nothing
  std::size_t refused = 0;
};

ValidationCount count_validation(const nlohmann::ordered_json& validation);

// Case x engine: explained / unexplained part of the worst observable, each relative to the case's
// scale; failures and refusals in words. Empty without a validation.
Table validation_matrix(const ReportSource& source);

// One row per engine that was validated: version, precision, the settings read back from the live
// engine, and how many cells passed the audit. Empty where the folder does not hold these facts.
Table audit_table(const ReportSource& source);

// What the matrix shows, in one sentence.
std::string validation_legend(const ReportSource& source);

// case,engine,outcome,verdict,error,explained,unexplained,bound,reason: one line per cell, "" where
// there is no number.
std::string validation_csv(const ReportSource& source);

// Per case of orders.json: relative error against the step, with the fitted order, its 95 %
// half-width and the order that the scheme promises in the legend. Cases in which every
// engine is at rounding have no figure.
std::vector<Figure> orders_against_step(const ReportSource& source, Palette& palette);

// The same errors against the engine's CPU seconds for the whole run.
std::vector<Figure> orders_against_cost(const ReportSource& source, Palette& palette);

// Faults of the files' structure: a sentence, or "" if `json` can be reported.
std::string validation_fault(const nlohmann::ordered_json& json);
std::string orders_fault(const nlohmann::ordered_json& json);

}  // namespace brickbench
