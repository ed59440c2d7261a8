// From the rows of a run to records: which kind of reference each number calls for.
//
// The number of seeds of an experiment says the kind:
//   1      the hash of all states, per cell
//   2..7   bound: the seeds are rounding-sized changes of the start; they show how far a number
//          moves when nothing changed but the last bits
//   8..    distribution
#pragma once

#include <vector>

#include "experiments/record/provenance.hpp"
#include "experiments/record/row.hpp"
#include "experiments/regression/reference.hpp"

namespace brickbench::gate {

inline constexpr std::size_t k_ensemble_seeds = 8;
// A bound is this multiple of the residual...
inline constexpr double k_bound_multiple = 10.0;
// ...and never below this share of the value, which the last digits of long sums may lose.
inline constexpr double k_bound_share = 1e-9;
// Equivalence of means: this share of the reference's mean.
inline constexpr double k_margin_share = 0.05;

Kind kind_for(std::size_t seeds);

// Groups the rows by experiment, engine, step, axes and metric. `seed_counts` maps an experiment to
// the number of seeds that its plan has, whatever was run of them. Diagnostics of engines are left
// out.
Suite observe(const std::vector<Row>& rows,
              const std::vector<std::pair<std::string, std::size_t>>& seed_counts,
              const Machine& machine);

}  // namespace brickbench::gate
