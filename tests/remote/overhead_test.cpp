// What the way to an engine in another process costs, in CPU time of both sides: of an engine that
// does nothing, so all that is counted is the protocol.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <iostream>

#include "adapters/remote/link.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_bricks = 400;
// docs/protocol.md states what was measured; this is what was asked of it.
constexpr double k_allowed_s = 0.3e-3;

double cpu_s(int who) {
  rusage usage{};
  ::getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

World many_bricks() {
  World world;
  for (std::size_t i = 0; i < k_bricks; ++i) {
    State state;
    state.position_m.x() = static_cast<double>(i);
    world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 2000.0, state));
  }
  return world;
}

// Of both sides together, start and end of the program included.
double total_s(std::uint64_t steps, std::uint64_t at_a_time) {
  const double begun_s = cpu_s(RUSAGE_SELF) + cpu_s(RUSAGE_CHILDREN);
  {
    auto link = remote::Link::open(
        {.words = {BRICKBENCH_REMOTE_PROGRAM, "none"}, .folder = {}, .environment = {}});
    EXPECT_TRUE(link && link->build(many_bricks(), {.variant = "default", .knobs = {}}));
    std::vector<remote::StepRecord> records;
    for (std::uint64_t done = 0; done < steps; done += at_a_time) {
      EXPECT_TRUE(link->step(at_a_time, {}, records));
    }
  }
  return cpu_s(RUSAGE_SELF) + cpu_s(RUSAGE_CHILDREN) - begun_s;
}

double per_step_s(std::uint64_t at_a_time) {
  constexpr std::uint64_t few = 100, many = 2100;
  return (total_s(many, at_a_time) - total_s(few, at_a_time)) / static_cast<double>(many - few);
}

TEST(Overhead, OfAStepOfFourHundredBricksIsSmall) {
  const double one_by_one_s = per_step_s(1), ten_at_a_time_s = per_step_s(10);
  std::cout << fmt::format(
      "CPU time of both sides per step: {:.3g} ms one by one, {:.3g} ms ten at a "
      "time\n",
      1e3 * one_by_one_s, 1e3 * ten_at_a_time_s);
  EXPECT_LT(one_by_one_s, k_allowed_s);
  EXPECT_LT(ten_at_a_time_s, k_allowed_s);
}

}  // namespace
}  // namespace brickbench
