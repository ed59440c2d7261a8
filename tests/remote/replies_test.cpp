// The readers of answers, fed with damaged ones: no crash, no hang, no allocation out of
// proportion.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <new>

#include "adapters/remote/codec.hpp"
#include "adapters/remote/frame.hpp"
#include "adapters/remote/step_record.hpp"
#include "tests/remote/mutate.hpp"

namespace {

// The largest piece of memory that anyone asked for since it was set to 0.
std::atomic<std::size_t> largest_bytes{0};

}  // namespace

// Not inlined, or the compiler takes new and free for a mismatched pair.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
  if (bytes > largest_bytes) largest_bytes = bytes;
  if (void* memory = std::malloc(bytes)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace brickbench::remote {
namespace {

constexpr std::size_t k_bodies = 5;
constexpr int k_mutations = 20000;  // of each kind of answer

Hello a_hello() {
  Hello hello{"tiny", "0.1", {"box", "sphere"}, {}, {}};
  hello.knobs = {{"iterations", "1", 10, "sweeps", 1, 1000, true},
                 {"softness", "1/s", std::numeric_limits<double>::infinity(), "of contacts"}};
  hello.variants = {{"default", "as it comes", "f64", {{"iterations", 10}}, 4},
                    {"fast", "single precision", "f32", {{"softness", 0.25}}, 1}};
  return hello;
}

Audit an_audit() {
  Audit audit;
  audit.bodies.resize(3);
  audit.bodies[1].shape = BoxShape{{0.1, 0.2, 0.3}};
  audit.bodies[2].shape = SphereShape{0.1};
  audit.settings = {{"iterations", "1", "10"}};
  return audit;
}

std::string some_records() {
  StepRecord record;
  record.states.resize(k_bodies);
  record.diagnostics = {{"residual", "N s", 1e-9}};
  return to_bytes(std::array{record, record});
}

std::string some_contacts() {
  std::vector<Contact> contacts(4);
  contacts[1].body_b = k_bodies - 1;
  return to_bytes(contacts);
}

struct Reader {
  const char* name;
  std::string right;
  bool (*accepts)(const std::string&);
};

std::vector<Reader> readers() {
  return {
      {"hello", to_json(a_hello()), [](const std::string& b) { return to_hello(b).has_value(); }},
      {"built", to_json(Built{true, false, true, true, 0.5}),
       [](const std::string& b) { return to_built(b).has_value(); }},
      {"audit", to_json(an_audit()),
       [](const std::string& b) { return to_audit(b, 100000).has_value(); }},
      {"failed", to_json(Failure{Fault::unsupported, "no \"plane\""}),
       [](const std::string& b) { return to_failure(b).has_value(); }},
      {"records", some_records(),
       [](const std::string& b) {
         std::vector<StepRecord> records;
         return to_records(b, 2, k_bodies, records).has_value();
       }},
      {"contacts", some_contacts(),
       [](const std::string& b) {
         std::vector<Contact> contacts;
         return to_contacts(b, k_bodies, contacts).has_value();
       }},
      {"header", to_bytes({Tag::states, 1000}),
       [](const std::string& b) { return to_header(b).has_value(); }},
  };
}

TEST(Replies, DamageDoesNoHarm) {
  constexpr std::size_t most_bytes = 8U << 20U;  // of one piece; answers are below 10 kB
  for (const Reader& reader : readers()) {
    ASSERT_TRUE(reader.accepts(reader.right)) << reader.name;
    std::mt19937_64 random(1);
    int refused = 0;
    largest_bytes = 0;
    for (int k = 0; k < k_mutations; ++k) {
      if (!reader.accepts(testing::mutated(reader.right, random))) ++refused;
    }
    EXPECT_LT(largest_bytes, most_bytes) << reader.name;
    EXPECT_GT(refused, k_mutations / 10) << reader.name;
  }
}

// What is written is read back: all fields, and ends of ranges that JSON has no number for.
TEST(Replies, WhatIsWrittenIsRead) {
  const auto hello = to_hello(to_json(a_hello()));
  ASSERT_TRUE(hello) << hello.error().reason;
  EXPECT_EQ(to_json(*hello), to_json(a_hello()));
  EXPECT_EQ(hello->knobs[1].max, std::numeric_limits<double>::infinity());
  const auto audit = to_audit(to_json(an_audit()), 100000);
  ASSERT_TRUE(audit) << audit.error().reason;
  EXPECT_EQ(to_json(*audit), to_json(an_audit()));
}

std::vector<std::string> json_blocks(const std::string& file) {
  std::ifstream page(file);
  std::vector<std::string> blocks;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line == "```json") blocks.emplace_back();
    if (inside && line != "```") blocks.back() += line + '\n';
    inside = line == "```json" || (inside && line != "```");
  }
  return blocks;
}

// The examples of the page are what the readers take.
TEST(Replies, TheExamplesOfThePageAreRight) {
  const auto blocks = json_blocks("docs/protocol.md");
  ASSERT_EQ(blocks.size(), 4U);
  const auto hello = to_hello(blocks[0]);
  const auto order = to_build_order(blocks[1], k_most_json_bytes);
  const auto built = to_built(blocks[2]);
  const auto audit = to_audit(blocks[3], k_most_json_bytes);
  EXPECT_TRUE(hello) << hello.error().reason;
  ASSERT_TRUE(order) << order.error().reason;
  EXPECT_TRUE(built) << built.error().reason;
  EXPECT_TRUE(audit) << audit.error().reason;
  EXPECT_TRUE(validate(order->world));
}

// Numbers out of range, names that are none, and lists that contradict each other.
TEST(Replies, AHelloThatContradictsItselfIsRefusedInWords) {
  struct Case {
    void (*spoil)(Hello&);
    const char* words;
  };
  const Case cases[] = {
      {[](Hello& h) { h.variants[1].name = h.variants[0].name; }, "each name stands once"},
      {[](Hello& h) { h.knobs[1].name = "iterations"; }, "each name stands once"},
      {[](Hello& h) { h.variants[0].name = "De Fault"; }, "small letters, digits and _"},
      {[](Hello& h) { h.variants[0].knobs["speed"] = 1; }, "one of the knobs"},
      {[](Hello& h) { h.variants[0].knobs["iterations"] = 0; }, "whole numbers from 1 to 1000"},
      {[](Hello& h) { h.knobs[0].engine_default = 0.5; }, "in the knob's range"},
      {[](Hello& h) { h.variants[0].precision = "f16"; }, "f64 or f32"},
      {[](Hello& h) { h.variants[0].max_threads = 0; }, "whole number from 1"},
      {[](Hello& h) { h.version = "1\n2"; }, "one line of text"},
      {[](Hello& h) { h.name.clear(); }, "one line of text"},
  };
  for (const Case& one : cases) {
    Hello hello = a_hello();
    one.spoil(hello);
    const auto read = to_hello(to_json(hello));
    ASSERT_FALSE(read) << one.words;
    EXPECT_NE(read.error().reason.find(one.words), std::string::npos) << read.error().reason;
  }
}

}  // namespace
}  // namespace brickbench::remote
