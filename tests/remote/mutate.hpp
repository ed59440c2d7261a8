// Deterministic damage to bytes.
#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace brickbench::testing {

// One to four changes: a byte, a bit, a cut, a repetition, a number of extreme size.
inline std::string mutated(std::string bytes, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % (n + 1)); };
  for (std::size_t change = 0, changes = 1 + below(3); change < changes; ++change) {
    if (bytes.empty()) bytes = "x";
    const std::size_t at = below(bytes.size() - 1);
    switch (random() % 6) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << (random() % 8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, below(64)));
        break;
      case 4:
        bytes.insert(at, 1 + below(4096), "[{0\"-\\"[random() % 6]);
        break;
      default:
        for (std::size_t i = at; i < bytes.size() && i < at + 8; ++i) {
          bytes[i] = static_cast<char>(random() % 2 == 0 ? 0xff : 0x7f);
        }
    }
  }
  return bytes;
}

}  // namespace brickbench::testing
