// The payloads of docs/protocol.md that are JSON, in both directions. Readers accept only what the
// document allows, say what is wrong and where, and never build more than a bounded tree.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "adapters/seam/adapter.hpp"

namespace brickbench::remote {

// The longest JSON that a reader looks at, in bytes, and how deep it may be nested.
inline constexpr std::size_t k_most_json_bytes = 1U << 20U;
inline constexpr int k_most_json_depth = 12;

// What an engine says of itself before anything is built.
struct Hello {
  std::string name;                 // as the library calls itself
  std::string version;              // as the library reports it
  std::vector<std::string> shapes;  // shape_word() of those that it can build
  std::vector<Variant> variants;
  std::vector<Knob> knobs;
};

// What an engine says of a world that it has built.
struct Built {
  bool contacts = false;  // the optional views of the seam that it offers
  bool set_state = false;
  bool audit = false;
  bool diagnostics = false;
  double cpu_s = 0.0;  // of building
};

struct BuildOrder {
  World world;
  Settings settings;
};

// The harness' greeting, and what it says: Fault::unsupported for another version of the protocol.
std::string greeting();
Expected<void> read_greeting(std::string_view json);

std::string to_json(const Hello& hello);
std::string to_json(const Built& built);
std::string to_json(const BuildOrder& order);
std::string to_json(const Audit& audit);
std::string to_json(const Failure& failure);

// The readers fail with Fault::crashed, where the other side broke the protocol.
Expected<Hello> to_hello(std::string_view json);
Expected<Built> to_built(std::string_view json);
Expected<BuildOrder> to_build_order(std::string_view json, std::size_t most_bytes);
Expected<Audit> to_audit(std::string_view json, std::size_t most_bytes);
// What the engine says went wrong.
Expected<Failure> to_failure(std::string_view json);

}  // namespace brickbench::remote
