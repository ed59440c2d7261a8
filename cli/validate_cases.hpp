// `validate`: exact cases in engines, as a table at given values or drawn over their domains.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/exact/validation/open_questions.hpp"
#include "experiments/run/catalogues.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {

struct CasesAsked {
  std::vector<EngineVariant> engines;
  std::vector<exact::ExactCase> cases;
  KnobValues knobs;
  ParameterValues parameters;  // of the case, if it is one
  std::vector<exact::OpenQuestion> questions = {};
  bool json = false;
  std::string out = {};                     // a new folder for `report`; empty: none
  std::vector<std::string> knob_text = {};  // as typed
  std::vector<std::string> engine_files = {};
  std::vector<std::string> arguments = {};  // as typed
};

// One cell per case and engine. Exit code 1 if one failed that no open question names.
int tabulate_cases(const CasesAsked& asked, const Catalogues& catalogues);

// `count` drawings of each case in each engine. Exit code 1 as above; 3 where a case has fewer
// drawings inside its domain.
int scan_cases(const CasesAsked& asked, const Catalogues& catalogues, std::size_t count,
               std::uint64_t seed);

}  // namespace brickbench
