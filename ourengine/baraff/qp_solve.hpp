// The frictionless contact forces: f >= 0, a = A f + b >= 0, f . a = 0 (componentwise).
//
// Source: D. Baraff, Fast contact force computation for nonpenetrating rigid bodies, SIGGRAPH 1994,
// section 4 (compute-forces, drive-to-zero, fdirection, maxstep); H. Darji, P. Alur, Explosion
// Simulator, "Resting Contact" (QP_Solve). The clamped set C holds contacts with f > 0, a = 0, NC
// those with f = 0, a >= 0.
// Departures:
//  * A_CC is kept as a Cholesky factor that grows by a row and shrinks by Givens rotations.
//  * The contact driven next is the one with the most negative acceleration; Baraff leaves it open.
//  * A of a wall is singular. A contact whose Schur pivot is below 1e-11 A_dd depends on C and
//  never
//    enters it: C changes by the contacts that leave. A change of an acceleration below
//    1e-7 sqrt(A_ii A_dd) stops no step.
//  * Ties in maxstep: among all contacts that would stop a step within 1e-12 s of each other,
//    the one that changes fastest does (P. M. J. Harris, Pivot selection methods of the Devex LP
//    code, Math. Programming 5 (1973)). This keeps a 10x10 wall from cycling.
//  * An acceleration above -1e-11 s counts as not negative, s the larger of max|b| and the size of
//    the terms that b is the sum of: where these cancel, b is nothing but their rounding.
//  * Where this ends above a residual of 1e-9 the same method runs on A + 1e-9 diag(A), which is
//    regular; `retried` says so. The clamped forces are then corrected for A itself, and the better
//    of both results is returned; residuals are always those of A.
//  * At most 4 n + 100 pivots per try. A residual above 1e-6 is a failure and reported as such.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace ourengine::baraff {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

struct QpResult {
  Eigen::VectorXd force;         // (contacts)
  Eigen::VectorXd acceleration;  // (contacts), A f + b computed from the final f
  double residual = 0.0;         // max |min(A_ii f_i, a_i)| / s; infinite if not finite
  int pivots = 0;                // changes of the clamped set
  int zero_steps = 0;            // pivots of length zero
  bool retried = false;          // on the regularised matrix
  bool failed = false;           // residual above 1e-6 or not finite
};

// A: (contacts, contacts) symmetric positive semidefinite; b: (contacts); term_size: of the terms
// of b, in its unit, see s above.
QpResult qp_solve(const SparseMatrix& a_matrix, const Eigen::VectorXd& b, double term_size = 0.0);

// max |min(A_ii f_i, a_i)| / s: zero exactly when all three conditions hold.
double complementarity_residual(const SparseMatrix& a_matrix, const Eigen::VectorXd& b,
                                const Eigen::VectorXd& force, const Eigen::VectorXd& acceleration,
                                double term_size = 0.0);

}  // namespace ourengine::baraff
