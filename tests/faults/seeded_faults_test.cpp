// The harness checks itself: every seeded fault is caught, a correct engine raises no alarm.
#include "tests/faults/seeded_faults.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <set>

#include "experiments/exact/validation/validate.hpp"

namespace brickbench::testing {
namespace {

// Few and short cases that together look at every fact, setting and read-out.
const std::vector<std::string> k_cases = {
    "free_flight.projectile", "free_flight.constant_force", "free_flight.explosion",
    "rotation.spin_up",       "rotation.torque_free_3",     "impact.ball_apexes",
    "impact.corner",          "impact.central_spheres",     "impact.off_centre",
    "friction.sliding_stop",  "friction.diagonal_slide",    "friction.incline_slide",
    "rolling.slide_to_roll",  "friction.pull_apart",        "statics.slope"};

// Resultants of contact forces at rest are exact without a discrete map: the correct engine meets
// them to 1e-9, so a per mille is a fault.
constexpr double k_resultant_bound = 1e-3;
const std::set<std::string> k_resultants = {"statics.slope", "friction.pull_apart"};

struct Catch {
  bool audit = false;
  std::vector<std::string> cases;
  bool any() const { return audit || !cases.empty(); }
};

bool caught(const exact::CellResult& cell) {
  if (cell.failed()) return true;
  if (!k_resultants.contains(cell.case_id)) return false;
  for (const exact::Score& score : cell.scores) {
    if (!(score.error <= k_resultant_bound)) return true;
  }
  return false;
}

Catch judge(std::size_t fault) {
  Catch result;
  const auto cases = exact::exact_cases();
  for (const std::string& id : k_cases) {
    const exact::ExactCase exact_case = exact::select_cases(cases, id).front();
    const auto open = exact::validate(faulty_adapter(fault, true), "", exact_case);
    result.audit = result.audit || open.outcome == "audit";
    if (caught(exact::validate(faulty_adapter(fault, false), "", exact_case))) {
      result.cases.push_back(id);
    }
  }
  return result;
}

class SeededFaults : public ::testing::Test {
 protected:
  void SetUp() override {
    if (correct_adapter().name.empty()) {
      GTEST_SKIP() << "no linked engine has spheres, friction and restitution";
    }
  }
};

TEST_F(SeededFaults, AreAtLeast24) { EXPECT_GE(seeded_faults().size(), 25u); }

TEST_F(SeededFaults, CorrectEngineRaisesNone) {
  const Catch result = judge(0);
  EXPECT_FALSE(result.audit);
  for (const std::string& id : result.cases) ADD_FAILURE() << id << " raised a false alarm";
}

TEST_F(SeededFaults, AreAllCaught) {
  std::cout << "| fault | what is wrong | audit | motion and forces alone |\n|---|---|---|---|\n";
  for (std::size_t i = 1; i < seeded_faults().size(); ++i) {
    const Catch result = judge(i);
    const SeededFault& fault = seeded_faults()[i];
    std::cout << "| " << fault.name << " | " << fault.story << " | "
              << (result.audit ? "caught" : "-") << " | " << result.cases.size() << " of "
              << k_cases.size() << (result.cases.empty() ? "" : ": " + result.cases.front())
              << " |\n";
    EXPECT_TRUE(result.any()) << fault.name << " was not caught";
  }
}

}  // namespace
}  // namespace brickbench::testing
