#include "ourengine/contact/problem.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/ourengine/contact/small_problems.hpp"

namespace brickbench::testing {
namespace {

using ourengine::normal_bias_mps;
using ourengine::problem_error;

constexpr double kStep = 0.01;
constexpr double kRecovery = 0.5;

double bias(double gap_m, double restitution, double approach_mps) {
  ProblemContact contact;
  contact.gap_m = gap_m;
  contact.restitution = restitution;
  contact.approach_mps = approach_mps;
  return normal_bias_mps(contact, kStep, kRecovery);
}

TEST(ContactProblem, AnOpenGapMayCloseWithinTheStep) {
  EXPECT_DOUBLE_EQ(bias(0.002, 0.0, 0.0), 0.2);
}

TEST(ContactProblem, AnOverlapIsPushedApartNotFasterThanRecovery) {
  EXPECT_DOUBLE_EQ(bias(-0.001, 0.0, 0.0), -0.1);
  EXPECT_DOUBLE_EQ(bias(-0.1, 0.0, 0.0), -kRecovery);
}

TEST(ContactProblem, RestitutionOnlyWhenTheContactIsReached) {
  EXPECT_DOUBLE_EQ(bias(0.0, 0.8, -2.0), -1.6);
  EXPECT_DOUBLE_EQ(bias(0.019, 0.8, -2.0), -1.6);
  EXPECT_DOUBLE_EQ(bias(0.021, 0.8, -2.0), 2.1);  // still 0.1 m/s short of the surface
  EXPECT_DOUBLE_EQ(bias(0.0, 0.8, 2.0), 0.0);     // leaving
}

TEST(ContactProblem, NamesWhatIsMalformed) {
  const ContactProblem good = random_tower(2, 0.5, 1);
  EXPECT_EQ(problem_error(good), "");
  const struct {
    const char* expected;
    std::function<void(ContactProblem&)> spoil;
  } cases[] = {
      {"step_s", [](ContactProblem& p) { p.step_s = 0.0; }},
      {"body 1: mass", [](ContactProblem& p) { p.bodies[1].mass_kg = -1.0; }},
      {"body 2: inertia is not symmetric",
       [](ContactProblem& p) { p.bodies[2].inertia_kgm2(0, 1) += 0.1; }},
      {"body 2: inertia is not positive",
       [](ContactProblem& p) { p.bodies[2].inertia_kgm2 = -p.bodies[2].inertia_kgm2; }},
      {"body 1: free velocity", [](ContactProblem& p) { p.free_velocity[1][3] = HUGE_VAL; }},
      {"differ in number", [](ContactProblem& p) { p.free_velocity.pop_back(); }},
      {"contact 3: body index", [](ContactProblem& p) { p.contacts[3].body_b = 9; }},
      {"contact 3: a body touches itself",
       [](ContactProblem& p) { p.contacts[3].body_b = p.contacts[3].body_a; }},
      {"contact 0: frame", [](ContactProblem& p) { p.contacts[0].normal *= 1.001; }},
      {"contact 0: friction", [](ContactProblem& p) { p.contacts[0].friction = -0.1; }},
      {"contact 0: restitution", [](ContactProblem& p) { p.contacts[0].restitution = 1.1; }},
  };
  for (const auto& c : cases) {
    ContactProblem spoiled = good;
    c.spoil(spoiled);
    EXPECT_NE(problem_error(spoiled).find(c.expected), std::string::npos)
        << c.expected << " expected, got: " << problem_error(spoiled);
  }
}

}  // namespace
}  // namespace brickbench::testing
