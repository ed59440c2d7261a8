#include "reports/src/table.hpp"

#include <algorithm>
#include <numeric>

namespace brickbench {
namespace {

constexpr std::size_t k_gap = 2;

// Code points of UTF-8 text: all that our tables hold are one column wide each.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string cut(const std::string& text, std::size_t width) {
  if (width_of(text) <= width) return text;
  std::string result;
  for (std::size_t i = 0, columns = 0; i < text.size(); ++i) {
    const bool starts = (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U;
    if (starts && ++columns >= width) break;
    result += text[i];
  }
  return result + '~';
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width - std::min(width, width_of(text)), ' ');
  return right ? space + text : text + space;
}

std::string_view colour_code(Mark mark) {
  switch (mark) {
    case Mark::plain:
      return "";
    case Mark::best:
      return "\033[32m";
    case Mark::worst:
      return "\033[33m";
    case Mark::failed:
      return "\033[31m";
    case Mark::flagged:
      return "\033[35m";
  }
  return "";
}

std::vector<std::size_t> column_widths(const Table& table) {
  std::vector<std::size_t> widths;
  for (const std::string& name : table.header) widths.push_back(width_of(name));
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], width_of(row[i].text));
    }
  }
  return widths;
}

// Columns 0 and first..last-1 of the table.
void print_block(const Table& table, const std::vector<std::size_t>& widths, std::size_t first,
                 std::size_t last, bool colour, std::string& out) {
  const auto line = [&](const auto& text_of, const auto& mark_of) {
    std::string text = padded(cut(text_of(0), widths[0]), widths[0], false);
    for (std::size_t i = first; i < last; ++i) {
      const std::string_view code = colour ? colour_code(mark_of(i)) : "";
      text += std::string(k_gap, ' ');
      text += code;
      text += padded(cut(text_of(i), widths[i]), widths[i], true);
      if (!code.empty()) text += "\033[0m";
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + '\n';
  };
  line([&](std::size_t i) { return table.header[i]; }, [](std::size_t) { return Mark::plain; });
  for (const auto& row : table.rows) {
    line([&](std::size_t i) { return row[i].text; }, [&](std::size_t i) { return row[i].mark; });
  }
}

}  // namespace

std::string to_terminal(const Table& table, const TerminalStyle& style) {
  std::string out;
  if (!table.title.empty()) out += cut(table.title, style.width) + '\n';
  std::vector<std::size_t> widths = column_widths(table);
  const std::size_t room = std::max<std::size_t>(style.width, 16);
  widths[0] = std::min(widths[0], room / 2);
  for (std::size_t i = 1; i < widths.size(); ++i) {
    widths[i] = std::min(widths[i], room - widths[0] - k_gap);
  }
  std::size_t first = 1;
  do {
    std::size_t used = widths[0];
    std::size_t last = first;
    while (last < widths.size() && used + k_gap + widths[last] <= room) {
      used += k_gap + widths[last++];
    }
    if (first > 1) out += '\n';
    print_block(table, widths, first, last, style.colour, out);
    first = last;
  } while (first < widths.size());
  return out;
}

std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|')
      out += "\\|";
    else if (c == '\n')
      out += "<br>";
    else
      out += c;
  }
  return out;
}

std::string to_markdown(const Table& table) {
  std::string out;
  if (!table.title.empty()) out += "**" + table.title + "**\n\n";
  std::string rule;
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    out += "| " + markdown_cell(table.header[i]) + ' ';
    rule += i == 0 ? "|---" : "|---:";
  }
  out += "|\n" + rule + "|\n";
  for (const auto& row : table.rows) {
    for (const TableCell& cell : row) {
      const std::string text = markdown_cell(cell.text);
      const std::string_view around = cell.mark == Mark::best    ? "**"
                                      : cell.mark == Mark::worst ? "_"
                                                                 : "";
      out += "| ";
      out += around;
      out += text;
      out += around;
      out += ' ';
    }
    out += "|\n";
  }
  return out;
}

}  // namespace brickbench
