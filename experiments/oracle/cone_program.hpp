// The distance from a given momentum change to the set of those that contact impulses can make.
//
//   minimise |b - A x|  over  x = (impulses of all contacts), each in its Coulomb cone
//   K = { (n, t) : |t| <= mu n },
//
// a second-order cone program. It is solved by a barrier method, which has a property that
// first-order methods lack: at every centred point the residual r = b - A x lies strictly within
// the polar cone of A K, because A^T r = kappa grad(barrier). So a lower bound of the distance is
// had by weak duality from numbers that can be checked one by one (Boyd and Vandenberghe, Convex
// Optimization, 2004, sections 5.9 and 11.6): for any r with A_i^T r in the polar cone of K_i for
// all contacts i,
//   |b - A x| >= b.r / |r|   for all admissible x.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace brickbench::gate {

// A point where body b may push away from body a; index `none` for a body that cannot move.
struct ConeContact {
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::size_t body_a = none;
  std::size_t body_b = none;
  Eigen::Vector3d arm_a_m = Eigen::Vector3d::Zero();  // from the centre of mass, world frame
  Eigen::Vector3d arm_b_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from a towards b
  double friction = 0.0;
};

// What contacts must explain: momentum changes of the bodies that can move.
struct ConeProblem {
  std::vector<Eigen::Vector3d> linear_ns;    // (bodies)
  std::vector<Eigen::Vector3d> angular_nms;  // (bodies), about the centre of mass, world frame
  std::vector<double> gyration_m;  // (bodies) > 0: turns N m s into N s, so that both can be added
  std::vector<ConeContact> contacts;
};

struct ConeSolution {
  // The residual that the impulses below leave, sqrt(sum |dp|^2 + |dL|^2 / gyration^2), in N s: an
  // upper bound of the smallest possible one.
  double residual_ns = 0.0;
  // A proven lower bound; 0 where nothing could be proven.
  double bound_ns = 0.0;
  std::vector<Eigen::Vector3d> impulses_ns;           // (contacts), on body b, world frame
  std::vector<Eigen::Vector3d> linear_residual_ns;    // (bodies), unexplained
  std::vector<Eigen::Vector3d> angular_residual_nms;  // (bodies), unexplained
  int iterations = 0;
};

// Stops when upper and lower bound are within `gap_ns`, or when rounding forbids more.
ConeSolution solve(const ConeProblem& problem, double gap_ns);

// Checks the two claims of a solution from scratch, sharing nothing with the solver but the
// problem: every impulse in its cone, the residual as stated; the residual within the polar cone.
// Returns {upper bound, lower bound}; the first is infinite if an impulse is not admissible, the
// second 0 if the residual proves nothing.
struct ConeBounds {
  double upper_ns = 0.0;
  double lower_ns = 0.0;
};
ConeBounds certify(const ConeProblem& problem, const ConeSolution& solution);

}  // namespace brickbench::gate
