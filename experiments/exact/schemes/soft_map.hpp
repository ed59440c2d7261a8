// The discrete map of soft contacts in sub-steps. Bodies touch in manifolds of up to four points,
// whose order is part of the scheme, and everything is served one after the other: one sweep is a
// closed formula.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "adapters/seam/simulation.hpp"
#include "experiments/exact/cases/exact_case.hpp"
#include "experiments/exact/schemes/sequential_map.hpp"

namespace brickbench::exact {

// The contacts of all pairs of which one moves.
// Empty where a pair is not listed: a second body must be a ball, or a box on a box or a plane.
ContactGeometry all_pairs(const World& world);

// A run of the map. The contacts of a step start from the impulses of the last one, so it has a
// memory, unlike the maps of scheme_map.hpp. The scheme, which states a soft contact, must outlive
// it.
class SoftMap {
 public:
  SoftMap(const Scheme& scheme, const ExactRun& run);

  // Advances all states (bodies) by one step; false, with a reason, where the scheme leaves it
  // open. The points of a pair are those of touching_points(), in that order; where the case names
  // no contacts, all pairs are looked at.
  bool advance(std::span<const Wrench> wrenches, std::span<State> states, std::string& why);

  // What the last step applied: friction shared evenly, the twist in proportion to the distance.
  std::vector<Contact> contacts() const;

  // How often a sub-step's sweeps were repeated in the last step, blows apart: twice as often as
  // long as they leave a known contact too deep, up to the scheme's limit.
  int sweeps() const { return sweeps_; }

 private:
  using Vector = Eigen::Vector3f;
  static constexpr std::size_t k_points = 4;

  // What a manifold keeps from step to step: where it was found, and what it carried last.
  struct Memory {
    std::size_t body_a = 0, body_b = 0;
    std::size_t count = 0;                                 // of points
    std::array<Eigen::Vector3d, k_points> on_a_m, on_b_m;  // body frames
    Eigen::Vector3d normal_in_a;
    Eigen::Vector3d between_in_a_m;
    Eigen::Quaterniond b_in_a;
    double found_within_m = 0.0;
    std::array<float, k_points> impulse_ns = {};  // per sub-step
    Vector friction_ns = Vector::Zero();
    float twist_ns = 0.0F;
  };
  // Single precision, as the scheme states for what happens within a step.
  struct Side {
    std::size_t body = 0;
    bool fixed = true;
    float inverse_mass = 0.0F;
    Eigen::Matrix3f inverse_inertia = Eigen::Matrix3f::Zero();
  };
  // A direction at a place: lever x direction, and what an impulse there changes in the spin.
  struct Arm {
    Vector on_a = Vector::Zero(), on_b = Vector::Zero();
    Vector turn_a = Vector::Zero(), turn_b = Vector::Zero();
  };
  struct Point {
    Vector lever_a, lever_b;
    Arm arm;
    float mass = 0.0F;
    float gap_m = 0.0F, gap_now_m = 0.0F;
    float impulse_ns = 0.0F, largest_ns = 0.0F;
    double approach_mps = 0.0;  // at the step's start; 0: too slow to be a hit
    float bounce_mps = 0.0F;    // what Newton's law makes of it
    float total_ns = 0.0F;      // of the step
    float carried_ns = 0.0F;    // what it began the sub-step with
    Contact view;               // at the start of the step
    bool pushed() const { return largest_ns > 0.0F; }
    bool struck() const { return pushed() && approach_mps > 0.0; }
    bool bounced() const { return pushed() && bounce_mps > 0.0F; }
  };
  struct Row {
    Memory* memory = nullptr;
    int colour = 0;
    double reach_m = 0.0;
    Side a, b;
    Vector normal;
    std::array<Vector, 2> tangent;
    std::vector<Point> points;
    float friction = 0.0F;
    std::array<Arm, 2> friction_arm;  // at the middle of the points
    float friction_mass_11 = 0.0F, friction_mass_22 = 0.0F, friction_mass_12 = 0.0F;
    std::array<float, 2> friction_ns = {}, friction_total_ns = {};
    Arm twist;  // about the normal
    float twist_mass = 0.0F, twist_lever_m = 0.0F, twist_ns = 0.0F;
    float twist_total_ns = 0.0F;
    float weight_ns = 0.0F;  // of both bodies with what pulls on them, per sub-step
  };
  struct Twist {  // linear and angular part
    Vector linear = Vector::Zero(), angular = Vector::Zero();
  };
  struct Motion {  // the same in double precision, once the sub-steps are done
    Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
  };
  // A row in double precision, and what it gave in the whole step.
  struct FirmArm {
    Eigen::Vector3d on_a, on_b, turn_a, turn_b;
  };
  struct Firm {
    Row* row = nullptr;
    double mass_a = 0.0, mass_b = 0.0;  // inverse
    Eigen::Vector3d normal;
    std::array<Eigen::Vector3d, 2> tangent;
    std::vector<Point*> points;  // that were pushed
    std::vector<FirmArm> arms;
    std::array<FirmArm, 2> slide;
    FirmArm twist;
    std::vector<double> target_mps, given_ns;
    Eigen::Matrix2d response, mass;
    Eigen::Vector2d friction_ns;
    double twist_nms = 0.0, twist_lever_m = 0.0;
  };
  struct Iterate {
    std::vector<Firm> rows;
    std::vector<Motion> motions;
  };
  enum class Law { none, plastic, bounce };
  struct Islands {
    std::vector<std::size_t> of;  // (bodies) the first body of the island
    std::vector<bool> touched, grounded;
    std::vector<Law> law;  // that the island was held to
  };
  using Points = std::span<const TouchingPoint>;  // of one pair

