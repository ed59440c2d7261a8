// Progress of a sweep on standard error: a bar with rate and time left on a terminal, a line every
// now and then elsewhere; a line for every cell that failed on both.
#pragma once

#include <chrono>
#include <string>

namespace brickbench {

class SweepProgress {
 public:
  // `cells` in all, of which `found` were done before.
  void begin(std::size_t cells, std::size_t found);
  // Cells with a result by now, and how many of them failed.
  void update(std::size_t done, std::size_t failed, std::size_t running);
  // A line of its own.
  void say(const std::string& line);
  // The last state, with the line closed.
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  std::string state() const;
  void draw();

  std::size_t cells_ = 0;
  std::size_t found_ = 0;
  std::size_t done_ = 0;
  std::size_t failed_ = 0;
  std::size_t running_ = 0;
  bool is_terminal_ = false;
  std::size_t width_ = 100;
  Clock::time_point started_;
  Clock::time_point drawn_;
};

}  // namespace brickbench
