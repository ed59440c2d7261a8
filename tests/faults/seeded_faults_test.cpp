// The harness checks itself: every seeded fault is caught, a correct engine raises no alarm.
#include "tests/faults/seeded_faults.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>

#include "tests/faults/instruments.hpp"

namespace brickbench::testing {
namespace {

class SeededFaults : public ::testing::Test {
 protected:
  void SetUp() override {
    if (correct_adapter().name.empty()) {
      GTEST_SKIP() << "no linked engine has spheres, friction and restitution";
    }
  }
};

std::string or_dash(const std::string& text) { return text.empty() ? "-" : text; }

std::string table_row(const SeededFault& fault, const Caught& caught) {
  const std::string cases = fmt::format("{} of {}{}", caught.cases.size(), judged_cases().size(),
                                        caught.cases.empty() ? "" : ": " + caught.cases.front());
  return fmt::format("| {} | {} | {} | {} | {} | {} |", fault.name, fault.story,
                     caught.audit ? "caught" : "-", cases, or_dash(caught.run),
                     or_dash(caught.hunt));
}

TEST_F(SeededFaults, AreAtLeast40AndHaveNamesOfTheirOwn) {
  EXPECT_GE(seeded_faults().size(), 41U);
  for (std::size_t i = 0; i < seeded_faults().size(); ++i) {
    EXPECT_EQ(fault_named(seeded_faults()[i].name), i);
  }
}

TEST_F(SeededFaults, CorrectEngineRaisesNone) {
  const Caught caught = Instruments().look_at(0);
  EXPECT_FALSE(caught.audit);
  EXPECT_EQ(caught.run, "");
  EXPECT_EQ(caught.hunt, "");
  for (const std::string& id : caught.cases) ADD_FAILURE() << id << " raised a false alarm";
}

TEST_F(SeededFaults, AreAllCaught) {
  Instruments instruments;
  std::cout << "| fault | what is wrong | audit | exact cases, audit hidden | ordinary run | hunt "
               "|\n|---|---|---|---|---|---|\n";
  for (std::size_t i = 1; i < seeded_faults().size(); ++i) {
    const Caught caught = instruments.look_at(i);
    std::cout << table_row(seeded_faults()[i], caught) << std::endl;
    EXPECT_TRUE(caught.any()) << seeded_faults()[i].name << " was not caught";
  }
}

// What no ordinary run may call ok: it is worse than any error of a scheme.
TEST_F(SeededFaults, ThatRuinARunAreSeenByTheRun) {
  const std::map<std::string, std::string> expected = {
      {"contact_is_lost_when_moved_apart", "blown_up"},
      {"light_bricks_explode", "blown_up"},
      {"flies_to_1e33_m", "blown_up"},
      {"is_carried_to_1e33_m", "blown_up"},
      {"sinks_after_a_blow", "tunnelled"},
      {"passes_at_a_hit", "tunnelled"},
      {"not_a_number", "diverged"}};
  for (const auto& [name, said] : expected) {
    const std::string seen = said_by_runs(fault_named(name));
    EXPECT_TRUE(seen.starts_with(said)) << name << ": " << seen;
  }
}

}  // namespace
}  // namespace brickbench::testing
