// EngineProcess: a program that is asked over its standard input and answers on its standard
// output. Whatever becomes of it, a question ends with an answer or a reason, in bounded time and
// memory.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/remote/frame.hpp"
#include "adapters/seam/failure.hpp"

namespace brickbench::remote {

// How a program is started.
struct Command {
  std::vector<std::string> words;  // program and arguments; a program without '/' is looked for
                                   // in PATH, one with '/' from the folder below
  std::string folder;              // in which it runs; empty: the current one
  std::vector<std::string> environment;  // NAME=value, beside the environment of this process
  double deadline_s = 60.0;              // wall-clock time for one answer
  std::uint64_t memory_mb = 4096;        // resident memory; 0: no limit
};

// A question, and what is allowed as its answer.
struct Question {
  Tag tag = Tag::hello;
  std::string_view payload;
  Tag answer = Tag::hello;
  std::uint64_t most_bytes = 0;  // of the answer; more is refused before any is stored
};

class EngineProcess {
 public:
  // Fault::crashed where the program cannot be started.
  static Expected<std::unique_ptr<EngineProcess>> start(const Command& command);
  EngineProcess(const EngineProcess&) = delete;
  EngineProcess& operator=(const EngineProcess&) = delete;
  // Closes the program's standard input, waits a moment for its end, kills what is left of it.
  ~EngineProcess();

  // The first line, at most 1000 bytes, of a program that is asked nothing. Fails as ask() does.
  Expected<std::string> first_line();

  // The payload of the answer. Fails with what the engine said of itself in a frame `failed`; with
  // Fault::crashed where it died or did not keep to the protocol, timed_out and out_of_memory
  // beyond the limits of its command: then it is killed, and the last words of its standard error
  // end the reason. After such a failure every question fails in the same way.
  Expected<std::string> ask(const Question& question);

 private:
  using Clock = std::chrono::steady_clock;
  explicit EngineProcess(const Command& command) : command_(command) {}
  Expected<void> launch();
  Expected<void> exchange(const Question& question, Header& header, std::string& payload);
  // Sends and receives what is possible now; whether the answer is whole.
  Expected<bool> move(std::string_view& unsent, const Question& question,
                      std::optional<Header>& header, std::string& received);
  Expected<void> wait_for_engine(bool unsent, Clock::time_point deadline, const Question& question);
  Expected<void> take_header(const Question& question, std::optional<Header>& header,
                             std::string& received) const;
  void drain_errors();
  bool has_ended();
  void end();
  tl::unexpected<Failure> died();
  tl::unexpected<Failure> broken(Fault fault, std::string reason);

  Command command_;
  int pid_ = -1;
  int channel_ = -1;  // the program's standard input and output
  int errors_ = -1;   // its standard error
  int status_ = 0;
  Clock::time_point look_;  // when memory is looked at next
  std::string said_;        // the last of its standard error
  std::optional<Failure> failure_;
};

}  // namespace brickbench::remote
