// Engines that take their process down with them, or hold it up: for whatever isolates them.
#pragma once

#include <fmt/core.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <string>

#include "tests/unit/run/fakes.hpp"

namespace brickbench::testing {

enum class Trouble { segfault, abort, hang, exit, eats_memory, chatter, killed, slow };

// Falls freely as FakeSimulation does, until its third step.
template <Trouble trouble>
class TroubledSimulation final : public FakeSimulation<Mishap::none> {
 public:
  using FakeSimulation::FakeSimulation;

  Expected<void> step() override {
    ++steps_;
    if constexpr (trouble == Trouble::slow) ::usleep(400);
    if (steps_ == 3) befall();
    return FakeSimulation::step();
  }

 private:
  void befall() const {
    if constexpr (trouble == Trouble::segfault) {
      fmt::print(stderr, "about to touch nothing\n");
      std::fflush(stderr);
      (void)std::raise(SIGSEGV);
    } else if constexpr (trouble == Trouble::abort) {
      fmt::print("assertion failed\n");
      std::fflush(stdout);
      std::abort();
    } else if constexpr (trouble == Trouble::hang) {
      while (true) ::usleep(1000);
    } else if constexpr (trouble == Trouble::exit) {
      std::_Exit(0);
    } else if constexpr (trouble == Trouble::eats_memory) {
      // Far more than any limit of the tests, in pieces, as a program that leaks does.
      for (int piece = 0; piece < 4096; ++piece) {
        // volatile: a compiler may leave out memory that nobody reads.
        char* volatile memory = new char[std::size_t{16} << 20U];
        std::fill_n(static_cast<char*>(memory), 4096, 'x');
      }
    } else if constexpr (trouble == Trouble::chatter) {
      for (int line = 0; line < 100000; ++line) fmt::print("line {}\n", line);
      throw std::runtime_error("talked too much");
    } else if constexpr (trouble == Trouble::killed) {
      (void)std::raise(SIGKILL);
    }
  }
  int steps_ = 0;
};

template <Trouble trouble>
Adapter troubled_adapter(std::string name) {
  Adapter adapter = fake_adapter<Mishap::none>(std::move(name));
  adapter.build = [](const World& world,
                     const Settings& settings) -> Expected<std::unique_ptr<Simulation>> {
    return std::make_unique<TroubledSimulation<trouble>>(world, settings);
  };
  return adapter;
}

// The tiny world of the fakes with the engines above on top.
inline Catalogues troubled_catalogues() {
  Catalogues catalogues = fake_catalogues();
  for (Adapter adapter :
       {troubled_adapter<Trouble::segfault>("segfault"), troubled_adapter<Trouble::abort>("abort"),
        troubled_adapter<Trouble::hang>("hang"), troubled_adapter<Trouble::exit>("exit"),
        troubled_adapter<Trouble::eats_memory>("eater"),
        troubled_adapter<Trouble::chatter>("chatter"), troubled_adapter<Trouble::killed>("killed"),
        troubled_adapter<Trouble::slow>("slow")}) {
    catalogues.known_engines.push_back(adapter.name);
    catalogues.adapters.push_back(std::move(adapter));
  }
  return catalogues;
}

}  // namespace brickbench::testing
