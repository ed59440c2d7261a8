#include "ourengine/parallel/worker_pool.hpp"

#include <algorithm>

namespace ourengine {
namespace {

constexpr std::uint64_t k_pieces_mask = 0xffffffffU;
// Looks before a thread goes to sleep: loops follow each other within microseconds. Every so many
// looks it lets others run: whom it waits for may have been put on the same processor.
constexpr int k_spins = 4000;
constexpr int k_spins_per_yield = 100;

void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

// Returns when the word is no longer `old`.
template <typename Word>
void await_change(std::atomic<Word>& word, Word old) {
  for (int i = 0; i < k_spins; ++i) {
    if (word.load(std::memory_order_acquire) != old) return;
    if (i % k_spins_per_yield == k_spins_per_yield - 1) std::this_thread::yield();
    relax();
  }
  word.wait(old, std::memory_order_acquire);
}

}  // namespace

WorkerPool::WorkerPool(int threads) {
  for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { serve(); });
}

WorkerPool::~WorkerPool() {
  stopping_.store(true, std::memory_order_release);
  ticket_.fetch_add(k_pieces_mask + 1, std::memory_order_acq_rel);
  ticket_.notify_all();
}

// Takes one piece of the current loop and does it; false if none is left.
bool WorkerPool::take_piece() {
  std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
  do {
    if ((ticket & k_pieces_mask) == 0) return false;
  } while (!ticket_.compare_exchange_weak(ticket, ticket - 1, std::memory_order_acq_rel,
                                          std::memory_order_acquire));
  // The loop cannot end, and its description cannot change, before this piece is finished.
  const std::size_t piece = static_cast<std::size_t>(ticket & k_pieces_mask) - 1;
  const std::size_t begin = piece * loop_.grain;
  loop_.call(loop_.data, begin, std::min(begin + loop_.grain, loop_.count));
  if (unfinished_.fetch_sub(1, std::memory_order_acq_rel) == 1) unfinished_.notify_all();
  return true;
}

void WorkerPool::run(const Loop& loop) {
  loop_ = loop;
  const auto pieces = static_cast<std::uint32_t>((loop.count + loop.grain - 1) / loop.grain);
  unfinished_.store(pieces, std::memory_order_relaxed);
  const std::uint64_t loops = ticket_.load(std::memory_order_relaxed) & ~k_pieces_mask;
  ticket_.store(loops + k_pieces_mask + 1 + pieces, std::memory_order_release);
  ticket_.notify_all();
  while (take_piece()) {
  }
  for (;;) {
    const std::uint32_t left = unfinished_.load(std::memory_order_acquire);
    if (left == 0) return;
    await_change(unfinished_, left);
  }
}

void WorkerPool::serve() {
  while (!stopping_.load(std::memory_order_acquire)) {
    const std::uint64_t seen = ticket_.load(std::memory_order_acquire);
    if (take_piece()) continue;
    if (!stopping_.load(std::memory_order_acquire) && (seen & k_pieces_mask) == 0) {
      await_change(ticket_, seen);
    }
  }
}

}  // namespace ourengine
