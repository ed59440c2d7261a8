// A contact problem compiled for the solvers: fixed bodies folded into the bias, bodies numbered
// in elimination order, contacts grouped by pair, rows laid out for the kernels.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "ourengine/contact/problem.hpp"
#include "ourengine/linear/kernels.hpp"
#include "ourengine/linear/ordering.hpp"

namespace ourengine {

class ContactSystem {
 public:
  // components: 1 for the frictionless law, 3 with friction. Contacts between two fixed bodies
  // carry no impulse and are left out.
  ContactSystem(const ContactProblem& problem, int components, SymbolicCache& cache);
  ContactSystem(const ContactSystem&) = delete;  // the view points into the members
  ContactSystem& operator=(const ContactSystem&) = delete;

  const SystemView& view() const { return view_; }
  const SymbolicFactor& symbolic() const { return *symbolic_; }
  const std::vector<PairTarget>& targets() const { return targets_; }
  FrontalView fronts() const {
    return {&symbolic_->fronts, front_pairs_.data(), front_pair_begin_.data(), sides_.data(),
            side_begin_.data()};
  }

  int bodies() const { return view_.bodies; }
  int contacts() const { return view_.contacts; }
  int components() const { return view_.components; }
  std::size_t stride() const { return static_cast<std::size_t>(view_.stride); }
  std::size_t rows() const { return stride() * static_cast<std::size_t>(view_.components); }
  std::size_t body_doubles() const { return free_velocity_.size(); }

  const AlignedDoubles& free_velocity() const { return free_velocity_; }
  // Per contact, with stride() entries; padding contacts have delassus 1 and friction 0.
  const AlignedDoubles& friction() const { return friction_; }
  const AlignedDoubles& delassus() const { return delassus_; }          // (J M^-1 J^T)_nn, 1/kg
  const AlignedDoubles& inverse_rows() const { return inverse_rows_; }  // M^-1 J^T, as rows
  // Internal contacts in the caller's order.
  const std::vector<int>& sweep_order() const { return sweep_order_; }
  // The speed (m/s) against which residuals are measured, one for the whole problem:
  //   max( least_speed_mps, max_i |v_a| + |omega_a| |arm_a| + |v_b| + |omega_b| |arm_b| + (-b_i)+
  //   ),
  // free velocities of the bodies at each contact i, and the separation that its bias demands. A
  // sum of sizes cannot cancel, as the entries of J v_free + b do when a gap closes within the step
  // to the last bit; what rounding leaves in them is always small against it. 1 if it is zero: then
  // nothing moves and nothing is to be done.
  double scale_mps() const { return scale_mps_; }

  // y = M x and y = M^-1 x.
  void multiply_mass(const AlignedDoubles& x, AlignedDoubles& y) const;
  void multiply_inverse_mass(const AlignedDoubles& x, AlignedDoubles& y) const;
  // v = v_free + M^-1 J^T f.
  void velocity_of(const AlignedDoubles& f, AlignedDoubles& v) const;

  // Between the caller's contacts and the internal ones.
  void load_impulses(std::span<const Eigen::Vector3d> impulses_ns, AlignedDoubles& f) const;
  void store(const AlignedDoubles& f, const AlignedDoubles& v, const ContactProblem& problem,
             ContactSolution& solution) const;

 private:
  void number_bodies(const ContactProblem& problem, SymbolicCache& cache);
  void fill_bodies(const ContactProblem& problem);
  void order_contacts(const ContactProblem& problem);
  void fill_contact(const ContactProblem& problem, int internal);
  void fill_contacts(const ContactProblem& problem);
  void fill_targets();
  void fill_front_pairs();
  void fill_sides();
  void set_view();

  SystemView view_;
  std::shared_ptr<const SymbolicFactor> symbolic_;
  std::vector<int> slot_;  // problem body -> internal body; the number of bodies if fixed
  std::vector<int> sweep_order_;
  std::vector<int> contact_order_;  // internal contact -> problem contact
  std::vector<ContactPair> pairs_;
  std::vector<PairTarget> targets_;
  std::vector<FrontPair> front_pairs_;
  std::vector<PairSide> sides_;
  std::vector<int> front_pair_begin_, side_begin_;
  AlignedIntegers offset_a_, offset_b_;
  AlignedDoubles mass_, inverse_mass_, free_velocity_, geometry_, rows_, inverse_rows_;
  AlignedDoubles bias_, tangent_bias_, friction_, delassus_;
  double scale_mps_ = 1.0;
};

}  // namespace ourengine
