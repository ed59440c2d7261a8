// Small contact problems with known or comparable solutions, and what tests compare of them.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <random>
#include <vector>

#include "ourengine/contact/problem.hpp"

namespace brickbench::testing {

using ourengine::ContactProblem;
using ourengine::ContactSolution;
using ourengine::ProblemBody;
using ourengine::ProblemContact;
using ourengine::Velocity6;

inline ProblemBody fixed_body() { return {1.0, Eigen::Matrix3d::Identity(), true}; }

inline ProblemContact contact_between(int a, int b, const Eigen::Vector3d& arm_a,
                                      const Eigen::Vector3d& arm_b, double friction) {
  ProblemContact contact;
  contact.body_a = a;
  contact.body_b = b;
  contact.arm_a_m = arm_a;
  contact.arm_b_m = arm_b;
  contact.friction = friction;
  return contact;
}

// A unit point mass on the floor with one contact below its centre.
inline ContactProblem point_on_floor(const Eigen::Vector3d& velocity_mps, double friction) {
  ContactProblem problem;
  problem.bodies = {fixed_body(), ProblemBody{}};
  Velocity6 free = Velocity6::Zero();
  free.head<3>() = velocity_mps;
  problem.free_velocity = {Velocity6::Zero(), free};
  problem.contacts = {
      contact_between(0, 1, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), friction)};
  return problem;
}

// A tower of cubes with random masses, tilted frames, offsets and velocities; four contacts per
// joint, so that the contact matrix is rank deficient from the second contact face on.
inline ContactProblem random_tower(int cubes, double friction, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&] {
    return Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
  };
  ContactProblem problem;
  problem.step_s = 0.01;
  problem.bodies.push_back(fixed_body());
  problem.free_velocity.push_back(Velocity6::Zero());
  for (int i = 0; i < cubes; ++i) {
    ProblemBody body;
    body.mass_kg = 1.0 + 0.5 * uniform(random);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(uniform(random), vector().normalized()).toRotationMatrix();
    body.inertia_kgm2 =
        body.mass_kg / 6.0 * turn * Eigen::Vector3d(1.0, 1.2, 0.9).asDiagonal() * turn.transpose();
    problem.bodies.push_back(body);
    Velocity6 velocity;
    velocity << 0.3 * vector(), 0.5 * vector();
    velocity[2] -= 0.1;
    problem.free_velocity.push_back(velocity);
    const Eigen::Vector3d shift(0.1 * uniform(random), 0.1 * uniform(random), 0.0);
    const Eigen::Matrix3d frame =
        Eigen::AngleAxisd(0.05 * uniform(random), vector().normalized()).toRotationMatrix();
    for (int q = 0; q < 4; ++q) {
      const Eigen::Vector3d corner(q & 1 ? 0.4 : -0.4, q & 2 ? 0.4 : -0.4, 0.0);
      ProblemContact contact =
          contact_between(i, i + 1, corner + shift + Eigen::Vector3d(0.0, 0.0, i == 0 ? 0.0 : 0.5),
                          corner - Eigen::Vector3d(0.0, 0.0, 0.5), friction);
      contact.normal = frame.col(2);
      contact.tangent_1 = frame.col(0);
      contact.tangent_2 = frame.col(1);
      contact.gap_m = 1e-3 * std::max(0.0, uniform(random));
      contact.id = static_cast<std::uint64_t>(4 * i + q);
      problem.contacts.push_back(contact);
    }
  }
  return problem;
}

// Impulse and angular impulse of all contacts on each body, N s and N m s.
inline std::vector<Velocity6> body_impulses(const ContactProblem& problem,
                                            const ContactSolution& solution) {
  std::vector<Velocity6> sums(problem.bodies.size(), Velocity6::Zero());
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const ProblemContact& c = problem.contacts[i];
    const Eigen::Vector3d& f = solution.impulse_ns[i];
    const Eigen::Vector3d world = f[0] * c.normal + f[1] * c.tangent_1 + f[2] * c.tangent_2;
    Velocity6& a = sums[static_cast<std::size_t>(c.body_a)];
    Velocity6& b = sums[static_cast<std::size_t>(c.body_b)];
    a.head<3>() -= world;
    a.tail<3>() -= c.arm_a_m.cross(world);
    b.head<3>() += world;
    b.tail<3>() += c.arm_b_m.cross(world);
  }
  return sums;
}

// Largest difference of two lists of 6-vectors.
inline double largest_difference(const std::vector<Velocity6>& x, const std::vector<Velocity6>& y) {
  double worst = x.size() == y.size() ? 0.0 : HUGE_VAL;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
    worst = std::max(worst, (x[i] - y[i]).cwiseAbs().maxCoeff());
  return worst;
}

inline double largest_entry(const std::vector<Velocity6>& x) {
  double worst = 0.0;
  for (const Velocity6& entry : x) worst = std::max(worst, entry.cwiseAbs().maxCoeff());
  return worst;
}

}  // namespace brickbench::testing
