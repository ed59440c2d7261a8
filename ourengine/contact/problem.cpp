#include "ourengine/contact/problem.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace ourengine {
namespace {

constexpr double kFrameTolerance = 1e-6;

std::string body_error(const ProblemBody& body, const Velocity6& velocity) {
  if (!velocity.allFinite()) return "free velocity is not finite";
  if (body.fixed) return "";
  if (!(body.mass_kg > 0.0) || !std::isfinite(body.mass_kg)) return "mass is not positive";
  if (!body.inertia_kgm2.allFinite()) return "inertia is not finite";
  const double scale = body.inertia_kgm2.norm();
  if ((body.inertia_kgm2 - body.inertia_kgm2.transpose()).norm() > kFrameTolerance * scale)
    return "inertia is not symmetric";
  if (body.inertia_kgm2.llt().info() != Eigen::Success) return "inertia is not positive definite";
  return "";
}

std::string contact_error(const ProblemContact& contact, int bodies) {
  if (contact.body_a < 0 || contact.body_a >= bodies || contact.body_b < 0 ||
      contact.body_b >= bodies)
    return "body index out of range";
  if (contact.body_a == contact.body_b) return "a body touches itself";
  Eigen::Matrix3d frame;
  frame << contact.normal, contact.tangent_1, contact.tangent_2;
  const double error = (frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm();
  if (!(error < kFrameTolerance)) return "frame is not orthonormal";
  if (!contact.arm_a_m.allFinite() || !contact.arm_b_m.allFinite()) return "arm is not finite";
  if (!std::isfinite(contact.gap_m) || !std::isfinite(contact.approach_mps))
    return "gap or approach velocity is not finite";
  if (!(contact.friction >= 0.0) || !std::isfinite(contact.friction)) return "friction below 0";
  if (!(contact.restitution >= 0.0 && contact.restitution <= 1.0))
    return "restitution outside 0 .. 1";
  return "";
}

}  // namespace

double normal_bias_mps(const ProblemContact& contact, double step_s, double recovery_mps) {
  const double gap_mps = std::max(contact.gap_m / step_s, -recovery_mps);
  const bool touches = contact.gap_m + contact.approach_mps * step_s <= 0.0;
  if (!touches || contact.approach_mps >= 0.0) return gap_mps;
  return contact.restitution > 0.0 ? std::min(gap_mps, contact.restitution * contact.approach_mps)
                                   : gap_mps;
}

std::string problem_error(const ContactProblem& problem) {
  if (!(problem.step_s > 0.0) || !std::isfinite(problem.step_s)) return "step_s is not positive";
  if (!(problem.recovery_mps >= 0.0)) return "recovery_mps is below 0";
  if (!(problem.least_speed_mps >= 0.0) || !std::isfinite(problem.least_speed_mps))
    return "least_speed_mps is below 0 or not finite";
  if (problem.free_velocity.size() != problem.bodies.size())
    return "free_velocity and bodies differ in number";
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    const std::string error = body_error(problem.bodies[i], problem.free_velocity[i]);
    if (!error.empty()) return "body " + std::to_string(i) + ": " + error;
  }
  const int bodies = static_cast<int>(problem.bodies.size());
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const std::string error = contact_error(problem.contacts[i], bodies);
    if (!error.empty()) return "contact " + std::to_string(i) + ": " + error;
  }
  return "";
}

}  // namespace ourengine
