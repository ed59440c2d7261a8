// Every piece once, on any number of threads, loop after loop; and no task that could throw.
#include "ourengine/parallel/worker_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <set>
#include <thread>

namespace ourengine {
namespace {

template <typename Work>
constexpr bool k_takes = requires(WorkerPool& pool, Work& work) {
  pool.for_ranges(1, 1, work);
};

TEST(WorkerPool, RefusesTasksThatMayThrow) {
  const auto quiet = [](std::size_t, std::size_t) noexcept {};
  const auto loud = [](std::size_t, std::size_t) {};
  static_assert(k_takes<decltype(quiet)>);
  static_assert(!k_takes<decltype(loud)>);
}

TEST(WorkerPool, CoversEachIndexOnceInPiecesOfAtMostTheGrain) {
  for (const int threads : {1, 2, 3, 5}) {
    WorkerPool pool(threads);
    ASSERT_EQ(pool.threads(), threads);
    for (const std::size_t count : {0U, 1U, 2U, 7U, 64U, 1000U}) {
      for (const std::size_t grain : {1U, 2U, 7U, 64U, 5000U}) {
        std::vector<std::atomic<int>> seen(count);
        std::atomic<bool> too_long{false};
        pool.for_ranges(count, grain, [&](std::size_t begin, std::size_t end) noexcept {
          if (threads > 1 && end - begin > grain) too_long = true;
          for (std::size_t i = begin; i < end; ++i) ++seen[i];
        });
        EXPECT_FALSE(too_long) << threads << ' ' << count << ' ' << grain;
        for (const auto& times : seen)
          ASSERT_EQ(times, 1) << threads << ' ' << count << ' ' << grain;
      }
    }
  }
}

// A thread that wakes late must not take a piece of the next loop with the description of the last.
TEST(WorkerPool, ShortLoopsThatFollowEachOtherDoNotMix) {
  WorkerPool pool(3);
  std::vector<std::size_t> sums(6);
  for (std::size_t loop = 1; loop <= 20000; ++loop) {
    pool.for_ranges(sums.size(), 1, [&](std::size_t begin, std::size_t end) noexcept {
      for (std::size_t i = begin; i < end; ++i) sums[i] += loop;
    });
  }
  for (const std::size_t sum : sums) EXPECT_EQ(sum, 20000U * 20001U / 2U);
}

TEST(WorkerPool, OneThreadRunsInPlace) {
  WorkerPool pool(1);
  std::set<std::thread::id> ran;
  pool.for_ranges(
      100, 3, [&](std::size_t, std::size_t) noexcept { ran.insert(std::this_thread::get_id()); });
  EXPECT_EQ(ran, std::set<std::thread::id>{std::this_thread::get_id()});
}

}  // namespace
}  // namespace ourengine
