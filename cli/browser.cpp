#include "cli/browser.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace brickbench {
namespace {

using Message = nlohmann::json;

constexpr int k_patience_ms = 60000;
// The protocol fixes these descriptors for --remote-debugging-pipe.
constexpr int k_browser_reads = 3;
constexpr int k_browser_writes = 4;

tl::unexpected<Failure> broken(const std::string& reason) {
  return fail(Fault::crashed, "the browser " + reason);
}

std::vector<std::string> command_line(const std::string& program, const std::string& profile,
                                      bool sandbox) {
  std::vector<std::string> words = {program,
                                    "--headless=new",
                                    "--remote-debugging-pipe",
                                    "--use-angle=swiftshader",
                                    "--enable-unsafe-swiftshader",
                                    "--no-first-run",
                                    "--disable-extensions",
                                    "--disable-background-networking",
                                    "--hide-scrollbars",
                                    "--user-data-dir=" + profile};
  if (!sandbox) words.emplace_back("--no-sandbox");
  words.emplace_back("about:blank");
  return words;
}

// In the child: the pipes to their places, silence, and the program. Never returns.
[[noreturn]] void become(std::vector<std::string> words, int reads, int writes) {
  // Out of the way first, so that neither dup2 overwrites the other's source.
  const int in = ::fcntl(reads, F_DUPFD, 10);
  const int out = ::fcntl(writes, F_DUPFD, 10);
  ::dup2(in, k_browser_reads);
  ::dup2(out, k_browser_writes);
  const int nothing = ::open("/dev/null", O_RDWR);
  for (const int standard : {0, 1, 2}) ::dup2(nothing, standard);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

}  // namespace

Expected<std::unique_ptr<Browser>> Browser::start(const std::string& program) {
  // Chromium refuses its sandbox to root, and has none where the system gives no user namespaces,
  // as in many containers. What it opens here is a page of ours from the disk.
  if (::geteuid() == 0) return start(program, false);
  auto browser = start(program, true);
  if (browser) return browser;
  fmt::print(stderr, "brickbench: the browser does not start in its sandbox; trying without\n");
  return start(program, false);
}

Expected<std::unique_ptr<Browser>> Browser::start(const std::string& program, bool sandbox) {
  std::unique_ptr<Browser> browser(new Browser);
  std::string pattern = (std::filesystem::temp_directory_path() / "brickbench-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) return broken("got no folder for its profile");
  browser->profile_ = pattern;
  std::array<int, 2> there{};
  std::array<int, 2> back{};
  if (::pipe2(there.data(), O_CLOEXEC) != 0 || ::pipe2(back.data(), O_CLOEXEC) != 0) {
    return broken("got no pipe");
  }
  // A browser that ends must show as a failed write, not end this program.
  ::signal(SIGPIPE, SIG_IGN);
  browser->to_ = there[1];
  browser->from_ = back[0];
  browser->process_ = ::fork();
  if (browser->process_ < 0) return broken("could not be started");
  if (browser->process_ == 0) {
    become(command_line(program, pattern, sandbox), there[0], back[1]);
  };
  ::close(there[0]);
  ::close(back[1]);
  if (auto ok = browser->call("Browser.getVersion", Message::object()); !ok) {
    return tl::unexpected(ok.error());
  }
  return browser;
}

Browser::~Browser() {
  if (to_ >= 0) {
    (void)call("Browser.close", Message::object());
    ::close(to_);
    ::close(from_);
  }
  if (process_ > 0) {
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
  }
  std::error_code ignored;
  if (!profile_.empty()) std::filesystem::remove_all(profile_, ignored);
}

Expected<nlohmann::json> Browser::receive() {
  for (;;) {
    const std::size_t end = buffer_.find('\0');
    if (end != std::string::npos) {
      Message message = Message::parse(buffer_.substr(0, end), nullptr, false);
      buffer_.erase(0, end + 1);
      if (message.is_discarded()) return broken("sent what is not JSON");
      return message;
    }
    pollfd waiting{from_, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, k_patience_ms);
    if (ready == 0) return broken(fmt::format("is silent for {} s", k_patience_ms / 1000));
    std::array<char, 65536> chunk{};
    const ssize_t got = ::read(from_, chunk.data(), chunk.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return broken("ended or could not be started");
    buffer_.append(chunk.data(), static_cast<std::size_t>(got));
  }
}

Expected<nlohmann::json> Browser::call(const std::string& method, const Message& parameters) {
  const int id = next_id_++;
  Message message = {{"id", id}, {"method", method}, {"params", parameters}};
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump() + '\0';
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = ::write(to_, text.data() + at, text.size() - at);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return broken("ended");
    at += static_cast<std::size_t>(written);
  }
  for (;;) {
    auto answer = receive();
    if (!answer) return answer;
    if (answer->value("id", 0) != id) continue;  // an event
    if (answer->contains("error")) {
      return broken(fmt::format("refuses {}: {}", method, (*answer)["error"].value("message", "")));
    }
    return (*answer)["result"];
  }
}

Expected<void> Browser::open(const std::string& file, int width_px, int height_px) {
  session_.clear();
  auto target = call("Target.createTarget", {{"url", "about:blank"}});
  if (!target) return tl::unexpected(target.error());
  auto attached =
      call("Target.attachToTarget", {{"targetId", (*target)["targetId"]}, {"flatten", true}});
  if (!attached) return tl::unexpected(attached.error());
  session_ = (*attached)["sessionId"].get<std::string>();
  const Message size = {
      {"width", width_px}, {"height", height_px}, {"deviceScaleFactor", 1}, {"mobile", false}};
  if (auto ok = call("Emulation.setDeviceMetricsOverride", size); !ok) {
    return tl::unexpected(ok.error());
  }
  const std::string url = "file://" + std::filesystem::absolute(file).string();
  if (auto ok = call("Page.navigate", {{"url", url}}); !ok) return tl::unexpected(ok.error());
  for (int tries = 0; tries < 300; ++tries) {
    const auto there = evaluate("typeof window.brickbench === 'object'");
    if (there && there->is_boolean() && there->get<bool>()) return {};
    if (!there && there.error().reason.find("ended") != std::string::npos) {
      return tl::unexpected(there.error());
    }
    ::usleep(100000);
  }
  return broken("does not open the page");
}

Expected<nlohmann::json> Browser::evaluate(const std::string& expression) {
  auto result = call("Runtime.evaluate",
                     {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}});
  if (!result) return result;
  if (result->contains("exceptionDetails")) {
    const Message& details = (*result)["exceptionDetails"];
    std::string words = details.value("text", "");
    if (details.contains("exception")) words += ' ' + details["exception"].value("description", "");
    return broken("reports: " + words);
  }
  const Message& value = (*result)["result"];
  return value.contains("value") ? value["value"] : Message(nullptr);
}

}  // namespace brickbench
