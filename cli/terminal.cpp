#include "cli/terminal.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <charconv>
#include <cstdlib>
#include <string_view>

namespace brickbench {
namespace {

constexpr std::size_t k_width_without_terminal = 100;
constexpr std::size_t k_bar_width = 24;
constexpr std::chrono::milliseconds k_redraw_period{100};
// More items than this do not get a line each, but one per period.
constexpr std::size_t k_few_items = 40;
constexpr std::chrono::seconds k_line_period{2};

std::size_t width_of(int descriptor) {
  if (const char* text = std::getenv("COLUMNS")) {
    const std::string_view view = text;
    std::size_t columns = 0;
    std::from_chars(view.data(), view.data() + view.size(), columns);
    if (columns > 0) return columns;
  }
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return k_width_without_terminal;
}

}  // namespace

TerminalStyle standard_output_style() {
  const bool colour = ::isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
  return {.width = width_of(STDOUT_FILENO), .colour = colour};
}

std::size_t standard_error_width() { return width_of(STDERR_FILENO); }

std::string duration_text(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.1f} s", seconds);
  const long whole = static_cast<long>(seconds + 0.5);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

Progress::Progress(std::size_t count)
    : count_(count),
      is_terminal_(::isatty(STDERR_FILENO) == 1),
      width_(width_of(STDERR_FILENO)),
      started_(Clock::now()) {}

void Progress::begin(const std::string& label) {
  label_ = label;
  draw(0.0);
}

void Progress::update(double share) {
  if (is_terminal_ && Clock::now() - drawn_ >= k_redraw_period) draw(share);
}

void Progress::end(const std::string& line) {
  ++finished_;
  const bool last = finished_ == count_;
  if (count_ > k_few_items && !last && Clock::now() - told_ < k_line_period) return;
  told_ = Clock::now();
  const double done = static_cast<double>(finished_);
  const std::string left =
      finished_ < count_ ? fmt::format(", {} left", duration_text(left_s(done))) : "";
  if (is_terminal_) fmt::print(stderr, "\r\033[K");
  fmt::print(stderr, "[{}/{}] {}{}\n", finished_, count_, line, is_terminal_ ? "" : left);
}

double Progress::left_s(double done) const {
  const std::chrono::duration<double> elapsed = Clock::now() - started_;
  return done > 0.0 ? elapsed.count() / done * (static_cast<double>(count_) - done) : 0.0;
}

void Progress::draw(double share) {
  if (!is_terminal_) return;
  drawn_ = Clock::now();
  const double done = static_cast<double>(finished_) + share;
  const double of_all = done / static_cast<double>(count_);
  const auto filled = static_cast<std::size_t>(of_all * static_cast<double>(k_bar_width));
  const std::chrono::duration<double> elapsed = drawn_ - started_;
  const double per_minute = elapsed.count() > 0.0 ? 60.0 * done / elapsed.count() : 0.0;
  std::string line =
      fmt::format("[{}{}] {}/{} {:.1f} cells/min, {} left: {}", std::string(filled, '#'),
                  std::string(k_bar_width - filled, ' '), finished_, count_, per_minute,
                  done > 0.0 ? duration_text(left_s(done)) : "?", label_);
  line.resize(std::min(line.size(), width_ - 1));
  fmt::print(stderr, "\r{}\033[K", line);
  std::fflush(stderr);
}

}  // namespace brickbench
