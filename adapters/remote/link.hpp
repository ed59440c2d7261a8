// Link: the questions of docs/protocol.md to one engine in a process of its own, as functions.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "adapters/remote/codec.hpp"
#include "adapters/remote/process.hpp"
#include "adapters/remote/step_record.hpp"

namespace brickbench::remote {

// Failures of all functions: EngineProcess::ask(), and what the engine says of itself.
class Link {
 public:
  // Starts the program and lets it say what it is.
  static Expected<Link> open(const Command& command);

  const Hello& hello() const { return hello_; }
  // Once per link. Fault::unsupported for shapes that the engine does not name.
  Expected<Built> build(const World& world, const Settings& settings);
  // Advances by `count` >= 1 steps; `wrenches` (bodies, or none for zero) are held during the first
  // of them. One record per step.
  Expected<void> step(std::uint64_t count, std::span<const Wrench> wrenches,
                      std::vector<StepRecord>& records);
  // What the engine shows now.
  Expected<StepRecord> read();
  Expected<void> set_state(std::span<const State> states);
  // Of the last step.
  Expected<void> contacts(std::vector<Contact>& contacts);
  Expected<Audit> audit();
  Expected<ContactLaw> pair_law(std::size_t a, std::size_t b);

 private:
  Link() = default;
  Expected<std::string> ask(Tag tag, std::string_view payload, Tag answer,
                            std::uint64_t most_bytes);
  Expected<void> ask_records(Tag tag, std::string_view payload, std::uint64_t count,
                             std::vector<StepRecord>& records);

  std::unique_ptr<EngineProcess> process_;
  Hello hello_;
  std::size_t bodies_ = 0;
};

}  // namespace brickbench::remote
