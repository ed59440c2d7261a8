#include "experiments/scenes/formula.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/scenarios/nearest_name.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_longest_formula = 2000;
constexpr std::string_view k_formula_signs = "_.+-*/^()<>=!&|?:, \t";

using Function1 = double (*)(double);
using Function2 = double (*)(double, double);

struct NamedFunction1 {
  const char* name;
  Function1 function;
};
struct NamedFunction2 {
  const char* name;
  Function2 function;
};

double remainder_of(double a, double b) { return a - b * std::floor(a / b); }
double smaller_of(double a, double b) { return std::fmin(a, b); }
double larger_of(double a, double b) { return std::fmax(a, b); }

constexpr NamedFunction1 k_functions_1[] = {{"abs", [](double x) { return std::abs(x); }},
                                            {"sqrt", [](double x) { return std::sqrt(x); }},
                                            {"cbrt", [](double x) { return std::cbrt(x); }},
                                            {"exp", [](double x) { return std::exp(x); }},
                                            {"log", [](double x) { return std::log(x); }},
                                            {"sin", [](double x) { return std::sin(x); }},
                                            {"cos", [](double x) { return std::cos(x); }},
                                            {"tan", [](double x) { return std::tan(x); }},
                                            {"asin", [](double x) { return std::asin(x); }},
                                            {"acos", [](double x) { return std::acos(x); }},
                                            {"atan", [](double x) { return std::atan(x); }},
                                            {"floor", [](double x) { return std::floor(x); }},
                                            {"ceil", [](double x) { return std::ceil(x); }},
                                            {"round", [](double x) { return std::round(x); }}};
constexpr NamedFunction2 k_functions_2[] = {
    {"atan2", [](double y, double x) { return std::atan2(y, x); }},
    {"mod", remainder_of},
    {"min", smaller_of},
    {"max", larger_of}};

// What muParser would take for something else than a formula over our names: assignments, strings,
// and signs of its own.
tl::expected<void, FormulaError> check_signs(const std::string& text) {
  const auto wrong = [](std::size_t offset, std::string reason) {
    return tl::unexpected<FormulaError>({std::move(reason), offset});
  };
  if (text.size() > k_longest_formula) {
    return wrong(0, fmt::format("a formula has at most {} characters, not {}", k_longest_formula,
                                text.size()));
  }
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!letter && k_formula_signs.find(c) == std::string_view::npos) {
      return wrong(i,
                   "a formula has letters, digits, _ and + - * / ^ ( ) < > = ! & | ? : , . alone");
    }
    const auto is = [&](std::size_t at, std::string_view any) {
      return at < text.size() && any.find(text[at]) != std::string_view::npos;
    };
    if (c != '=' || is(i + 1, "=") || (i > 0 && is(i - 1, "=<>!"))) continue;
    return wrong(i, "a formula sets nothing; == compares");
  }
  return {};
}

std::string reason_of(const mu::ParserError& error, std::span<const std::string> names) {
  switch (error.GetCode()) {
    case mu::ecUNASSIGNABLE_TOKEN: {
      std::vector<std::string> known(names.begin(), names.end());
      known.insert(known.end(), formula_words().begin(), formula_words().end());
      return fmt::format("a formula knows no '{}'; did you mean '{}'? Known: {}", error.GetToken(),
                         nearest_name(error.GetToken(), known), fmt::join(known, ", "));
    }
    case mu::ecUNEXPECTED_EOF:
      return "the formula ends where more must follow";
    case mu::ecMISSING_PARENS:
      return "a bracket of the formula is not closed";
    case mu::ecTOO_MANY_PARAMS:
    case mu::ecTOO_FEW_PARAMS:
      return fmt::format("the formula gives the function {} another number of values than it takes",
                         error.GetToken());
    default:
      return error.GetToken().empty()
                 ? std::string("is no formula")
                 : fmt::format("the formula cannot go on with '{}' here", error.GetToken());
  }
}

void teach(mu::Parser& parser) {
  parser.EnableOptimizer(false);
  parser.ClearFun();
  parser.ClearConst();
  parser.ClearPostfixOprt();
  parser.DefineConst("pi", std::numbers::pi);
  for (const NamedFunction1& known : k_functions_1) parser.DefineFun(known.name, known.function);
  for (const NamedFunction2& known : k_functions_2) parser.DefineFun(known.name, known.function);
}

}  // namespace

struct Formula::Compiled {
  mu::Parser parser;
  std::vector<double> values;
};

Formula::Formula(std::unique_ptr<Compiled> compiled) : compiled_(std::move(compiled)) {}
Formula::Formula(Formula&&) noexcept = default;
Formula& Formula::operator=(Formula&&) noexcept = default;
Formula::~Formula() = default;

tl::expected<Formula, FormulaError> Formula::parse(const std::string& text,
                                                   std::span<const std::string> names) {
  if (auto signs = check_signs(text); !signs) return tl::unexpected(signs.error());
  auto compiled = std::make_unique<Compiled>();
  compiled->values.assign(names.size(), 0.0);
  try {
    teach(compiled->parser);
    for (std::size_t i = 0; i < names.size(); ++i) {
      compiled->parser.DefineVar(names[i], &compiled->values[i]);
    }
    compiled->parser.SetExpr(text);
    compiled->parser.Eval();
    if (compiled->parser.GetNumResults() != 1) {
      return tl::unexpected<FormulaError>({"a formula gives one number, not several", 0});
    }
  } catch (const mu::ParserError& error) {
    return tl::unexpected<FormulaError>(
        {reason_of(error, names), std::min<std::size_t>(error.GetPos(), text.size())});
  }
  return Formula(std::move(compiled));
}

double Formula::operator()(std::span<const double> values) const {
  std::ranges::copy(values.first(compiled_->values.size()), compiled_->values.begin());
  return compiled_->parser.Eval();
}

const std::vector<std::string>& formula_words() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> all = {"pi"};
    for (const NamedFunction1& known : k_functions_1) all.emplace_back(known.name);
    for (const NamedFunction2& known : k_functions_2) all.emplace_back(known.name);
    return all;
  }();
  return words;
}

}  // namespace brickbench
