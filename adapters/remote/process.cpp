#include "adapters/remote/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "adapters/remote/codec.hpp"
#include "adapters/remote/launch.hpp"

namespace brickbench::remote {
namespace {

constexpr std::size_t k_kept_bytes = 65536;   // of standard error
constexpr std::size_t k_quoted_bytes = 1000;  // of it in a reason
constexpr std::uint64_t k_failed_bytes = 1U << 16U;
constexpr int k_look_ms = 50;       // how often memory is looked at
constexpr int k_farewell_ms = 500;  // for a program to end by itself
constexpr std::size_t k_chunk_bytes = 1U << 20U;

std::uint64_t resident_mb(int pid) {
  std::uint64_t all = 0, resident = 0;
  std::ifstream(fmt::format("/proc/{}/statm", pid)) >> all >> resident;
  return (resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE))) >> 20U;
}

std::string end_text(int status) {
  if (!WIFSIGNALED(status)) {
    return fmt::format("the engine ended itself with exit status {}", WEXITSTATUS(status));
  }
  const int signal = WTERMSIG(status);
  const char* name = ::sigabbrev_np(signal);
  return fmt::format("the engine died of signal SIG{}", name == nullptr ? "?" : name);
}

bool would_block() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

Expected<std::unique_ptr<EngineProcess>> EngineProcess::start(const Command& command) {
  std::unique_ptr<EngineProcess> process(new EngineProcess(command));
  if (auto launched = process->launch(); !launched) return tl::unexpected(launched.error());
  return process;
}

Expected<void> EngineProcess::launch() {
  const auto child = start_program(command_.words, command_.folder, command_.environment);
  if (!child) return tl::unexpected(child.error());
  pid_ = child->pid;
  channel_ = child->channel;
  errors_ = child->errors;
  return {};
}

EngineProcess::~EngineProcess() { end(); }

Expected<std::string> EngineProcess::ask(const Question& question) {
  if (failure_) return tl::unexpected(*failure_);
  char unasked = 0;
  if (::recv(channel_, &unasked, 1, MSG_DONTWAIT | MSG_PEEK) > 0) {
    return broken(Fault::crashed, fmt::format("before '{}' was asked the engine had sent more than "
                                              "its answers",
                                              to_word(question.tag)));
  }
  Header header;
  std::string payload;
  if (auto done = exchange(question, header, payload); !done) return tl::unexpected(done.error());
  if (header.tag != Tag::failed) return payload;
  const auto failure = to_failure(payload);
  if (!failure) return broken(Fault::crashed, failure.error().reason);
  return tl::unexpected(*failure);
}

Expected<std::string> EngineProcess::first_line() {
  constexpr std::size_t most_bytes = 1000;
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(command_.deadline_s));
  std::string line;
  while (line.size() < most_bytes) {
    char c = 0;
    const ssize_t got = ::recv(channel_, &c, 1, MSG_DONTWAIT);
    if (got == 0 && line.empty()) return died();
    if (got == 0 || c == '\n') break;
    if (got > 0) {
      line += c;
    } else if (!would_block()) {
      return died();
    } else if (auto waited = wait_for_engine(false, deadline, {}); !waited) {
      return tl::unexpected(waited.error());
    }
  }
  return readable(line, most_bytes);
}

Expected<void> EngineProcess::exchange(const Question& question, Header& header,
                                       std::string& payload) {
  const std::string frame = to_frame(question.tag, question.payload);
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(command_.deadline_s));
  std::string_view unsent = frame;
  std::optional<Header> begun;
  while (true) {
    auto whole = move(unsent, question, begun, payload);
    if (!whole) return tl::unexpected(whole.error());
    if (*whole) break;
    if (auto waited = wait_for_engine(!unsent.empty(), deadline, question); !waited) return waited;
  }
  if (!unsent.empty()) {
    return broken(Fault::crashed, fmt::format("the engine answered before '{}' was asked in full",
                                              to_word(question.tag)));
  }
  header = *begun;
  return {};
}

Expected<bool> EngineProcess::move(std::string_view& unsent, const Question& question,
                                   std::optional<Header>& header, std::string& received) {
  while (!unsent.empty()) {
    const ssize_t sent =
        ::send(channel_, unsent.data(), unsent.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && would_block()) break;
    if (sent < 0) return died();
    unsent.remove_prefix(static_cast<std::size_t>(sent));
  }
  while (true) {
    const std::size_t wanted = header ? header->bytes : k_header_bytes;
    if (header && received.size() == wanted) return true;
    const std::size_t before = received.size();
    received.resize(before + std::min(wanted - before, k_chunk_bytes));
    const ssize_t got =
        ::recv(channel_, received.data() + before, received.size() - before, MSG_DONTWAIT);
    received.resize(before + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got < 0 && would_block()) return false;
    if (got <= 0) return died();
    if (header || received.size() < k_header_bytes) continue;
    if (auto taken = take_header(question, header, received); !taken) {
      return broken(taken.error().fault, taken.error().reason);
    }
  }
}

