// Open questions: cells beyond their bound that are known and published, with what is known of
// them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/exact/validation/validate.hpp"

namespace brickbench::exact {

// A parameter between two values, both included.
struct ParameterRange {
  std::string parameter;
  double low = 0.0;
  double high = 0.0;
};

// Where in the domain of its case a question is open.
struct Region {
  bool at_defaults = true;             // at the case's own values alone
  std::vector<ParameterRange> ranges;  // else all of these; none: everywhere
};

struct OpenQuestion {
  std::string engine;
  std::string variant;
  std::string case_id;
  Region region;
  std::string date;
  std::string gone_with;  // knob=value with which the cell is within its bound; empty: none known
  std::string question;
};

// The columns of the file, in this order: engine,variant,case,where,date,gone_with,question.
// `where` is empty (the defaults), `any`, or name=low..high in SI, several joined by ';'. The
// question is the rest of the line, commas included. Fault::invalid with file:line.
Expected<std::vector<OpenQuestion>> read_open_questions(const std::filesystem::path& file);

// The question that a cell at `values` (completed) belongs to; nullptr: it is not a known one.
const OpenQuestion* question_of(const std::vector<OpenQuestion>& questions, const CellResult& cell,
                                const ExactCase& exact_case, const ParameterValues& values);

}  // namespace brickbench::exact
