// Shrink: the smallest and roundest trial that still breaks the same law in the same engine.
#pragma once

#include <functional>

#include "experiments/hunt/judge.hpp"

namespace brickbench::hunt {

// The verdict on a trial: judge() in a process of its own, or in tests anything.
using Judge = std::function<Verdict(const Trial&)>;

struct Shrunk {
  Trial trial;
  Verdict verdict;         // on it; it breaks the oracle
  std::size_t probes = 0;  // trials that were run
};

// Tries in turn, as long as anything helps and probes are left: fewer knobs, parameters at their
// defaults, lower counts (below their defaults too), fewer steps, rounder and larger steps, numbers
// of one digit, then two. A change stays if `oracle` is still broken. No turn undoes what another
// did, so the search ends by itself.
Shrunk shrink(const Trial& trial, const Verdict& verdict, std::string_view oracle,
              const Catalogues& catalogues, const Judge& judge, std::size_t most_probes);

}  // namespace brickbench::hunt