  // soft_memory.cpp: which contacts the step has.
  double reach_m(std::size_t body, const State& state, const Wrench& wrench) const;
  double thinner_m(std::size_t body_a, std::size_t body_b) const;
  bool still_holds(const Memory& memory, double margin_m, std::span<const State> states) const;
  Memory found(Points points, double reach_m, std::span<const State> states) const;
  void inherit(const Memory& old, Memory& next) const;
  bool remember(std::span<const Wrench> wrenches, std::span<const State> states, std::string& why);
  bool fill_points(Row& row, std::span<const State> states) const;
  float weight_ns(const Memory& memory, std::span<const Wrench> wrenches) const;
  void make_rows(std::span<const Wrench> wrenches, std::span<const State> states);

  // soft_map.cpp: what they do.
  Side side(std::size_t body, const State& state) const;
  Arm arm(const Row& row, const Vector& lever_a, const Vector& lever_b,
          const Vector& direction) const;
  void prepare(Row& row) const;
  void prepare_friction(Row& row) const;
  static void shift(const Row& row, const Vector& direction, float impulse_ns,
                    std::vector<Twist>& twists);
  static void turn(const Row& row, const Arm& arm, float impulse_ns, std::vector<Twist>& twists);
  static float apart(const Row& row, const Vector& direction, const std::vector<Twist>& twists);
  static float turning(const Row& row, const Arm& arm, const std::vector<Twist>& twists);
  float serve_points(Row& row, bool biased);
  void serve_friction(Row& row, float load_ns);
  void serve_twist(Row& row, float load_ns);
  void sweep(bool biased, bool forwards);
  void count();
  bool has_blow() const;
  void drop_blows(std::vector<Twist>& flown);
  void run_substeps(std::span<const Wrench> wrenches, std::span<const State> states);
  double too_deep_m(std::size_t body_a, std::size_t body_b) const;
  bool leaves_too_deep() const;
  bool overlooks(std::span<const State> ends) const;

  // soft_laws.cpp: the laws of impact for the whole step.
  Eigen::Vector3d spin_change(std::size_t body, const State& state,
                              const Eigen::Vector3d& moment_nms) const;
  Firm firm(Row& row, std::span<const State> states) const;
  std::vector<Motion> given(std::span<const Wrench> wrenches, std::span<const State> states);
  double settle_normals(Firm& row, double enough_mps, std::vector<Motion>& motions) const;
  static double settle_friction(Firm& row, std::vector<Motion>& motions);
  static double beyond(double share, double now, double& last);
  void extrapolate(double share, std::vector<Firm>& rows, std::vector<Motion>& motions,
                   Iterate& before) const;
  double sweep_once(int sweep, double enough_mps, std::vector<Firm>& rows,
                    std::vector<Motion>& motions, std::vector<int>& moved_in) const;
  void settle(std::vector<Firm>& rows, double fastest_mps, std::vector<Motion>& motions) const;
  static void take(const Firm& row);

  // soft_ending.cpp: how a step ends once its contacts are settled.
  Islands islands() const;
  std::size_t island_of(const Row& row, const Islands& islands) const;
  std::vector<Row*> in_order_of_pairs();
  void bounce(const Islands& islands, std::span<const State> states, std::vector<Motion>& motions);
  void move_on(const Islands& islands, std::span<const Wrench> wrenches,
               const std::vector<Motion>& motions);
  bool is_quiet(const Islands& islands, std::span<const Wrench> wrenches,
                std::span<const State> states) const;
  void remember_impulses(bool quiet);
  State end_of(std::size_t body, const State& state, const Motion& motion) const;
  std::vector<double> kinetic_j(const Islands& islands, std::span<const State> ends) const;
  std::vector<double> allowed_j(const Islands& islands, std::span<const Wrench> wrenches,
                                std::span<const State> starts) const;
  void bounce_less(const Islands& islands, const std::vector<bool>& exceeds,
                   const std::vector<double>& allowed, std::span<const Wrench> wrenches,
                   std::span<const State> starts, std::span<State> ends);
  void slow_down(const std::vector<std::size_t>& members, double allowed_j,
                 std::span<State> ends) const;
  bool limit_energy(const Islands& islands, std::span<const Wrench> wrenches,
                    std::span<const State> starts, std::span<State> ends);
  bool turns_far(const Islands& islands) const;
  bool finish(std::span<const Wrench> wrenches, std::span<State> states);

  const Scheme& scheme_;
  const SoftContact& soft_;
  ExactRun run_;                  // with a geometry of all pairs where the case has none
  std::vector<Memory> memories_;  // sorted by pair
  std::vector<Row> rows_;         // sorted by colour
  std::vector<Twist> velocity_, moved_;
  int sweeps_ = 1;
  double after_blow_s_ = 0.0;  // from the last blow of the step to its end
};

}  // namespace brickbench::exact
