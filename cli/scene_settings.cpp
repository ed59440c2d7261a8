#include "cli/scene_settings.hpp"

#include <fmt/format.h>

#include "experiments/record/schema.hpp"

namespace brickbench {

Expected<ParameterValues> scene_settings(const std::vector<std::string>& settings) {
  ParameterValues values;
  for (const std::string& text : settings) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      return fail(Fault::invalid, fmt::format("--set {}: it needs key=value", text));
    }
    const std::string value = text.substr(equals + 1);
    const auto number = parse_number(value);
    const bool truth = value == "true" || value == "false";
    values[text.substr(0, equals)] = number  ? ParameterValue(*number)
                                     : truth ? ParameterValue(value == "true" ? 1.0 : 0.0)
                                             : ParameterValue(value);
  }
  return values;
}

}  // namespace brickbench
