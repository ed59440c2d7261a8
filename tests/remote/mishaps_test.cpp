// Whatever an engine in another process does, there is an outcome, in time, with its own words, and
// nothing is left of it.
#include "tests/remote/mishaps.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cerrno>
#include <chrono>
#include <map>
#include <string>

#include "adapters/remote/remote_adapter.hpp"

namespace brickbench {
namespace {

using remote::Command;
using testing::RemoteMishap;

// Only those that never answer are waited for to the end.
constexpr double k_patience_s = 60.0;
constexpr double k_deadline_s = 1.0;

Command command(const std::string& mishap) {
  const bool answers = mishap != "hangs" && mishap != "trickles" && mishap != "hello_hangs";
  return {.words = {BRICKBENCH_REMOTE_PROGRAM, mishap},
          .folder = {},
          .environment = {},
          .deadline_s = answers ? k_patience_s : k_deadline_s,
          .memory_mb = 200};
}

World one_brick() {
  World world;
  world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.1, 0.1}}, 1000.0));
  return world;
}

// No child is left, dead or alive.
bool nothing_is_left() { return ::waitpid(-1, nullptr, WNOHANG) < 0 && errno == ECHILD; }

struct Wanted {
  Fault fault;
  std::string words;
};

// The failure of a run of five steps that looks at contacts and audit; nullopt where there is none.
std::optional<Failure> failure_of(const Command& command) {
  const auto adapter = remote::remote_adapter("other", command);
  if (!adapter) return adapter.error();
  const auto simulation = build(*adapter, one_brick(), {});
  if (!simulation) return simulation.error();
  if (const AuditView* view = (*simulation)->audit_view()) (void)view->audit();
  for (int step = 0; step < 5; ++step) {
    if (auto stepped = (*simulation)->step(); !stepped) return stepped.error();
    std::vector<Contact> contacts;
    if (const ContactView* view = (*simulation)->contact_view()) view->contacts(contacts);
  }
  return std::nullopt;
}

TEST(Mishaps, EachEndsInItsOutcome) {
  const std::map<RemoteMishap, Wanted> wanted = {
      {RemoteMishap::dies,
       {Fault::crashed, "died of signal SIGABRT; its standard error ends: asser"}},
      {RemoteMishap::exits, {Fault::crashed, "ended itself with exit status 3"}},
      {RemoteMishap::hangs, {Fault::timed_out, "no answer to 'step' within 1 s"}},
      {RemoteMishap::trickles, {Fault::timed_out, "no answer to 'step' within 1 s"}},
      {RemoteMishap::closes_output, {Fault::crashed, "closed its standard output and went on"}},
      {RemoteMishap::garbage, {Fault::crashed, "what is no frame: 'Loading textures'"}},
      {RemoteMishap::other_word,
       {Fault::crashed, "answered 'step' with 'done' instead of 'states'"}},
      {RemoteMishap::too_long, {Fault::crashed, "with 1152921504606846976 bytes; at most"}},
      {RemoteMishap::too_short, {Fault::crashed, "bytes instead of"}},
      {RemoteMishap::too_much, {Fault::crashed, "had sent more than its answers"}},
      {RemoteMishap::eats_memory, {Fault::out_of_memory, "it may have 200 MB"}},
      {RemoteMishap::refuses, {Fault::unsupported, "too many \"bricks\""}},
      {RemoteMishap::unknown_fault, {Fault::crashed, "failed.fault must be one of refused"}},
      {RemoteMishap::bad_flags, {Fault::crashed, "only the lowest 5 bits"}},
      {RemoteMishap::negative_time, {Fault::crashed, "a step took -1 s"}},
      {RemoteMishap::not_finite, {Fault::diverged, "body 'brick' is not finite"}},
      {RemoteMishap::contact_of_nobody, {Fault::crashed, "a contact of bodies 0 and 7"}},
      {RemoteMishap::audit_is_no_json, {Fault::crashed, "'audit' is not JSON"}},
      {RemoteMishap::other_version, {Fault::crashed, "speaks protocol 2"}},
      {RemoteMishap::hello_hangs, {Fault::timed_out, "no answer to 'hello'"}},
      {RemoteMishap::hello_without_variants, {Fault::crashed, "at least one variant"}},
      {RemoteMishap::hello_too_deep, {Fault::crashed, "nested deeper than 12"}},
      {RemoteMishap::hello_unknown_key, {Fault::crashed, "has a key 'shape'; known are"}},
  };
  for (const auto& [mishap, name] : testing::k_remote_mishaps) {
    if (mishap == RemoteMishap::mutated) continue;
    const auto failure = failure_of(command(std::string(name)));
    const auto found = wanted.find(mishap);
    EXPECT_TRUE(nothing_is_left()) << name;
    if (found == wanted.end()) {
      EXPECT_FALSE(failure) << name << ": " << failure->reason;
      continue;
    }
    ASSERT_TRUE(failure) << name;
    EXPECT_EQ(to_outcome(failure->fault), to_outcome(found->second.fault)) << name;
    EXPECT_NE(failure->reason.find(found->second.words), std::string::npos)
        << name << ": " << failure->reason;
    EXPECT_EQ(failure->reason.find('\n'), std::string::npos) << name;
    EXPECT_LT(failure->reason.size(), 2000U) << name;
  }
}

