// The discrete map of compliant contacts with levers and friction: the convex problem of one step,
// solved to rounding. Closed formulas for one central contact are in scheme_map.hpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// The constants of a compliant contact at a gap (m): reference acceleration
// a_ref = -damping v_n - stiffness impedance gap, regularisation (1 - impedance)/impedance times
// the inverse masses.
struct CompliantLaw {
  double impedance = 0.0;
  double stiffness_per_s2 = 0.0;
  double damping_per_s = 0.0;
};
CompliantLaw compliant_law(const CompliantContact& contact, double gap_m, double step_s);

// Force per inverse regularisation (m/s2: times 1/R in kg it is N; contact frame: normal, two
// tangents) that answers the acceleration y = a - a_ref (m/s2), and its derivative -df/dy, which is
// symmetric. E. Todorov, "Convex and analytically-invertible dynamics with contacts and
// constraints", ICRA 2014.
struct CompliantAnswer {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
};
// circle: the point of the cone |f_t| <= mu f_n nearest to -y. inscribed: four rows
// e = n +- mu t_1, n +- mu t_2, each with the force max(0, -e.y) along e.
CompliantAnswer compliant_answer(FrictionSet set, double friction, const Eigen::Vector3d& y_mps2);

// Advances all states (bodies) by one step with the contacts of run.geometry; the points of one
// contact are alike. Semi-implicit Euler or classical Runge-Kutta, whose stages find their contacts
// anew. False, with a reason, where the scheme leaves it open.
bool advance_compliant_bodies(const Scheme& scheme, const ExactRun& run,
                              std::span<const Wrench> wrenches, std::span<State> states,
                              std::string& why);

}  // namespace brickbench::exact
