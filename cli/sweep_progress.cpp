#include "cli/sweep_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "cli/terminal.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_bar_width = 24;
constexpr std::chrono::milliseconds k_redraw_period{100};
constexpr std::chrono::seconds k_line_period{10};

}  // namespace

void SweepProgress::begin(std::size_t cells, std::size_t found) {
  cells_ = cells;
  found_ = found;
  done_ = found;
  is_terminal_ = ::isatty(STDERR_FILENO) == 1;
  width_ = standard_error_width();
  started_ = Clock::now();
  drawn_ = started_;
  if (found > 0) say(fmt::format("{} of {} cells are done already", found, cells));
}

void SweepProgress::update(std::size_t done, std::size_t failed, std::size_t running) {
  done_ = done;
  failed_ = failed;
  running_ = running;
  const auto age = Clock::now() - drawn_;
  if (is_terminal_ ? age >= k_redraw_period : age >= k_line_period) draw();
}

void SweepProgress::say(const std::string& line) {
  fmt::print(stderr, "{}{}\n", is_terminal_ ? "\r\033[K" : "", line);
}

void SweepProgress::end() {
  draw();
  if (is_terminal_) fmt::print(stderr, "\n");
}

std::string SweepProgress::state() const {
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - started_).count();
  const auto ran = static_cast<double>(done_ - std::min(found_, done_));
  const double rate_per_s = elapsed_s > 0.0 ? ran / elapsed_s : 0.0;
  const std::size_t left = cells_ - done_;
  const std::string time_left =
      left == 0
          ? "done"
          : (ran > 0.0 ? duration_text(static_cast<double>(left) / rate_per_s) : "?") + " left";
  const std::string failures = failed_ == 0 ? "" : fmt::format(", {} failed", failed_);
  return fmt::format("{}/{} {:.1f} cells/s, {} running{}, {}", done_, cells_, rate_per_s, running_,
                     failures, time_left);
}

void SweepProgress::draw() {
  drawn_ = Clock::now();
  if (!is_terminal_) {
    fmt::print(stderr, "{}\n", state());
    return;
  }
  const std::size_t filled = cells_ == 0 ? k_bar_width : k_bar_width * done_ / cells_;
  std::string line = fmt::format("[{}{}] {}", std::string(filled, '#'),
                                 std::string(k_bar_width - filled, ' '), state());
  line.resize(std::min(line.size(), width_ - 1));
  fmt::print(stderr, "\r{}\033[K", line);
  std::fflush(stderr);
}

}  // namespace brickbench
