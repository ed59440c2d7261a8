// Isolation: work in a process of its own, with limits, whose end by whatever means is a value.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "adapters/seam/failure.hpp"

namespace brickbench {

struct Limits {
  double wall_s = 3600.0;       // 0: none
  std::uint64_t memory_mb = 0;  // address space beyond what the program has at the start; 0: none
};

// How the process ended.
struct Ended {
  bool answered = false;      // the work came to its end
  std::string answer;         // what it returned, cut to 4000 bytes
  Failure failure;            // otherwise: crashed or timed out, with the signal or exit status
  bool from_outside = false;  // by a signal that neither we nor a faulty engine send
  double share = 0.0;         // of the work that was done, as its callback last said
  std::string output;         // standard output and error: the first and the last 64 KiB
  double wall_s = 0.0;
};

// A running process. The parent must have one thread only when it starts one.
class Isolated {
 public:
  // Tells how much of the work is done, 0..1; true: go on.
  using Progress = std::function<bool(double share)>;
  using Work = std::function<std::string(const Progress&)>;

  // Runs `work` in a copy of this process: signals at their defaults, nothing to read on standard
  // input, no core file. It dies when its parent does. Fault::crashed if the system refuses.
  static Expected<Isolated> start(const Work& work, const Limits& limits);
  Isolated(Isolated&& other) noexcept;
  Isolated& operator=(Isolated&& other) noexcept;
  // Kills the process if it still runs.
  ~Isolated();

  // To be polled for output; -1 once there will be no more.
  int output_descriptor() const { return at_end_ ? -1 : output_; }
  int pid() const { return pid_; }
  // Takes what has been printed, without waiting.
  void drain();
  // Kills the process if its wall-clock limit has passed.
  void check_limit();
  void kill();
  // Whether the process has ended; if so `ended` says how.
  bool has_ended(Ended& ended);
  // Waits for the end, with the limits.
  Ended wait();

 private:
  struct Slot;
  using Clock = std::chrono::steady_clock;
  Isolated() = default;
  void release();
  Ended describe(int status);

  int pid_ = -1;
  int output_ = -1;
  Slot* slot_ = nullptr;
  Limits limits_;
  bool timed_out_ = false;
  bool killed_ = false;
  bool at_end_ = false;  // of the output
  Clock::time_point started_;
  std::string head_;
  std::string tail_;
  std::uint64_t dropped_bytes_ = 0;
};

// How many threads this process has.
std::size_t thread_count();

}  // namespace brickbench
