// What the user's terminal can do, and progress on it.
#pragma once

#include <chrono>
#include <string>

#include "reports/src/table.hpp"

namespace brickbench {

// Of standard output: its width (COLUMNS, else the terminal's, else 100) and colour only on a
// terminal and without NO_COLOR.
TerminalStyle standard_output_style();

// Columns of standard error, likewise.
std::size_t standard_error_width();

// "4.2 s", "3 min 5 s", "2 h 10 min"
std::string duration_text(double seconds);

// Progress on standard error: a bar with rate and time left on a terminal, one line per finished
// item elsewhere.
class Progress {
 public:
  explicit Progress(std::size_t count);

  void begin(const std::string& label);
  // Share of the current item that is done, 0..1.
  void update(double share);
  // The item is done; `line` says how it went. Of many items a line every few seconds is printed.
  void end(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  void draw(double share);
  double left_s(double done) const;

  std::size_t count_;
  std::size_t finished_ = 0;
  bool is_terminal_;
  std::size_t width_;
  std::string label_;
  Clock::time_point started_;
  Clock::time_point drawn_;
  Clock::time_point told_;
};

}  // namespace brickbench
