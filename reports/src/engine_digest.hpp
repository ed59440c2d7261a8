// A whole run on one screen: each engine's cost, the laws that it broke and what it refused.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/record/row.hpp"
#include "experiments/record/timing.hpp"
#include "reports/src/table.hpp"

namespace brickbench {

// Energy out of nothing, and momentum without a force, up to this share of what there is, are
// rounding: sums of double precision end at 1e-11, states of single precision move 1e-7.
inline constexpr double k_law_share = 1e-6;
// Overlap up to this share of the smallest edge is what a contact may give way; as in `oracle
// laws`.
inline constexpr double k_overlap_share = 1e-3;

enum class Law { energy, momentum, overlap, passage };

// How badly a law was broken where it was broken worst.
struct Breach {
  Law law = Law::energy;
  double share = 0.0;  // of the energy or momentum that there is, or of the smallest edge
  double value = 0.0;  // in `unit`
  std::string unit;
  std::string where;  // scene of the worst
  std::size_t cells = 0;
};

struct EngineDigest {
  std::string label;
  std::size_t cells = 0;
  std::size_t ran = 0;  // to their end
  std::size_t flagged = 0;
  std::size_t refused = 0;
  double cpu_s = 0.0;        // of the engine, over the cells that ran to their end unflagged
  double simulated_s = 0.0;  // by those
  std::optional<double> energy_share;  // the worst
  std::optional<double> overlap_m;
  std::vector<Breach> breaches;

  // CPU seconds per simulated second; none if no cell is to be timed.
  std::optional<double> cost() const;
};

// `smallest_edge_m`: of the bodies that move, by cell; where a cell is not in it no overlap is a
// breach. The fastest first, then those without a time.
std::vector<EngineDigest> engine_digests(std::span<const Row> rows, std::span<const Timing> timings,
                                         const std::map<std::string, double>& smallest_edge_m);

// One row per engine, at most `most`.
Table engine_table(std::span<const EngineDigest> engines, std::size_t most);

// One sentence per law that was broken, with who broke it; or that none was.
std::vector<std::string> breach_lines(std::span<const EngineDigest> engines);

// Who is fastest, and who is fastest of those that broke no law; "" if nothing was timed.
std::string fastest_line(std::span<const EngineDigest> engines);

// Flagged runs, refusals and other ends, one line per kind and engine, at most `most`, and how many
// more.
std::vector<std::string> ending_lines(std::span<const Row> rows, std::size_t most);

}  // namespace brickbench
