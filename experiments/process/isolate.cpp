#include "experiments/process/isolate.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <system_error>
#include <utility>

namespace brickbench {

// What parent and child share.
struct Isolated::Slot {
  static constexpr std::size_t answer_size = 4000;
  std::atomic<bool> answered{false};
  std::atomic<double> share{0.0};
  std::size_t length = 0;
  std::array<char, answer_size> answer{};
};

namespace {

constexpr std::size_t k_kept_bytes = 65536;
constexpr int k_exit_without_answer = 125;

tl::unexpected<Failure> refused(const char* what) {
  return fail(Fault::crashed, fmt::format("cannot start a process: {}: {}", what,
                                          std::generic_category().message(errno)));
}

std::uint64_t address_space_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limit(decltype(RLIMIT_CORE) what, std::uint64_t most) {
  const rlimit value{most, most};
  (void)::setrlimit(what, &value);
}

void default_signals() {
  for (int signal = 1; signal < 32; ++signal) {
    if (signal != SIGXFSZ) (void)std::signal(signal, SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

void redirect(int output) {
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  (void)::close_range(3, ~0U, 0);
}

// A signal that a faulty program gets from the system for what it does.
bool is_own_fault(int signal) {
  constexpr std::array own = {SIGSEGV, SIGABRT, SIGFPE,  SIGILL,  SIGBUS,
                              SIGSYS,  SIGTRAP, SIGPIPE, SIGXCPU, SIGXFSZ};
  return std::ranges::find(own, signal) != own.end();
}

}  // namespace

Expected<Isolated> Isolated::start(const Work& work, const Limits& limits) {
  Isolated process;
  process.limits_ = limits;
  void* memory =
      ::mmap(nullptr, sizeof(Slot), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return refused("shared memory");
  process.slot_ = new (memory) Slot;
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return refused("pipe");
  process.output_ = ends[0];
  (void)::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  std::fflush(nullptr);
  process.started_ = Clock::now();
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) {
    ::close(ends[1]);
    return refused("fork");
  }
  if (pid == 0) {
    (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(k_exit_without_answer);
    (void)::setpgid(0, 0);
    default_signals();
    redirect(ends[1]);
    limit(RLIMIT_CORE, 0);
    if (limits.memory_mb > 0) limit(RLIMIT_AS, address_space_bytes() + (limits.memory_mb << 20U));
    Slot& slot = *process.slot_;
    try {
      const std::string answer = work([&slot](double share) {
        slot.share = share;
        return true;
      });
      slot.length = std::min(answer.size(), Slot::answer_size);
      std::copy_n(answer.begin(), slot.length, slot.answer.begin());
      slot.answered = true;
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
    } catch (...) {
    }
    std::fflush(nullptr);
    ::_exit(slot.answered ? 0 : k_exit_without_answer);
  }
  ::close(ends[1]);
  process.pid_ = pid;
  return process;
}

Isolated::Isolated(Isolated&& other) noexcept { *this = std::move(other); }

Isolated& Isolated::operator=(Isolated&& other) noexcept {
  if (this == &other) return *this;
  release();
  pid_ = std::exchange(other.pid_, -1);
  output_ = std::exchange(other.output_, -1);
  slot_ = std::exchange(other.slot_, nullptr);
  limits_ = other.limits_;
  timed_out_ = other.timed_out_;
  killed_ = other.killed_;
  at_end_ = other.at_end_;
  started_ = other.started_;
  head_ = std::move(other.head_);
  tail_ = std::move(other.tail_);
  dropped_bytes_ = other.dropped_bytes_;
  return *this;
}

Isolated::~Isolated() { release(); }

void Isolated::release() {
  if (pid_ > 0) {
    kill();
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (output_ >= 0) ::close(output_);
  if (slot_ != nullptr) ::munmap(slot_, sizeof(Slot));
  pid_ = -1;
  output_ = -1;
  slot_ = nullptr;
}

void Isolated::drain() {
  std::array<char, 16384> buffer;
  while (true) {
    const ssize_t count = ::read(output_, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) at_end_ = true;
    if (count <= 0) return;
    std::string_view text(buffer.data(), static_cast<std::size_t>(count));
    const std::size_t room = std::min(k_kept_bytes - head_.size(), text.size());
    head_ += text.substr(0, room);
    tail_ += text.substr(room);
    if (tail_.size() < 2 * k_kept_bytes) continue;
    dropped_bytes_ += tail_.size() - k_kept_bytes;
    tail_.erase(0, tail_.size() - k_kept_bytes);
  }
}

void Isolated::check_limit() {
  const std::chrono::duration<double> age = Clock::now() - started_;
  if (limits_.wall_s <= 0.0 || age.count() <= limits_.wall_s || timed_out_) return;
  timed_out_ = true;
  kill();
}

void Isolated::kill() {
  if (pid_ <= 0) return;
  killed_ = true;
  if (::kill(-pid_, SIGKILL) != 0) (void)::kill(pid_, SIGKILL);
}

bool Isolated::has_ended(Ended& ended) {
  int status = 0;
  const pid_t pid = ::waitpid(pid_, &status, WNOHANG);
  if (pid == 0 || (pid < 0 && errno == EINTR)) return false;
  // What the work may have left running goes with it.
  (void)::kill(-pid_, SIGKILL);
  drain();
  ended = describe(status);
  pid_ = -1;
  return true;
}

Ended Isolated::describe(int status) {
  Ended ended;
  ended.wall_s = std::chrono::duration<double>(Clock::now() - started_).count();
  ended.share = slot_->share;
  ended.output = std::move(head_);
  if (dropped_bytes_ > 0) ended.output += fmt::format("\n[{} bytes left out]\n", dropped_bytes_);
  ended.output += tail_;
  ended.answered = slot_->answered;
  if (ended.answered) {
    ended.answer.assign(slot_->answer.data(), slot_->length);
  } else if (timed_out_) {
    ended.failure = {Fault::timed_out,
                     fmt::format("no result within the wall-clock limit of {} s", limits_.wall_s)};
  } else if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    ended.from_outside = !killed_ && !is_own_fault(signal);
    ended.failure = {Fault::crashed,
                     fmt::format("the process died of signal SIG{} ({})",
                                 ::sigabbrev_np(signal) == nullptr ? "?" : ::sigabbrev_np(signal),
                                 ::sigdescr_np(signal) == nullptr ? "?" : ::sigdescr_np(signal))};
  } else {
    ended.failure = {Fault::crashed, fmt::format("the process ended itself with exit status {}",
                                                 WEXITSTATUS(status))};
  }
  return ended;
}

Ended Isolated::wait() {
  constexpr int period_ms = 10;
  Ended ended;
  while (!has_ended(ended)) {
    pollfd ready{output_descriptor(), POLLIN, 0};
    (void)::poll(&ready, 1, period_ms);
    drain();
    check_limit();
  }
  return ended;
}

std::size_t thread_count() {
  std::error_code error;
  const std::filesystem::directory_iterator tasks("/proc/self/task", error);
  return error ? 1 : static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

}  // namespace brickbench