Expected<void> EngineProcess::take_header(const Question& question, std::optional<Header>& header,
                                          std::string& received) const {
  header = to_header(received);
  if (!header) {
    return fail(Fault::crashed,
                fmt::format("the engine answered '{}' with what is no frame: '{}'; only frames "
                            "belong on standard output",
                            to_word(question.tag), readable(received, k_header_bytes)));
  }
  if (header->tag != question.answer && header->tag != Tag::failed) {
    return fail(Fault::crashed,
                fmt::format("the engine answered '{}' with '{}' instead of '{}'",
                            to_word(question.tag), to_word(header->tag), to_word(question.answer)));
  }
  const std::uint64_t most = header->tag == Tag::failed ? k_failed_bytes : question.most_bytes;
  if (header->bytes > most) {
    return fail(Fault::crashed, fmt::format("the engine answers '{}' with {} bytes; at most {}",
                                            to_word(question.tag), header->bytes, most));
  }
  received.clear();
  return {};
}

Expected<void> EngineProcess::wait_for_engine(bool unsent, Clock::time_point deadline,
                                              const Question& question) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  if (left <= 0) {
    return broken(Fault::timed_out, fmt::format("no answer to '{}' within {} s of wall-clock time",
                                                to_word(question.tag), command_.deadline_s));
  }
  std::array ready = {pollfd{channel_, static_cast<short>(unsent ? POLLIN | POLLOUT : POLLIN), 0},
                      pollfd{errors_, POLLIN, 0}};
  const int count =
      ::poll(ready.data(), ready.size(), static_cast<int>(std::min<std::int64_t>(left, k_look_ms)));
  if (count > 0 && ready[1].revents != 0) drain_errors();
  if (command_.memory_mb == 0 || Clock::now() < look_) return {};
  look_ = Clock::now() + std::chrono::milliseconds(k_look_ms);
  if (const std::uint64_t used_mb = resident_mb(pid_); used_mb > command_.memory_mb) {
    return broken(Fault::out_of_memory, fmt::format("the engine holds {} MB; it may have {} MB",
                                                    used_mb, command_.memory_mb));
  }
  return {};
}

void EngineProcess::drain_errors() {
  std::array<char, 16384> buffer;
  // Not without end: a program may write faster than it is read.
  for (int round = 0; round < 64 && errors_ >= 0; ++round) {
    const ssize_t count = ::read(errors_, buffer.data(), buffer.size());
    if (count < 0) return;
    if (count == 0) {
      ::close(std::exchange(errors_, -1));
      return;
    }
    said_.append(buffer.data(), static_cast<std::size_t>(count));
    if (said_.size() > 2 * k_kept_bytes) said_.erase(0, said_.size() - k_kept_bytes);
  }
}

bool EngineProcess::has_ended() {
  if (pid_ < 0) return true;
  const pid_t ended = ::waitpid(pid_, &status_, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return false;
  (void)::kill(-pid_, SIGKILL);  // what it may have started
  pid_ = -1;
  return true;
}

void EngineProcess::end() {
  if (channel_ >= 0) ::close(std::exchange(channel_, -1));
  for (int waited_ms = 0; !has_ended() && waited_ms < k_farewell_ms; ++waited_ms) {
    drain_errors();
    ::usleep(1000);
  }
  if (pid_ >= 0) {
    (void)::kill(-pid_, SIGKILL);
    while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }
  if (errors_ >= 0) drain_errors();
  if (errors_ >= 0) ::close(std::exchange(errors_, -1));
}

tl::unexpected<Failure> EngineProcess::died() {
  for (int waited_ms = 0; !has_ended() && waited_ms < k_farewell_ms; ++waited_ms) ::usleep(1000);
  const bool alone = pid_ < 0;
  return broken(Fault::crashed,
                alone ? end_text(status_) : "the engine closed its standard output and went on");
}

tl::unexpected<Failure> EngineProcess::broken(Fault fault, std::string reason) {
  if (pid_ >= 0) (void)::kill(-pid_, SIGKILL);
  end();
  if (!said_.empty()) {
    reason += fmt::format("; its standard error ends: {}", readable(said_, k_quoted_bytes));
  }
  failure_ = {fault, std::move(reason)};
  return tl::unexpected(*failure_);
}

}  // namespace brickbench::remote
