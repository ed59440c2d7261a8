#include "experiments/exact/validation/open_questions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>

namespace brickbench::exact {
namespace {

constexpr std::string_view k_columns = "engine,variant,case,where,date,gone_with,question";
constexpr std::size_t k_fields_before_question = 6;

// Cuts `rest` at the first `mark`; all of it where there is none.
std::string_view cut(std::string_view& rest, std::string_view mark) {
  const std::size_t at = rest.find(mark);
  const std::string_view head = rest.substr(0, at);
  rest = at == std::string_view::npos ? std::string_view() : rest.substr(at + mark.size());
  return head;
}

bool read_number(std::string_view text, double& value) {
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  return read.ec == std::errc() && read.ptr == end;
}

std::optional<Region> read_region(std::string_view text) {
  Region region;
  region.at_defaults = text.empty();
  if (text.empty() || text == "any") return region;
  while (!text.empty()) {
    std::string_view term = cut(text, ";");
    ParameterRange range;
    range.parameter = cut(term, "=");
    const std::string_view low = cut(term, "..");
    if (!read_number(low, range.low) || !read_number(term, range.high)) return std::nullopt;
    region.ranges.push_back(std::move(range));
  }
  return region;
}

std::optional<OpenQuestion> read_line(std::string_view line) {
  if (std::ranges::count(line, ',') < static_cast<std::ptrdiff_t>(k_fields_before_question)) {
    return std::nullopt;
  }
  OpenQuestion question;
  question.engine = cut(line, ",");
  question.variant = cut(line, ",");
  question.case_id = cut(line, ",");
  const auto region = read_region(cut(line, ","));
  if (!region) return std::nullopt;
  question.region = *region;
  question.date = cut(line, ",");
  question.gone_with = cut(line, ",");
  question.question = line;
  return question;
}

bool holds(const Region& region, const ExactCase& exact_case, const ParameterValues& values) {
  if (region.at_defaults) return values == complete(exact_case).value();
  return std::ranges::all_of(region.ranges, [&](const ParameterRange& range) {
    const auto found = values.find(range.parameter);
    if (found == values.end()) return false;
    const double value = std::get<double>(found->second);
    return value >= range.low && value <= range.high;
  });
}

}  // namespace

Expected<std::vector<OpenQuestion>> read_open_questions(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line) || line != k_columns) {
    return fail(Fault::invalid, fmt::format("{}:1: wanted is a file with the columns {}",
                                            file.string(), k_columns));
  }
  std::vector<OpenQuestion> questions;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    const auto question = read_line(line);
    if (!question) {
      return fail(Fault::invalid, fmt::format("{}:{}: wanted is {}, where: empty, any, or "
                                              "name=low..high joined by ';'",
                                              file.string(), number, k_columns));
    }
    questions.push_back(*question);
  }
  return questions;
}

const OpenQuestion* question_of(const std::vector<OpenQuestion>& questions, const CellResult& cell,
                                const ExactCase& exact_case, const ParameterValues& values) {
  const auto found = std::ranges::find_if(questions, [&](const OpenQuestion& question) {
    return question.engine == cell.engine && question.variant == cell.variant &&
           question.case_id == cell.case_id && holds(question.region, exact_case, values);
  });
  return found == questions.end() ? nullptr : &*found;
}

}  // namespace brickbench::exact
