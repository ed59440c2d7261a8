// What `check` prints: one screen for people, everything for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "experiments/regression/check.hpp"

namespace brickbench {

struct CheckTold {
  std::string suite;
  std::string reference;   // the folder of references as given
  bool is_first = false;   // there are no references yet
  std::string obtained;    // the folder that the numbers went to
  std::size_t worst = 20;  // offenders to print
};

// Experiments first, then changed settings, offenders, open numbers, loose bounds, and what to do
// next.
void print_check(const gate::CheckResult& result, const CheckTold& told);

nlohmann::ordered_json check_json(const gate::CheckResult& result, const CheckTold& told,
                                  int exit_code);

}  // namespace brickbench