TEST(Mishaps, AProgramThatDoesNotStartSaysWhy) {
  const std::map<std::string, std::string> wanted = {
      {"no_such_program_anywhere", "PATH has no such program"},
      {"/no/such/program", "No such file or directory"},
      {"/etc/passwd", "Permission denied"}};
  for (const auto& [program, words] : wanted) {
    Command wrong = command("none");
    wrong.words.front() = program;
    const auto failure = failure_of(wrong);
    ASSERT_TRUE(failure) << program;
    EXPECT_EQ(failure->fault, Fault::crashed);
    EXPECT_NE(failure->reason.find("cannot start '" + program), std::string::npos);
    EXPECT_NE(failure->reason.find(words), std::string::npos) << failure->reason;
  }
  Command nowhere = command("none");
  nowhere.folder = "/no/such/folder";
  EXPECT_NE(failure_of(nowhere)->reason.find("/no/such/folder"), std::string::npos);
  EXPECT_TRUE(nothing_is_left());
}

// A lost view shows in the flags until the step that fails for it.
TEST(Mishaps, AViewThatFailsIsFlaggedAtOnce) {
  const auto adapter = remote::remote_adapter("other", command("contact_of_nobody"));
  ASSERT_TRUE(adapter) << adapter.error().reason;
  const auto simulation = build(*adapter, one_brick(), {});
  ASSERT_TRUE(simulation) << simulation.error().reason;
  ASSERT_TRUE((*simulation)->step());
  EXPECT_TRUE((*simulation)->diagnostic_view()->flags().empty());
  std::vector<Contact> contacts;
  (*simulation)->contact_view()->contacts(contacts);
  EXPECT_TRUE(contacts.empty());
  EXPECT_TRUE((*simulation)->diagnostic_view()->flags().has(Flag::contacts_dropped));
  EXPECT_FALSE((*simulation)->step());
}

// Every answer damaged at random: whatever comes of it is a value, in the time of its questions.
TEST(Mishaps, DamagedAnswersEndInValues) {
  constexpr int seeds = 150;
  int failed = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    Command damaged = command("mutated");
    damaged.words.push_back(std::to_string(seed));
    damaged.deadline_s = 0.1;
    const auto begun = std::chrono::steady_clock::now();
    const auto failure = failure_of(damaged);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    if (failure) {
      ++failed;
      EXPECT_FALSE(failure->reason.empty());
    }
    EXPECT_LT(took.count(), 30.0) << seed;
  }
  EXPECT_TRUE(nothing_is_left());
  EXPECT_GT(failed, seeds / 2);
}

}  // namespace
}  // namespace brickbench
