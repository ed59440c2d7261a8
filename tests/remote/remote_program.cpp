// An engine in a process of its own, for tests: `remote_program serve NAME` is a linked engine,
// `remote_program MISHAP [SEED]` holds every body where it began until it does what its name says.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>

#include "adapters/catalog.hpp"
#include "adapters/remote/codec.hpp"
#include "adapters/remote/frame.hpp"
#include "adapters/remote/serve.hpp"
#include "adapters/remote/step_record.hpp"
#include "tests/remote/mishaps.hpp"
#include "tests/remote/mutate.hpp"

namespace brickbench::testing {
namespace {

using remote::Tag;

bool take(std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t got = ::read(STDIN_FILENO, bytes.data() + done, bytes.size() - done);
    if (got <= 0) return false;
    done += static_cast<std::size_t>(got);
  }
  return true;
}

void send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (sent <= 0) std::_Exit(1);
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

[[noreturn]] void sleep_forever() {
  while (true) ::usleep(1000);
}

// Stays where it began.
class StandingEngine {
 public:
  StandingEngine(RemoteMishap mishap, std::uint64_t seed) : mishap_(mishap), random_(seed) {}

  void answer(Tag request, const std::string& payload) {
    switch (request) {
      case Tag::hello:
        return reply(Tag::hello, hello());
      case Tag::build: {
        const auto order = remote::to_build_order(payload, payload.size());
        for (const Body& body : order->world.bodies) record_.states.push_back(body.initial);
        return reply(Tag::built, remote::to_json(remote::Built{true, true, true, true, 0.0}));
      }
      case Tag::step:
        if (++steps_ == 3) return third_step(count_of(payload));
        return reply(Tag::states, remote::to_bytes(std::vector(count_of(payload), record_)));
      case Tag::read:
        return reply(Tag::states, records());
      case Tag::set_state:
        return reply(Tag::done, "");
      case Tag::contacts:
        return reply(Tag::contacts, contacts());
      case Tag::audit:
        return reply(Tag::audit, mishap_ == RemoteMishap::audit_is_no_json ? "{" : audit());
      case Tag::pair_law:
        return reply(Tag::pair_law, std::string(16, '\0'));
      default:
        std::_Exit(2);
    }
  }

 private:
  void reply(Tag tag, const std::string& payload) {
    std::string frame = remote::to_frame(tag, payload);
    if (mishap_ == RemoteMishap::mutated && random_() % 3 == 0) frame = mutated(frame, random_);
    send(frame);
  }

  static std::size_t count_of(const std::string& payload) {
    return remote::PayloadReader(payload).take<std::uint64_t>();
  }

  std::string records() const { return remote::to_bytes(std::array{record_}); }

  std::string hello() const {
    if (mishap_ == RemoteMishap::hello_hangs) sleep_forever();
    if (mishap_ == RemoteMishap::other_version) return R"({"protocol": 2, "words": "new"})";
    if (mishap_ == RemoteMishap::hello_too_deep) return std::string(100000, '[');
    remote::Hello hello{"standing", "1", {"box", "plane"}, {{"default", "stands", "f64"}}, {}};
    if (mishap_ == RemoteMishap::hello_without_variants) hello.variants.clear();
    std::string json = remote::to_json(hello);
    if (mishap_ == RemoteMishap::hello_unknown_key) json.insert(1, "\"shape\": [], ");
    return json;
  }

  std::string contacts() const {
    Contact contact;
    contact.body_b = mishap_ == RemoteMishap::contact_of_nobody ? 7 : 0;
    return remote::to_bytes(std::array{contact});
  }

  std::string audit() const {
    Audit audit;
    audit.bodies.resize(record_.states.size());
    audit.settings = {{"step_s", "s", "0.001"}};
    return remote::to_json(audit);
  }

  void third_step(std::size_t count) {
    std::string frame = remote::to_frame(Tag::states, records());
    switch (mishap_) {
      case RemoteMishap::dies:
        fmt::print(stderr, "assertion failed: n > 0\n");
        std::fflush(stderr);
        std::abort();
      case RemoteMishap::exits:
        std::_Exit(3);
      case RemoteMishap::hangs:
        sleep_forever();
      case RemoteMishap::trickles:
        for (const char c : frame) {
          send({&c, 1});
          ::usleep(50000);
        }
        sleep_forever();
      case RemoteMishap::closes_output:
        ::close(STDOUT_FILENO);
        ::close(STDIN_FILENO);
        sleep_forever();
      case RemoteMishap::garbage:
        return send("Loading textures ... done, all is well\n");
      case RemoteMishap::other_word:
        return send(remote::to_frame(Tag::done, ""));
      case RemoteMishap::too_long:
        return send(remote::to_bytes({Tag::states, std::uint64_t{1} << 60U}));
      case RemoteMishap::too_short:
        return send(remote::to_frame(Tag::states, records().substr(8)));
      case RemoteMishap::too_much:
        return send(frame + frame);
      case RemoteMishap::eats_memory:
        for (int piece = 0; piece < 64; ++piece) {
          char* volatile memory = new char[std::size_t{16} << 20U];
          std::fill_n(static_cast<char*>(memory), std::size_t{16} << 20U, 'x');
        }
        sleep_forever();
      case RemoteMishap::chatters:
        for (int line = 0; line < 200000; ++line) fmt::print(stderr, "step {} is fine\n", line);
        return send(frame);
      case RemoteMishap::refuses:
        return send(remote::to_frame(
            Tag::failed, remote::to_json(Failure{Fault::unsupported, "too many \"bricks\""})));
      case RemoteMishap::unknown_fault:
        return send(remote::to_frame(Tag::failed, R"({"fault": "tired", "reason": "so tired"})"));
      case RemoteMishap::bad_flags:
        frame[remote::k_header_bytes + 11] = '\x40';
        return send(frame);
      case RemoteMishap::negative_time:
        record_.cpu_s = -1.0;
        return send(remote::to_frame(Tag::states, records()));
      case RemoteMishap::not_finite:
        record_.states.front().position_m.x() = std::nan("");
        return send(remote::to_frame(Tag::states, records()));
      default:
        return reply(Tag::states, remote::to_bytes(std::vector(count, record_)));
    }
  }

  RemoteMishap mishap_;
  std::mt19937_64 random_;
  remote::StepRecord record_;
  int steps_ = 0;
};

int run_program(const std::vector<std::string>& words) {
  if (words.size() == 3 && words[1] == "serve") {
    for (const Adapter& adapter : adapters()) {
      if (adapter.name != words[2]) continue;
      const int frames = ::dup(STDOUT_FILENO);
      ::dup2(STDERR_FILENO, STDOUT_FILENO);
      return remote::serve(adapter, STDIN_FILENO, frames) ? 0 : 1;
    }
    return 2;
  }
  const auto named = std::ranges::find(k_remote_mishaps, words.at(1), &RemoteMishapName::name);
  if (named == k_remote_mishaps.end()) return 2;
  StandingEngine engine(named->mishap, words.size() > 2 ? std::stoull(words[2]) : 0);
  for (std::string head(remote::k_header_bytes, '\0'); take(head);) {
    const auto header = remote::to_header(head);
    if (!header) return 2;
    std::string payload(header->bytes, '\0');
    if (!take(payload)) return 2;
    engine.answer(header->tag, payload);
  }
  return 0;
}

}  // namespace
}  // namespace brickbench::testing

int main(int argc, char** argv) {
  return brickbench::testing::run_program(std::vector<std::string>(argv, argv + argc));
}
