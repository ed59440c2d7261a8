// What is told of each step, and of the contacts after the last one, as binary payloads.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/seam/simulation.hpp"

namespace brickbench::remote {

inline constexpr std::size_t k_most_diagnostics = 64;

// After one step.
struct StepRecord {
  double cpu_s = 0.0;  // of all the engine's threads during the step
  Flags flags;
  Flags tellable;
  std::vector<State> states;  // (bodies)
  std::vector<Diagnostic> diagnostics;
};

// The longest payload of so many records.
std::uint64_t most_record_bytes(std::size_t records, std::size_t bodies);
// The longest payload of the contacts of so many bodies.
std::uint64_t most_contact_bytes(std::size_t bodies);

std::string to_bytes(std::span<const StepRecord> records);
// `count` records of `bodies` states each. Fault::crashed for any other payload, and for a time
// that is negative or not finite.
Expected<void> to_records(std::string_view payload, std::size_t count, std::size_t bodies,
                          std::vector<StepRecord>& records);

std::string to_bytes(std::span<const Contact> contacts);
// Fault::crashed where the payload is another one, or a contact is of no body.
Expected<void> to_contacts(std::string_view payload, std::size_t bodies,
                           std::vector<Contact>& contacts);

std::string to_bytes(std::span<const State> states);
Expected<void> to_states(std::string_view payload, std::span<State> states);

std::string to_bytes(std::span<const Wrench> wrenches);
Expected<void> to_wrenches(std::string_view payload, std::span<Wrench> wrenches);

}  // namespace brickbench::remote
