// What impulses at the points of touching bodies do, and the hits that the discrete map of
// sequential_map.hpp gives them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "experiments/exact/schemes/sequential_map.hpp"

namespace brickbench::exact {

// What a pair of bodies does at a point, with the levers to it.
class TouchingPair {
 public:
  // All three must outlive it.
  TouchingPair(const ExactRun& run, const TouchingPoint& point, std::span<const State> states)
      : run_(run), point_(point), states_(states) {}

  // From the centre of body i to the point; zero where both bodies are met centrally.
  Eigen::Vector3d lever_m(std::size_t i) const;
  // (m/s) along the normal, positive when separating.
  double velocity_mps() const { return point_.normal.dot(slip_mps()); }
  Eigen::Vector3d slip_mps() const {
    return velocity_of(point_.body_b) - velocity_of(point_.body_a);
  }
  bool moves(std::size_t i) const { return !run_.world.bodies[i].fixed; }
  double sign(std::size_t i) const {
    return i == point_.body_b ? 1.0 : i == point_.body_a ? -1.0 : 0.0;
  }
  // Change of the spin per unit of impulse along the normal on b.
  Eigen::Vector3d turn(std::size_t i) const {
    return inverse_inertia(i, sign(i) * lever_m(i).cross(point_.normal));
  }
  Eigen::Vector3d inverse_inertia(std::size_t i, const Eigen::Vector3d& moment) const;
  const TouchingPoint& point() const { return point_; }

 private:
  Eigen::Vector3d velocity_of(std::size_t i) const;

  const ExactRun& run_;
  const TouchingPoint& point_;
  std::span<const State> states_;
};

// Gives the impulse (N s) along the normal to b, and its opposite to a.
void push(const ExactRun& run, const TouchingPoint& point, double impulse_ns,
          std::span<State> states);

// (points, points): what an impulse of 1 N s at j changes in the normal velocity of i, 1/kg.
Eigen::MatrixXd responses(const ExactRun& run, const std::vector<TouchingPoint>& points,
                          std::span<const State> states);

// x >= 0 with A x + b >= 0 and x . (A x + b) = 0, A symmetric and at least semidefinite: projected
// Gauss-Seidel to rounding. What A x is does not depend on which x is found. nullopt: no end.
std::optional<Eigen::VectorXd> complementarity(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

// The hits of a step, in the order that the law states; false, with a reason, if they do not end.
bool hit_all(const SequentialContact& law, const ExactRun& run,
             const std::vector<TouchingPoint>& points, std::span<State> states, std::string& why);

}  // namespace brickbench::exact
