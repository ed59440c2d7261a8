// What went wrong, as a value: every failure that a caller can meet travels in tl::expected.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace brickbench {

// The kinds of failure of a cell. Each is an outcome in the rows; see to_outcome().
enum class Fault {
  unsupported,  // the engine cannot express this world or setting; it said so before the first step
  invalid,      // the world or the settings contradict themselves
  diverged,     // a state is not finite
  blown_up,     // more energy than gravity and outer work could have given
  crashed,      // the engine threw, aborted or reported an internal error
  timed_out,
  out_of_memory,
};

struct Failure {
  Fault fault = Fault::invalid;
  std::string reason;  // one sentence, names the quantity, its value and what is allowed
};

template <typename T>
using Expected = tl::expected<T, Failure>;

inline tl::unexpected<Failure> fail(Fault fault, std::string reason) {
  return tl::unexpected<Failure>({fault, std::move(reason)});
}

// The word that stands in the `outcome` column of the rows; a cell without a failure has "ok".
constexpr std::string_view to_outcome(Fault fault) {
  switch (fault) {
    case Fault::unsupported:
      return "refused";
    case Fault::invalid:
      return "invalid";
    case Fault::diverged:
      return "diverged";
    case Fault::blown_up:
      return "blown_up";
    case Fault::crashed:
      return "crashed";
    case Fault::timed_out:
      return "timed_out";
    case Fault::out_of_memory:
      return "out_of_memory";
  }
  return "invalid";
}

}  // namespace brickbench
