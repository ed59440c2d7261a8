// Sweeps while the wall clock jumps: by a year, forwards or backwards, at every single reading.
//
// The functions below stand in for those of the C library, for this program and for the libraries
// that it is linked with; only CLOCK_REALTIME jumps.
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <ctime>

#include "tests/support/sweep_folder.hpp"

namespace {

constexpr std::time_t k_jump_s = 365 * 24 * 3600;

std::atomic<bool> jumps{false};
std::atomic<int> readings{0};

// Backwards by a year from one reading to the next, then forwards again.
std::time_t jump_s() {
  if (!jumps) return 0;
  return ++readings % 2 == 0 ? k_jump_s : -k_jump_s;
}

int real_clock(clockid_t clock, timespec* now) {
  return static_cast<int>(::syscall(SYS_clock_gettime, clock, now));
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const int result = real_clock(clock, now);
  if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) now->tv_sec += jump_s();
  return result;
}

int gettimeofday(timeval* now, void*) noexcept {
  timespec exact{};
  const int result = real_clock(CLOCK_REALTIME, &exact);
  *now = {.tv_sec = exact.tv_sec + jump_s(), .tv_usec = exact.tv_nsec / 1000};
  return result;
}

std::time_t time(std::time_t* now) noexcept {
  timespec exact{};
  (void)real_clock(CLOCK_REALTIME, &exact);
  const std::time_t result = exact.tv_sec + jump_s();
  if (now != nullptr) *now = result;
  return result;
}

}  // extern "C"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

class ClockJumps : public TemporaryFolder {
 protected:
  void TearDown() override {
    jumps = false;
    TemporaryFolder::TearDown();
  }
};

// Shows that the clock of this program does jump: without that, the rest shows nothing.
TEST_F(ClockJumps, ReachThisProgram) {
  jumps = true;
  const auto first = std::chrono::system_clock::now();
  const auto second = std::chrono::system_clock::now();
  const auto third = std::chrono::system_clock::now();
  EXPECT_GT(std::chrono::abs(second - first), std::chrono::hours(24 * 700));
  EXPECT_GT(std::chrono::abs(third - second), std::chrono::hours(24 * 700));
  EXPECT_LT(std::chrono::abs(third - first), std::chrono::hours(1));
}

TEST_F(ClockJumps, NeitherEndACellNorKeepOneNorChangeARow) {
  const SweepOfFakes fakes(
      fall_plan(R"(["slow", "hang", "good"])", "seeds = 3\nperturb = { position_m = 0.1 }\n"));
  // Long enough for the cells that end, on a machine that is busy with other things too.
  const SweepOptions options = {.jobs = 4, .limits = {.wall_s = 2.0}};
  ASSERT_TRUE(fakes.run(folder_ / "undisturbed", options).has_value());
  const std::string expected = merged(folder_ / "undisturbed");

  jumps = true;
  const auto start = std::chrono::steady_clock::now();
  const auto summary = fakes.run(folder_ / "s", options);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  ASSERT_TRUE(summary.has_value()) << summary.error().reason;
  EXPECT_EQ(summary->missing(), 0U);
  EXPECT_LT(took.count(), 30.0) << "s; three cells hang, each has two seconds";
  EXPECT_EQ(merged(folder_ / "s"), expected);
}

// Nor do the dates of files: results from the future or from long ago are results.
TEST_F(ClockJumps, DatesOfFilesMeanNothing) {
  const SweepOfFakes fakes(fall_plan(R"(["good"])", "seeds = 6\nperturb = { position_m = 0.1 }\n"));
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  const std::string expected = merged(folder_ / "s");
  int sign = 1;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "s")) {
    fs::last_write_time(entry, fs::file_time_type::clock::now() +
                                   (sign = -sign) * std::chrono::hours(24 * 365 * 20));
  }
  const auto again = fakes.run(folder_ / "s");
  ASSERT_TRUE(again.has_value()) << again.error().reason;
  EXPECT_EQ(again->found, fakes.cells.size());
  EXPECT_EQ(again->ran, 0U);
  EXPECT_EQ(merged(folder_ / "s"), expected);
}

}  // namespace
}  // namespace brickbench::testing
