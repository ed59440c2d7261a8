#include "experiments/record/schema.hpp"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>

namespace brickbench {
namespace {

template <typename Number>
Expected<Number> parse_whole(std::string_view text, std::string_view what) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) {
    return fail(Fault::invalid, fmt::format("'{}' is out of range for {}", text, what));
  }
  if (error != std::errc{} || end != text.data() + text.size()) {
    return fail(Fault::invalid, fmt::format("'{}' is not {}", text, what));
  }
  return value;
}

}  // namespace

std::string shortest(double value) {
  if (std::isnan(value)) return "";
  std::array<char, 32> text;
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

Expected<double> parse_number(std::string_view text) {
  auto value = parse_whole<double>(text, "a number");
  if (value && std::isnan(*value)) return fail(Fault::invalid, "NaN is not a number here");
  return value;
}

Expected<std::uint64_t> parse_count(std::string_view text) {
  return parse_whole<std::uint64_t>(text, "a count");
}

}  // namespace brickbench
