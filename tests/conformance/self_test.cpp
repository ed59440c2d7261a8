// The judge on trial: a right engine passes, each wrong one is rejected by the check meant for it.
#include <gtest/gtest.h>

#include <map>

#include "experiments/conformance/check.hpp"
#include "tests/support/fake_engine.hpp"

namespace brickbench::testing {
namespace {

using conformance::all_checks;
using conformance::Check;
using conformance::Outcome;
using conformance::Subject;
using conformance::Verdict;

Subject subject(Defect defect) {
  const Adapter adapter = fake_adapter(defect);
  return {adapter, adapter.variants.front().name};
}

std::map<std::string, Verdict> verdicts(Defect defect) {
  std::map<std::string, Verdict> result;
  for (const Check& check : all_checks()) result[check.name] = check.run(subject(defect));
  return result;
}

TEST(ConformanceSelf, ARightEngineFailsNothing) {
  int passed_checks = 0;
  for (const auto& [name, verdict] : verdicts(Defect::none)) {
    EXPECT_NE(verdict.outcome, Outcome::failed) << name << ": " << verdict.detail;
    passed_checks += verdict.outcome == Outcome::passed ? 1 : 0;
  }
  EXPECT_GE(passed_checks, 17) << "all that needs no contact";
}

// Each defect with the check that must notice it; the others may or may not.
TEST(ConformanceSelf, EveryWrongEngineIsRejected) {
  const std::map<Defect, std::string> noticed_by = {
      {Defect::half_gravity, "step_length"},      {Defect::spin_in_body_frame, "initial_state"},
      {Defect::nan_at_step_7, "free_fall"},       {Defect::swapped_bodies, "body_order"},
      {Defect::throws_at_step_5, "free_fall"},    {Defect::refuses, "initial_state"},
      {Defect::leaks_momentum, "step_length"},    {Defect::doubles_energy, "body_order"},
      {Defect::keeps_wrenches, "force"},          {Defect::rounds_time, "step_length"},
      {Defect::forgets_order_of_runs, "rebuilt"}, {Defect::lies_in_audit, "audit"},
  };
  for (const Defect defect : all_defects()) {
    ASSERT_TRUE(noticed_by.contains(defect)) << to_string(defect);
    const std::string& check = noticed_by.at(defect);
    const auto found = verdicts(defect);
    ASSERT_TRUE(found.contains(check)) << check;
    EXPECT_EQ(found.at(check).outcome, Outcome::failed)
        << to_string(defect) << " escaped " << check << ": " << found.at(check).detail;
  }
}

}  // namespace
}  // namespace brickbench::testing
