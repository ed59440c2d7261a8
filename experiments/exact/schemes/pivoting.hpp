// Principal pivoting in the order of the rows, as engines document it that drive one row at a time.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "adapters/seam/world.hpp"
#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// x >= 0 (rows) with w = A x - b >= 0 and x . w = 0 as Dantzig's algorithm finds it: row after row
// is driven to the line while those before stay on it. A pivot of length zero (an earlier row with
// x = w = 0 that the drive would push below the line) ends it: the rows before keep their x, this
// and all later ones get 0. R. Smith, Open Dynamics Engine, comment "THE ALGORITHM" of lcp.cpp, and
// its message "LCP internal error, s <= 0". A: symmetric and positive definite.
Eigen::VectorXd pivot_in_order(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

// Contacts in the order in which a walk over an island meets them: from the last moving body on, at
// each body the contacts made last come first (R. Smith, Open Dynamics Engine, util.cpp,
// dxProcessIslands). `contacts` are in the order in which they were made.
std::vector<std::size_t> island_order(const World& world, std::span<const PointContact> contacts);

}  // namespace brickbench::exact
