// Losses: every number in which an engine of this project is not the best of a block.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/record/provenance.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {

struct Loss {
  std::string number;
  std::string scene;
  std::string ours;
  double ours_value = 0.0;
  std::string best;
  double best_value = 0.0;
  std::optional<double> ratio;  // ours / best; none where best is 0
  bool rounding = false;        // the two differ by no more than k_rounding
};

struct LossTable {
  // The largest |log ratio| first, those without ratio at the very top, rounding at the end.
  std::vector<Loss> rows;
  std::size_t compared = 0;  // numbers with a direction in which ours and another have a valid one
  std::size_t flagged = 0;   // further ones, where one side has none but flagged ones
  std::size_t rounding = 0;  // rows that are rounding
};

std::vector<std::string> own_engines(const Provenance& provenance);

// Index of the best of our own contenders in number n of the block; none if none has a value.
std::optional<std::size_t> best_of_own(const Block& block, std::size_t n,
                                       std::span<const std::string> own);

// In each block the best variant of our engines stands for us, per number.
LossTable losses(std::span<const Block> blocks, std::span<const std::string> own);

}  // namespace brickbench
