// determinism --adapter=NAME            one fingerprint per variant, on stdout
// determinism --adapter=NAME --check    compares two runs in this process with one in a second
//
// One world in one thread: what the engines do with several threads is not promised here.
#include <fmt/core.h>

#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "adapters/catalog.hpp"
#include "tests/determinism/fingerprint.hpp"

namespace brickbench::testing {
namespace {

// A line "variant hash (how it went)" for each variant.
std::string fingerprints(const Adapter& adapter) {
  std::string lines;
  for (const Variant& variant : adapter.variants) {
    std::string what;
    const std::uint64_t hash = wall_fingerprint(adapter, variant.name, what);
    lines += fmt::format("{} {:016x} ({})\n", variant.name, hash, what);
  }
  return lines;
}

std::optional<std::string> output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  if (!pipe) return std::nullopt;
  std::string output;
  std::array<char, 4096> part{};
  std::size_t size = 0;
  while ((size = fread(part.data(), 1, part.size(), pipe.get())) > 0) {
    output.append(part.data(), size);
  }
  return output;
}

int check(const Adapter& adapter, const std::string& program) {
  const std::string first = fingerprints(adapter);
  const std::string second = fingerprints(adapter);
  const auto other = output_of(fmt::format("'{}' --adapter={}", program, adapter.name));
  fmt::print("first run:\n{}second run:\n{}second process:\n{}", first, second,
             other.value_or("could not be started\n"));
  const bool equal = !first.empty() && first == second && other && first == *other;
  fmt::print("{}\n", equal ? "equal" : "NOT EQUAL");
  return equal ? 0 : 1;
}

}  // namespace
}  // namespace brickbench::testing

int main(int argc, char** argv) {
  using namespace brickbench;
  for (const Adapter& adapter : adapters()) {
    if (argc < 2 || argv[1] != "--adapter=" + adapter.name) continue;
    if (argc == 2) {
      fmt::print("{}", testing::fingerprints(adapter));
      return 0;
    }
    if (argc == 3 && argv[2] == std::string("--check")) return testing::check(adapter, argv[0]);
  }
  fmt::print(stderr, "usage: determinism --adapter=NAME [--check], with a linked adapter\n");
  return 2;
}
