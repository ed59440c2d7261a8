// Formulas: what they mean, that no number loses a bit, and what they say to bad ones.
#include "experiments/scenes/formula.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstring>
#include <locale>
#include <numbers>
#include <random>

#include "experiments/record/schema.hpp"

namespace brickbench {
namespace {

const std::vector<std::string> k_names = {"a", "b_m", "n"};

double value(const std::string& text, const std::vector<double>& values = {2.0, 3.0, 7.0}) {
  const auto formula = Formula::parse(text, k_names);
  if (formula) return (*formula)(values);
  ADD_FAILURE() << text << ": " << formula.error().reason;
  return std::nan("");
}

FormulaError error(const std::string& text) {
  const auto formula = Formula::parse(text, k_names);
  if (!formula) return formula.error();
  ADD_FAILURE() << text << " was read";
  return {};
}

TEST(Formula, IsDoubleArithmeticInTheOrderWritten) {
  const double a = 0.1, b = 0.7, n = 1e16;
  const std::vector<double> values = {a, b, n};
  EXPECT_EQ(value("a + b_m + n", values), a + b + n);
  EXPECT_EQ(value("a + (b_m + n)", values), a + (b + n));
  EXPECT_EQ(value("a * b_m + a", values), a * b + a);
  EXPECT_EQ(value("a + a + a + a", values), a + a + a + a);
  EXPECT_EQ(value("3 * a - 2 * a", values), 3 * a - 2 * a);
  EXPECT_EQ(value("a / b_m / n", values), a / b / n);
  EXPECT_EQ(value("b_m ^ 2", values), std::pow(b, 2.0));
  EXPECT_EQ(value("-a ^ 2", values), -std::pow(a, 2.0));
  EXPECT_EQ(value("2 ^ 3 ^ 2"), 512.0);
  EXPECT_EQ(value("pi"), std::numbers::pi);
  EXPECT_EQ(value("1/240"), 1.0 / 240.0);
}

TEST(Formula, ComparesAndChooses) {
  EXPECT_EQ(value("a < b_m"), 1.0);
  EXPECT_EQ(value("a >= b_m"), 0.0);
  EXPECT_EQ(value("a == 2 && n != 3"), 1.0);
  EXPECT_EQ(value("a > 5 || n > 5"), 1.0);
  EXPECT_EQ(value("a > 5 ? 1 : n"), 7.0);
  EXPECT_EQ(value("mod(n, 2)"), 1.0);
  EXPECT_EQ(value("mod(-1, 4)"), 3.0);
  EXPECT_EQ(value("min(a, n) + max(a, n)"), 9.0);
  EXPECT_EQ(value("atan2(1, 0)"), std::atan2(1.0, 0.0));
  EXPECT_EQ(value("floor(2.5) + ceil(2.5) + round(2.6)"), 8.0);
}

// Twenty thousand doubles of every size, each in its shortest text.
TEST(Formula, ReadsNumbersToTheLastBit) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const auto bits = random();
    double number = 0.0;
    std::memcpy(&number, &bits, sizeof number);
    number = std::abs(number);
    if (!std::isfinite(number)) continue;
    ASSERT_EQ(value(shortest(number)), number) << shortest(number);
  }
}

TEST(Formula, DoesNotDependOnTheLocale) {
  class Comma : public std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  EXPECT_EQ(value("1234.5 + 0.25"), 1234.75);
  EXPECT_EQ(value("max(1.5, 2)"), 2.0);
  std::locale::global(before);
}

TEST(Formula, SaysWhatIsWrongAndWhere) {
  const FormulaError unknown = error("2 * (b_mm + 1)");
  EXPECT_NE(unknown.reason.find("did you mean 'b_m'"), std::string::npos) << unknown.reason;
  EXPECT_EQ(unknown.offset, 5u);
  EXPECT_NE(error("a = 3").reason.find("== compares"), std::string::npos);
  EXPECT_EQ(error("a = 3").offset, 2u);
  EXPECT_EQ(error("a $ 3").offset, 2u);
  EXPECT_NE(error("1, 2").reason.find("one number"), std::string::npos);
  EXPECT_NE(error("sin(a, n)").reason.find("sin"), std::string::npos);
  EXPECT_NE(error("\"text\"").reason.find("letters"), std::string::npos);
  for (const char* text : {"", " ", "(", "a +", "a a", "1..2", "sin", "sin()", "max(1)", "?",
                           "a ? 1", "1 : 2", ")", "a n", "2a", "()", ",", "a,"}) {
    EXPECT_FALSE(error(text).reason.empty()) << text;
  }
  EXPECT_FALSE(error(std::string(5000, '1')).reason.empty());
}

}  // namespace
}  // namespace brickbench
