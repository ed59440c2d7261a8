// Dice: random numbers that are the same on every platform, from a seed and a place.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace brickbench::hunt {

// SplitMix64 (G. Steele, D. Lea, C. Flood: Fast Splittable Pseudorandom Number Generators, 2014).
// The distributions of the standard library differ from one library to the next; these do not.
class Dice {
 public:
  // The state is a hash of all numbers and of the name, so that streams of different places do not
  // meet.
  Dice(std::initializer_list<std::uint64_t> place, std::string_view name) {
    for (const std::uint64_t number : place) state_ = next() ^ number;
    for (const char letter : name) state_ = next() ^ static_cast<unsigned char>(letter);
  }

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }
  // Uniform in [0, 1).
  double unit() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  // Uniform in the logarithm; 0 < low <= high.
  double decades(double low, double high) { return low * std::exp(unit() * std::log(high / low)); }
  bool chance(double probability) { return unit() < probability; }
  // 0 .. count - 1, count > 0.
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(unit() * static_cast<double>(count));
  }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace brickbench::hunt
