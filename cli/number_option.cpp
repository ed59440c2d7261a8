#include "cli/number_option.hpp"

#include <fmt/format.h>

#include <cmath>

#include "experiments/input/input.hpp"

namespace brickbench {
CLI::Option* add_number(CLI::App& verb, const std::string& name, double& value,
                        const std::string& meaning, Sign sign) {
  const auto read = [&value, name, sign](const std::string& text) {
    const auto number = number_or_quotient(text);
    const bool fits = number && std::isfinite(*number) &&
                      (sign == Sign::positive ? *number > 0.0 : *number >= 0.0);
    if (!fits) {
      throw CLI::ValidationError(
          name, fmt::format("must be {} number like 0.004 or 1/240, not '{}'",
                            sign == Sign::positive ? "a positive" : "a not negative", text));
    }
    value = *number;
  };
  return verb.add_option_function<std::string>(name, read, meaning)->type_name("NUMBER");
}

std::string set_value(const std::string& number) {
  return number.find('/') == std::string::npos ? number : '"' + number + '"';
}

}  // namespace brickbench
