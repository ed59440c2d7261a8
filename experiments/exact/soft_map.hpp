// The discrete map of soft contacts in sub-steps: contacts of one point each, served one after the
// other, so that one sweep is a closed formula.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "experiments/exact/exact_case.hpp"

namespace brickbench::exact {

// A run of the map. The contacts of a step start from the impulses of the last one, so it has a
// memory, unlike the maps of scheme_map.hpp. The run and the scheme, which states a soft contact,
// must outlive it.
class SoftMap {
 public:
  SoftMap(const Scheme& scheme, const ExactRun& run);

  // Advances all states (bodies) by one step with the contacts (of PointContact::position_m on body
  // b) of its start; false, with a reason, where the scheme leaves it open.
  bool advance(std::span<const Wrench> wrenches, const std::vector<PointContact>& contacts,
               std::span<State> states, std::string& why);

 private:
  using Vector = Eigen::Vector3f;

  // What a contact keeps from step to step: where it was found, and what it carried last.
  struct Memory {
    std::size_t body_a = 0, body_b = 0;
    Eigen::Vector3d on_a_m, on_b_m;  // body frames
    Eigen::Vector3d normal_in_a;
    Eigen::Vector3d between_in_a_m;
    Eigen::Quaterniond b_in_a;
    double found_within_m = 0.0;
    float impulse_ns = 0.0F;  // per sub-step
    Vector friction_ns = Vector::Zero();
  };
  // Single precision, as the scheme states for what happens within a step.
  struct Side {
    std::size_t body = 0;
    bool fixed = true;
    float inverse_mass = 0.0F;
    Eigen::Matrix3f inverse_inertia = Eigen::Matrix3f::Zero();
    Vector lever = Vector::Zero();
  };
  struct Row {
    Memory* memory = nullptr;
    int colour = 0;
    Side a, b;
    Vector normal, tangent_1, tangent_2;
    float mass = 0.0F;
    float gap_m = 0.0F, gap_now_m = 0.0F;
    float impulse_ns = 0.0F, largest_ns = 0.0F, bounce_mps = 0.0F;
    float friction = 0.0F;
    Eigen::Matrix2f friction_mass;
    Eigen::Vector2f friction_ns;
  };
  struct Twist {  // linear and angular part
    Vector linear = Vector::Zero(), angular = Vector::Zero();
  };

  double reach_m(std::size_t body, const State& state) const;
  bool still_holds(const Memory& memory, double margin_m, std::span<const State> states) const;
  Memory found(const PointContact& contact, double reach_m, std::span<const State> states) const;
  void remember(const std::vector<PointContact>& contacts, std::span<const State> states);
  Side side(std::size_t body, const Eigen::Vector3d& lever_m, const State& state) const;
  void make_rows(std::span<const State> states);
  void prepare(Row& row) const;
  // Adds what the impulse (N s) on b along the unit vector `direction`, and its reaction, change.
  static void push(const Row& row, const Vector& direction, float impulse_ns,
                   std::vector<Twist>& twists);
  // Of b against a along the unit vector `direction`, at the contact.
  static float slip(const Row& row, const Vector& direction, const std::vector<Twist>& twists);
  void serve(Row& row, bool biased);
  void sweep(bool biased, bool forwards);
  void bounce();
  void finish(std::span<const Wrench> wrenches, std::span<State> states);

  const Scheme& scheme_;
  const SoftContact& soft_;
  const ExactRun& run_;
  std::vector<Memory> memories_;  // sorted by pair
  std::vector<Row> rows_;         // sorted by colour
  std::vector<Twist> velocity_, moved_;
};

}  // namespace brickbench::exact
