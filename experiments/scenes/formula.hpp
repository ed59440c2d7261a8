// Formula: an expression over named numbers, as scene files say them.
//
// Numbers, names, + - * / ^, comparisons, && and ||, a ? b : c, brackets, the constant pi and the
// functions of formula_functions(). Numbers are read as written, whatever the locale; every
// operation is that of IEEE doubles in the order written, nothing is simplified.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace brickbench {

struct FormulaError {
  std::string reason;
  std::size_t offset = 0;  // of what is wrong, in bytes from the start of the formula
};

class Formula {
 public:
  // `names` (letters, digits, '_', no digit first; none of formula_words()): what it may speak of.
  static tl::expected<Formula, FormulaError> parse(const std::string& text,
                                                   std::span<const std::string> names);
  Formula(Formula&&) noexcept;
  Formula& operator=(Formula&&) noexcept;
  ~Formula();

  // The value with `values` (names, in their order; more may follow). May be infinite or NaN.
  double operator()(std::span<const double> values) const;

 private:
  struct Compiled;
  explicit Formula(std::unique_ptr<Compiled> compiled);
  std::unique_ptr<Compiled> compiled_;
};

// What a formula knows by itself and no other name may be: its functions and constants.
const std::vector<std::string>& formula_words();

}  // namespace brickbench
