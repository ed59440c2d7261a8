// Flags: why the numbers of a run are not to be trusted although it went to its end.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace brickbench {

enum class Flag : std::uint8_t {
  unsolved,          // the solver gave up or missed its tolerance
  clamped,           // a state was cut to what the engine can hold
  overlap_left,      // an overlap that the engine wanted to prevent was left over
  contacts_dropped,  // contacts were found and left out of the step
  tunnelled,         // a body passed another: seen in recorded poses, told by no engine
};

inline constexpr std::array k_all_flags = {Flag::unsolved, Flag::clamped, Flag::overlap_left,
                                           Flag::contacts_dropped, Flag::tunnelled};

// The word of rows and reports.
constexpr std::string_view to_word(Flag flag) {
  switch (flag) {
    case Flag::unsolved:
      return "unsolved";
    case Flag::clamped:
      return "clamped";
    case Flag::overlap_left:
      return "overlap_left";
    case Flag::contacts_dropped:
      return "contacts_dropped";
    case Flag::tunnelled:
      return "tunnelled";
  }
  return "unsolved";
}

// A set of flags.
class Flags {
 public:
  constexpr Flags() = default;
  template <typename... Members>
  constexpr explicit Flags(Flag first, Members... others) {
    raise(first);
    (raise(others), ...);
  }
  constexpr void raise(Flag flag, bool condition = true) {
    if (condition) bits_ = static_cast<std::uint8_t>(bits_ | bit(flag));
  }
  constexpr bool has(Flag flag) const { return (bits_ & bit(flag)) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  constexpr bool operator==(const Flags&) const = default;

 private:
  static constexpr unsigned bit(Flag flag) { return 1U << static_cast<unsigned>(flag); }
  std::uint8_t bits_ = 0;
};

}  // namespace brickbench
