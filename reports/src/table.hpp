// Table: rows of text cells, for a terminal or for Markdown.
#pragma once

#include <string>
#include <vector>

namespace brickbench {

enum class Mark { plain, best, worst, failed, flagged };

struct TableCell {
  std::string text;
  Mark mark = Mark::plain;
};

struct Table {
  std::string title;                         // may be empty
  std::vector<std::string> header;           // the first column names the row
  std::vector<std::vector<TableCell>> rows;  // each as long as the header
};

struct TerminalStyle {
  std::size_t width =
      100;  // columns; a table that does not fit is split, repeating the first column
  bool colour = false;
};

// Columns aligned, numbers to the right; best green, worst yellow, failed red where there is
// colour. No line is wider than the terminal unless the first column and one other do not fit into
// it: then cells are cut, ending in "~".
std::string to_terminal(const Table& table, const TerminalStyle& style);

// Best in bold, worst in italics. `|` and line breaks within cells are escaped.
std::string to_markdown(const Table& table);

// Text of a cell of a Markdown table.
std::string markdown_cell(const std::string& text);

}  // namespace brickbench
