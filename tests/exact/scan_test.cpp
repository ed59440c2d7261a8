// Cases as families: what is drawn, what a case says of its domain, which failures are known.
#include "experiments/exact/validation/scan.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "experiments/exact/cases/draw.hpp"
#include "tests/exact/measured_trajectory.hpp"
#include "tests/exact/random_parameters.hpp"

namespace brickbench::exact {
namespace {

constexpr std::size_t k_drawings = 40;
// One value in six is an end of its range: of so many drawings none misses it (chance 1e-8 each).
constexpr std::size_t k_drawings_with_ends = 100;
// Runs are played through here.
constexpr std::size_t k_played = 5;

std::string short_text(double value) { return fmt::format("{:.{}g}", value, k_drawn_digits); }

std::string described(const ExactCase& exact_case, const ParameterValues& given) {
  std::string text = exact_case.id;
  for (const auto& [name, value] : given) {
    text += fmt::format(" {}={}", name, std::get<double>(value));
  }
  return text;
}

TEST(Draw, DependsOnSeedCaseAndIndexAlone) {
  for (const ExactCase& exact_case : exact_cases()) {
    for (const std::size_t index : {0U, 7U}) {
      EXPECT_EQ(draw(exact_case, 5, index), draw(exact_case, 5, index)) << exact_case.id;
      EXPECT_NE(draw(exact_case, 5, index), draw(exact_case, 6, index)) << exact_case.id;
      EXPECT_NE(draw(exact_case, 5, index), draw(exact_case, 5, index + 1)) << exact_case.id;
    }
    // The high word of the seed counts, and so does the case.
    EXPECT_NE(draw(exact_case, 5, 0), draw(exact_case, 5 + (std::uint64_t{1} << 32), 0));
    ExactCase other = exact_case;
    other.id += 'x';
    EXPECT_NE(draw(exact_case, 5, 0), draw(other, 5, 0)) << exact_case.id;
  }
}

// Edges, decades, short numbers, bounded cost.
TEST(Draw, FillsTheRangesOfEveryParameter) {
  for (const ExactCase& exact_case : exact_cases()) {
    std::map<std::string, std::vector<double>> seen;
    for (std::size_t i = 0; i < k_drawings_with_ends; ++i) {
      const ParameterValues given = draw(exact_case, 3, i);
      const auto all = complete(exact_case, given);
      ASSERT_TRUE(all) << all.error().reason;
      for (const auto& [name, value] : given) {
        const double number = std::get<double>(value);
        seen[name].push_back(number);
        EXPECT_EQ(std::stod(short_text(number)), number) << exact_case.id << ' ' << name;
      }
      const double steps = value_of(*all, "duration_s") / value_of(*all, "step_s");
      const auto bodies = static_cast<double>(exact_case.make(*all).world.bodies.size());
      const bool longest_step = value_of(*all, "step_s") == 0.1;
      EXPECT_TRUE(longest_step || steps * bodies <= 1.02 * k_most_body_steps) << exact_case.id;
      EXPECT_GE(steps, 9.9) << exact_case.id;
    }
    for (const Parameter& parameter : exact_case.parameters) {
      if (parameter.name == "step_s" || parameter.name == "duration_s") continue;
      const std::vector<double>& values = seen[parameter.name];
      ASSERT_EQ(values.size(), k_drawings_with_ends) << exact_case.id << ' ' << parameter.name;
      EXPECT_EQ(std::ranges::min(values), parameter.minimum) << exact_case.id;
      EXPECT_EQ(std::ranges::max(values), parameter.maximum) << exact_case.id;
      if (parameter.minimum <= 0.0 || parameter.maximum < 1e3 * parameter.minimum) continue;
      // Over decades as many below the geometric mean as above, to four standard deviations.
      const double middle = std::sqrt(parameter.minimum * parameter.maximum);
      const auto below = std::ranges::count_if(values, [&](double v) { return v < middle; });
      EXPECT_NEAR(static_cast<double>(below), 0.5 * k_drawings_with_ends,
                  2.0 * std::sqrt(k_drawings_with_ends))
          << exact_case.id << ' ' << parameter.name;
    }
  }
}

TEST(Domain, HoldsTheDefaultsAndMostOfTheRanges) {
  for (const ExactCase& exact_case : exact_cases()) {
    const ParameterValues defaults = complete(exact_case).value();
    for (const Parameter& parameter : exact_case.parameters) {
      EXPECT_EQ(value_of(defaults, parameter.name), std::get<double>(parameter.default_value))
          << exact_case.id << ": the own time moves the default of " << parameter.name;
    }
    if (exact_case.outside != nullptr) {
      EXPECT_EQ(exact_case.outside(defaults), "") << exact_case.id;
    }
    EXPECT_EQ(drawings_of(exact_case, 1, k_drawings).inside.size(), k_drawings) << exact_case.id;
  }
}

TEST(Domain, IsRefusedOutsideWithItsReason) {
  int with_domain = 0;
  for (const ExactCase& exact_case : exact_cases()) {
    if (exact_case.outside == nullptr) continue;
    ++with_domain;
    for (std::size_t i = 0; i < k_drawings; ++i) {
      const ParameterValues given = draw(exact_case, 2, i);
      const std::string why = exact_case.outside(complete(exact_case, given).value());
      const auto run = build(exact_case, given);
      EXPECT_EQ(run.has_value(), why.empty()) << exact_case.id;
      if (run) continue;
      EXPECT_NE(run.error().reason.find(why), std::string::npos) << run.error().reason;
    }
  }
  EXPECT_GE(with_domain, 20);
}

// What a case measures happens within its run, wherever it is drawn: no truth is left unseen.
TEST(Domain, LetsEveryTruthBeSeen) {
  for (const ExactCase& exact_case : exact_cases()) {
    for (const ParameterValues& given : drawings_of(exact_case, 4, k_played).inside) {
      const ExactRun run = build(exact_case, given).value();
      if (!run.trajectory || exact_case.needs.contact_forces) continue;
      const auto values = testing::measured_trajectory(run, exact_case.observables.size());
      for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_EQ(std::isnan(values[i]), std::isnan(run.truths[i].value))
            << described(exact_case, given) << ": " << exact_case.observables[i].name;
      }
    }
  }
}

class Questions : public ::testing::Test {
 protected:
  Expected<std::vector<OpenQuestion>> read(const std::string& lines) {
    const auto file = std::filesystem::path(::testing::TempDir()) / "questions.csv";
    std::ofstream(file) << "engine,variant,case,where,date,gone_with,question\n" << lines;
    auto questions = read_open_questions(file);
    std::filesystem::remove(file);
    return questions;
  }
};

TEST_F(Questions, AreReadWithTheirRegion) {
  const auto questions = read(
      "e,v,a.b,,2026-01-02,k=3,why, and why not?\n"
      "e,w,a.b,any,2026-01-02,,everywhere\n"
      "e,w,a.b,x=1..2.5;y=-3e-2..inf,2026-01-02,,in a box\n");
  ASSERT_TRUE(questions) << questions.error().reason;
  ASSERT_EQ(questions->size(), 3u);
  EXPECT_EQ(questions->at(0).gone_with, "k=3");
  EXPECT_EQ(questions->at(0).question, "why, and why not?");
  EXPECT_TRUE(questions->at(0).region.at_defaults);
  EXPECT_FALSE(questions->at(1).region.at_defaults);
  ASSERT_EQ(questions->at(2).region.ranges.size(), 2u);
  EXPECT_EQ(questions->at(2).region.ranges[0].high, 2.5);
  EXPECT_EQ(questions->at(2).region.ranges[1].low, -0.03);
}

TEST_F(Questions, AreRefusedWithLineAndWhatIsWanted) {
  for (const char* wrong : {"e,v,a.b,,2026-01-02\n", "e,v,a.b,x=1,2026,,q\n",
                            "e,v,a.b,x=1..b,2026,,q\n", "e,v,a.b,some,2026,,q\n", "\n"}) {
    const auto questions = read(std::string("e,v,a.b,,2026-01-02,,fine\n") + wrong);
    ASSERT_FALSE(questions) << wrong;
    EXPECT_NE(questions.error().reason.find("questions.csv:3: "), std::string::npos);
  }
  EXPECT_FALSE(read_open_questions("no such file"));
}

TEST_F(Questions, HoldWithinTheirRegionAlone) {
  const ExactCase exact_case = testing::find_case("impact.corner");
  CellResult cell;
  cell.engine = "e";
  cell.variant = "v";
  cell.case_id = exact_case.id;
  const auto known = [&](const std::string& region, const ParameterValues& given) {
    const auto questions = read("e,v,impact.corner," + region + ",2026-01-02,,q\n").value();
    return question_of(questions, cell, exact_case, complete(exact_case, given).value()) != nullptr;
  };
  EXPECT_TRUE(known("", {}));
  EXPECT_FALSE(known("", {{"speed_mps", 3.0}}));
  EXPECT_TRUE(known("any", {{"speed_mps", 3.0}}));
  EXPECT_TRUE(known("speed_mps=2..3", {{"speed_mps", 3.0}}));
  EXPECT_FALSE(known("speed_mps=2..3", {{"speed_mps", 3.5}}));
  EXPECT_FALSE(known("speed_mps=2..3;restitution=0..0.1", {{"speed_mps", 3.0}}));
  EXPECT_FALSE(known("no_such_parameter=0..1", {}));
  cell.variant = "w";
  EXPECT_FALSE(known("any", {}));
}

TEST(Verdicts, TellKnownFailuresFromNewOnes) {
  const OpenQuestion question;
  CellResult cell;
  EXPECT_EQ(verdict_of(cell, nullptr), Verdict::open);
  cell.bound = 1e-6;
  cell.scores.push_back({});
  cell.scores[0].unexplained = 1e-7;
  EXPECT_EQ(verdict_of(cell, nullptr), Verdict::held);
  EXPECT_EQ(verdict_of(cell, &question), Verdict::held);
  for (const double beyond : {2e-6, std::nan(""), HUGE_VAL}) {
    cell.scores[0].unexplained = beyond;
    EXPECT_EQ(verdict_of(cell, nullptr), Verdict::failed) << beyond;
    EXPECT_EQ(verdict_of(cell, &question), Verdict::known) << beyond;
  }
  cell.outcome = "diverged";
  EXPECT_EQ(verdict_of(cell, nullptr), Verdict::failed);
  cell.outcome = "refused";
  EXPECT_EQ(verdict_of(cell, nullptr), Verdict::refused);
}

}  // namespace
}  // namespace brickbench::exact
