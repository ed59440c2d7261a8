#include "adapters/remote/launch.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>

namespace brickbench::remote {
namespace {

namespace fs = std::filesystem;

std::string system_word(int error) { return std::generic_category().message(error); }

// The two ends of something, closed unless taken.
struct Ends {
  int ours = -1;
  int theirs = -1;
  Ends() = default;
  Ends(const Ends&) = delete;
  Ends& operator=(const Ends&) = delete;
  ~Ends() {
    if (ours >= 0) ::close(ours);
    if (theirs >= 0) ::close(theirs);
  }
};

// Empty where PATH has no such program.
std::string found_program(const std::string& word) {
  if (word.find('/') != std::string::npos) return word;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/usr/bin:/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder) / word;
    std::error_code error;
    if (fs::is_regular_file(file, error) && ::access(file.c_str(), X_OK) == 0) {
      return fs::absolute(file).string();
    }
  }
  return {};
}

std::vector<std::string> whole_environment(const std::vector<std::string>& added) {
  std::vector<std::string> whole = added;
  for (char** entry = ::environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::string name = text.substr(0, text.find('=') + 1);
    const bool replaced =
        std::ranges::any_of(added, [&](const std::string& one) { return one.starts_with(name); });
    if (!replaced) whole.push_back(text);
  }
  return whole;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> all;
  for (std::string& text : texts) all.push_back(text.data());
  all.push_back(nullptr);
  return all;
}

struct Prepared {
  const char* program;
  char* const* arguments;
  char* const* environment;
  const char* folder;  // nullptr: here
  int channel;
  int errors;
  int complaint;  // where errno goes if the program does not start
  pid_t parent;
};

// In the child, between fork and exec: only calls that are safe there.
[[noreturn]] void become(const Prepared& prepared) {
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  (void)::setpgid(0, 0);
  for (int signal = 1; signal < 32; ++signal) (void)std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  (void)::sigprocmask(SIG_SETMASK, &none, nullptr);
  const rlimit no_core{0, 0};
  (void)::setrlimit(RLIMIT_CORE, &no_core);
  ::dup2(prepared.channel, STDIN_FILENO);
  ::dup2(prepared.channel, STDOUT_FILENO);
  ::dup2(prepared.errors, STDERR_FILENO);
  (void)::close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
  if (::getppid() == prepared.parent &&
      (prepared.folder == nullptr || ::chdir(prepared.folder) == 0)) {
    ::execve(prepared.program, prepared.arguments, prepared.environment);
  }
  const int error = errno;
  (void)!::write(prepared.complaint, &error, sizeof(error));
  ::_exit(127);
}

// The errno with which the program did not start, or 0.
int complaint_of(int descriptor) {
  int error = 0;
  ssize_t got = 0;
  do {
    got = ::read(descriptor, &error, sizeof(error));
  } while (got < 0 && errno == EINTR);
  return got == sizeof(error) ? error : 0;
}

}  // namespace

Expected<Child> start_program(const std::vector<std::string>& words, const std::string& folder,
                              const std::vector<std::string>& environment) {
  const auto refuse = [&](const std::string& why) {
    return fail(Fault::crashed, fmt::format("cannot start '{}': {}", fmt::join(words, " "), why));
  };
  if (words.empty()) return refuse("no program is named");
  const std::string program = found_program(words.front());
  if (program.empty()) return refuse("PATH has no such program");
  Ends channel, errors, complaint;
  std::array<int, 2> pair{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()) != 0) {
    return refuse(system_word(errno));
  }
  std::tie(channel.ours, channel.theirs) = std::pair(pair[0], pair[1]);
  if (::pipe2(pair.data(), O_CLOEXEC) != 0) return refuse(system_word(errno));
  std::tie(errors.ours, errors.theirs) = std::pair(pair[0], pair[1]);
  if (::pipe2(pair.data(), O_CLOEXEC) != 0) return refuse(system_word(errno));
  std::tie(complaint.ours, complaint.theirs) = std::pair(pair[0], pair[1]);
  (void)::fcntl(errors.ours, F_SETFL, O_NONBLOCK);

  std::vector<std::string> argument_texts = words;
  std::vector<std::string> environment_texts = whole_environment(environment);
  const std::vector<char*> arguments = pointers(argument_texts);
  const std::vector<char*> variables = pointers(environment_texts);
  const Prepared prepared = {program.c_str(),  arguments.data(),
                             variables.data(), folder.empty() ? nullptr : folder.c_str(),
                             channel.theirs,   errors.theirs,
                             complaint.theirs, ::getpid()};
  const pid_t pid = ::fork();
  if (pid < 0) return refuse(system_word(errno));
  if (pid == 0) become(prepared);
  ::close(std::exchange(complaint.theirs, -1));
  if (const int error = complaint_of(complaint.ours); error != 0) {
    while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
    }
    return refuse(folder.empty()
                      ? system_word(error)
                      : fmt::format("{} (in the folder {})", system_word(error), folder));
  }
  return Child{pid, std::exchange(channel.ours, -1), std::exchange(errors.ours, -1)};
}

}  // namespace brickbench::remote
