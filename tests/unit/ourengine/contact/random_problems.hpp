// Random contact problems over the whole range that the engine is offered: sizes 1 mm to 10 m,
// masses 1 g to 1 t, speeds 1 mm/s to 200 m/s, steps 1e-5 to 1/60 s, restitution 0 to 1, friction 0
// to 3, faces of up to eight redundant points, and approaches that close their gap to the last bit.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <string>

#include "tests/unit/ourengine/contact/small_problems.hpp"

namespace brickbench::testing {

enum class RandomKind { k_two_bodies, k_on_ground, k_stack, k_just_closing };

inline std::string kind_name(RandomKind kind) {
  switch (kind) {
    case RandomKind::k_two_bodies:
      return "two bodies";
    case RandomKind::k_on_ground:
      return "on the ground";
    case RandomKind::k_stack:
      return "stack";
    case RandomKind::k_just_closing:
      return "just closing";
  }
  return "unknown";
}

class RandomProblems {
 public:
  explicit RandomProblems(unsigned seed) : random_(seed) {}

  // friction: whether contacts have any.
  ContactProblem draw(RandomKind kind, bool friction) {
    problem_ = {};
    problem_.step_s = logarithmic(1e-5, 1.0 / 60.0);
    const double gravity_mps2 = coin() ? 9.81 : 0.0;
    problem_.least_speed_mps = gravity_mps2 * problem_.step_s;
    fall_mps_ = problem_.least_speed_mps;
    size_m_ = logarithmic(1e-3, 10.0);
    speed_mps_ = coin() || coin() ? logarithmic(1e-3, 200.0) : 0.0;
    friction_ = friction ? uniform(0.0, 3.0) : 0.0;
    restitution_ = coin() ? 0.0 : uniform(0.0, 1.0);
    turn_ = Eigen::Quaterniond(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))
                .normalized()
                .toRotationMatrix();
    if (kind == RandomKind::k_on_ground || kind == RandomKind::k_stack) {
      problem_.bodies.push_back(fixed_body());
      problem_.free_velocity.push_back(Velocity6::Zero());
      add_body(Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), -uniform(0, 1)), 1.0);
    } else {
      add_body(Eigen::Vector3d(0, 0, uniform(0, 1)), 1.0);
      add_body(kind == RandomKind::k_just_closing ? Eigen::Vector3d::Zero()
                                                  : Eigen::Vector3d(uniform(-1, 1), 0, -1),
               1.0);
    }
    add_face(0, 1, kind == RandomKind::k_just_closing);
    if (kind == RandomKind::k_stack) {
      const int more = std::uniform_int_distribution(1, 4)(random_);
      for (int i = 0; i < more; ++i) {
        add_body(Eigen::Vector3d(0, 0, coin() ? -uniform(0, 1) : 0.0), 0.1);
        add_face(i + 1, i + 2, false);
      }
    }
    return problem_;
  }

  bool coin() { return std::uniform_int_distribution(0, 1)(random_) == 1; }
  double uniform(double from, double to) {
    return std::uniform_real_distribution(from, to)(random_);
  }
  double logarithmic(double from, double to) {
    return from * std::pow(to / from, uniform(0.0, 1.0));
  }

 private:
  // direction: of the velocity, in units of the speed drawn, in the frame of the faces.
  void add_body(const Eigen::Vector3d& direction, double spin) {
    ProblemBody body;
    body.mass_kg = logarithmic(1e-3, 1e3);
    const Eigen::Vector3d sides(uniform(0.3, 1.0), uniform(0.3, 1.0), uniform(0.3, 1.0));
    const Eigen::Vector3d squares = (size_m_ * sides).cwiseAbs2();
    body.inertia_kgm2 =
        turn_ *
        Eigen::Vector3d(body.mass_kg / 12.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares))
            .asDiagonal() *
        turn_.transpose();
    problem_.bodies.push_back(body);
    Velocity6 velocity = Velocity6::Zero();
    velocity.head<3>() = speed_mps_ * turn_ * direction - fall_mps_ * turn_.col(2);
    if (coin())
      velocity.tail<3>() = spin * speed_mps_ / size_m_ *
                           Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    problem_.free_velocity.push_back(velocity);
  }

  Eigen::Vector3d speed_at(const ProblemContact& c) const {
    const auto at = [&](int body, const Eigen::Vector3d& arm) {
      const Velocity6& v = problem_.free_velocity[static_cast<std::size_t>(body)];
      return Eigen::Vector3d(v.head<3>() + v.tail<3>().cross(arm));
    };
    return at(c.body_b, c.arm_b_m) - at(c.body_a, c.arm_a_m);
  }

  // One to eight points where the top of body a meets the bottom of body b.
  void add_face(int a, int b, bool just_closing) {
    const int points = std::uniform_int_distribution(1, 8)(random_);
    const bool corners = coin();
    for (int i = 0; i < points; ++i) {
      Eigen::Vector3d place(i & 1 ? 0.4 : -0.4, i & 2 ? 0.4 : -0.4, 0.0);
      if (!corners) place = {uniform(-0.4, 0.4), uniform(-0.4, 0.4), 0.0};
      const Eigen::Vector3d half(0.0, 0.0, 0.5);
      ProblemContact contact = contact_between(a, b, size_m_ * turn_ * (place + half),
                                               size_m_ * turn_ * (place - half), friction_);
      contact.normal = turn_.col(2);
      contact.tangent_1 = turn_.col(0);
      contact.tangent_2 = turn_.col(1);
      const double closing_mps = contact.normal.dot(speed_at(contact));
      contact.approach_mps = closing_mps;
      contact.restitution = restitution_;
      const double reach_m = problem_.step_s * std::abs(closing_mps);
      if (just_closing) {
        const double steps[] = {0.0, 1e-16, -1e-16, 1e-11, -1e-11};
        contact.gap_m = reach_m * (1.0 + steps[std::uniform_int_distribution(0, 4)(random_)]);
      } else if (coin()) {
        contact.gap_m = uniform(-0.1, 1.0) * reach_m;
      }
      contact.id = static_cast<std::uint64_t>(problem_.contacts.size());
      problem_.contacts.push_back(contact);
    }
  }

  std::mt19937 random_;
  ContactProblem problem_;
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  double size_m_ = 1.0, speed_mps_ = 0.0, fall_mps_ = 0.0, friction_ = 0.0, restitution_ = 0.0;
};

}  // namespace brickbench::testing
