// Deliberately wrong engines: whatever judges engines must notice each of them.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "adapters/seam/adapter.hpp"

namespace brickbench::testing {

enum class Defect {
  none,
  half_gravity,        // pushes every body up with half its weight
  spin_in_body_frame,  // reports angular velocities in the body frame
  nan_at_step_7,       // the first moving body loses its position
  swapped_bodies,      // reports the first two moving bodies in each other's place
  throws_at_step_5,
  refuses,                // builds nothing
  leaks_momentum,         // loses 1e-6 of all velocities in every step
  doubles_energy,         // reports velocities times sqrt(2), from the first step on
  keeps_wrenches,         // applied wrenches stay on
  rounds_time,            // advances by a step that is 1e-6 too long
  forgets_order_of_runs,  // every simulation built differs from the one before by 1e-15 m
  lies_in_audit,          // reports 1 % more mass than it uses
};

const std::vector<Defect>& all_defects();  // without `none`
const char* to_string(Defect defect);

// Any simulation with defects on top. The order of `defects` does not matter.
class Faulty final : public Simulation, AuditView {
 public:
  Faulty(std::unique_ptr<Simulation> inner, const World& world, std::vector<Defect> defects);

  void apply(std::span<const Wrench> wrenches) override;
  Expected<void> step() override;
  void read(std::span<State> states) const override;

  const ContactView* contact_view() const override { return inner_->contact_view(); }
  StateView* state_view() override { return inner_->state_view(); }
  const AuditView* audit_view() const override;
  const DiagnosticView* diagnostic_view() const override { return inner_->diagnostic_view(); }

 private:
  bool has(Defect defect) const;
  Audit audit() const override;
  ContactLaw pair_law(std::size_t a, std::size_t b) const override;

  std::unique_ptr<Simulation> inner_;
  World world_;
  std::vector<Defect> defects_;
  std::vector<std::size_t> moving_;
  std::vector<Wrench> wrenches_;
  int steps_ = 0;
  double shift_m_ = 0.0;
};

// Builds `adapter` with defects on top; `refuses` and `rounds_time` act here.
Expected<std::unique_ptr<Simulation>> build_faulty(const Adapter& adapter, const World& world,
                                                   Settings settings, std::vector<Defect> defects);

// A correct engine without contact (adapters/template.cpp), which Defect::none leaves as it is.
Adapter correct_fake();

// The same with one defect, named "fake_<defect>".
Adapter fake_adapter(Defect defect);

}  // namespace brickbench::testing
