// A small fixed pool of threads for loops whose pieces do not depend on each other.
//
// Determinism is the caller's: each piece must write only what is its own and read nothing that
// another piece writes. Then the bits do not depend on the number of threads, because the pool
// never sums or orders anything.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <type_traits>
#include <vector>

namespace ourengine {

class WorkerPool {
 public:
  // threads >= 1, the caller's included: 1 starts none and runs every loop in place.
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  int threads() const { return static_cast<int>(workers_.size()) + 1; }

  // Calls work(begin, end) for pieces that cover 0 .. count once, each of `grain` or fewer; returns
  // when all are done. A loop of one piece runs in place. Work is noexcept, for nobody could catch
  // what it threw, and must not use the pool. Calls come from one thread at a time.
  template <typename Work>
  requires std::is_nothrow_invocable_v<Work&, std::size_t, std::size_t>
  void for_ranges(std::size_t count, std::size_t grain, Work&& work) {
    if (workers_.empty() || count <= grain) {
      if (count > 0) work(std::size_t{0}, count);
      return;
    }
    using Plain = std::remove_reference_t<Work>;
    run({[](void* data, std::size_t begin, std::size_t end) {
           (*static_cast<Plain*>(data))(begin, end);
         },
         const_cast<void*>(static_cast<const void*>(&work)), count, grain});
  }

 private:
  struct Loop {
    void (*call)(void* data, std::size_t begin, std::size_t end) = nullptr;
    void* data = nullptr;
    std::size_t count = 0;
    std::size_t grain = 1;
  };

  void run(const Loop& loop);
  void serve();
  bool take_piece();

  Loop loop_;
  // Loops so far (high half) and pieces of this loop that nobody has taken (low half): one word, so
  // that a thread that wakes late can never take a piece of the wrong loop.
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<std::uint32_t> unfinished_{0};
  std::atomic<bool> stopping_{false};
  std::vector<std::jthread> workers_;
};

}  // namespace ourengine
