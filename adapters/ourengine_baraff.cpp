// The paper's system as a Simulation: translation alone, see ourengine.cpp for the choices.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "adapters/ourengine_variants.hpp"
#include "adapters/seam/shape.hpp"

namespace brickbench {
namespace {

namespace engine = ourengine::baraff;

engine::Options options_of(const World& world, const Settings& settings) {
  engine::Options options;
  options.step_s = settings.step_s;
  options.gravity_mps2 = world.gravity_mps2;
  set_knobs(k_baraff_knobs, settings, options);
  return options;
}

engine::RigidBody to_engine(const Body& fact) {
  using engine::Solid;
  const Solid solid = by_shape(
      fact.shape, [](const BoxShape& box) -> Solid { return engine::Box{box.half_extents_m}; },
      [](const SphereShape& ball) -> Solid { return engine::Sphere{ball.radius_m}; },
      [](const PlaneShape&) -> Solid { return engine::Plane{}; });
  return fact.fixed ? engine::make_fixed_body(solid)
                    : engine::make_body(solid, fact.mass_kg, fact.inertia_kgm2);
}

Shape read_shape(const engine::Box& box) { return BoxShape{box.half_m}; }
Shape read_shape(const engine::Sphere& ball) { return SphereShape{ball.radius_m}; }
Shape read_shape(const engine::Plane&) { return PlaneShape{}; }

void set_state(engine::RigidBody& body, const State& state) {
  body.position_m = state.position_m;
  body.orientation = state.orientation;
  engine::set_velocity(body, state.velocity_mps, state.angular_velocity_radps);
}

// Each body is a surface of its own, so that every law of a pair is expressed.
engine::RestitutionTable restitutions(const World& world) {
  const auto n = static_cast<Eigen::Index>(world.bodies.size());
  engine::RestitutionTable table(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      table(i, j) =
          contact_law(world, static_cast<std::size_t>(i), static_cast<std::size_t>(j)).restitution;
    }
  }
  return table;
}

class BaraffSimulation final : public Simulation,
                               ContactView,
                               StateView,
                               AuditView,
                               DiagnosticView {
 public:
  BaraffSimulation(std::vector<engine::RigidBody> bodies, const World& world,
                   const Settings& settings)
      : simulator_(std::move(bodies), restitutions(world), options_of(world, settings)) {}

  void apply(std::span<const Wrench> wrenches) override {
    std::vector<engine::Load> loads;
    for (const Wrench& w : wrenches) loads.push_back({w.force_n, w.torque_nm});
    simulator_.apply(loads);
  }

  Expected<void> step() override {
    const engine::StepReport& report = simulator_.step();
    diagnostics_ = {{"complementarity_residual", "1", report.complementarity_residual},
                    {"overlap_residual", "1", report.overlap_residual},
                    {"contacts", "1", double(report.contacts)},
                    {"resting_contacts", "1", double(report.resting_contacts)},
                    {"pivots", "1", double(report.pivots)},
                    {"zero_steps", "1", double(report.zero_steps)},
                    {"retried_solves", "1", double(report.retried)},
                    {"overlaps_left", "1", double(report.overlaps_left)},
                    {"bisections", "1", double(report.bisections)},
                    {"pieces", "1", double(report.pieces)},
                    {"colliding_iterations", "1", double(report.colliding_iterations)},
                    {"collisions_unfinished", "1", report.collisions_unfinished ? 1.0 : 0.0},
                    {"overlap_energy_j", "J", report.overlap_energy_j},
                    {"collision_energy_j", "J", report.collision_energy_j},
                    {"motion_energy_j", "J", report.motion_energy_j},
                    {"unsolved", "1", report.unsolved ? 1.0 : 0.0},
                    {"failed", "1", report.failed ? 1.0 : 0.0}};
    flags_ = {};
    flags_.raise(Flag::unsolved, report.collisions_unfinished || report.hasty || report.failed);
    flags_.raise(Flag::overlap_left, report.overlaps_left > 0);
    if (report.failed) {
      return fail(
          Fault::crashed,
          fmt::format("the resting-contact solve failed: residual {} of {} contacts after "
                      "{} pivots; allowed is 1e-6",
                      report.complementarity_residual, report.resting_contacts, report.pivots));
    }
    return {};
  }

  void read(std::span<State> states) const override {
    for (std::size_t i = 0; i < states.size(); ++i) {
      const engine::RigidBody& body = simulator_.bodies()[i];
      states[i] = {body.position_m, body.orientation, body.velocity_mps,
                   body.angular_velocity_radps};
    }
  }

  const ContactView* contact_view() const override { return this; }
  StateView* state_view() override { return this; }
  const AuditView* audit_view() const override { return this; }
  const DiagnosticView* diagnostic_view() const override { return this; }
  std::span<const Diagnostic> diagnostics() const override { return diagnostics_; }
  Flags flags() const override { return flags_; }
  Flags tellable() const override { return Flags(Flag::unsolved, Flag::overlap_left); }

  // The engine's normal points from obj2 to obj1, the seam's from a to b.
  void contacts(std::vector<Contact>& contacts) const override {
    contacts.clear();
    for (const engine::Collision& c : simulator_.contacts()) {
      contacts.push_back({.body_a = c.obj2,
                          .body_b = c.obj1,
                          .position_m = c.location,
                          .normal = c.normal,
                          .gap_m = c.gap_m,
                          .impulse_ns = c.impulse_ns * c.normal});
    }
  }

  Expected<void> set_state(std::span<const State> states) override {
    std::vector<engine::RigidBody> bodies(simulator_.bodies().begin(), simulator_.bodies().end());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (bodies[i].is_fixed()) continue;
      brickbench::set_state(bodies[i], states[i]);
    }
    simulator_.set_bodies(bodies);
    diagnostics_.clear();
    flags_ = {};
    return {};
  }

  Audit audit() const override;
  ContactLaw pair_law(std::size_t a, std::size_t b) const override {
    const auto& bodies = simulator_.bodies();
    return {.friction = 0.0,
            .restitution = simulator_.restitution()(bodies[a].surface, bodies[b].surface)};
  }

 private:
  engine::Simulator simulator_;
  std::vector<Diagnostic> diagnostics_;
  Flags flags_;
};

Audit BaraffSimulation::audit() const {
  Audit audit;
  const engine::Options& o = simulator_.options();
  audit.gravity_mps2 = o.gravity_mps2;
  for (const engine::RigidBody& body : simulator_.bodies()) {
    audit.bodies.push_back(
        {.fixed = body.is_fixed(),
         .mass_kg = body.mass_kg,
         .inertia_kgm2 = body.inertia_body.diagonal(),
         .shape = std::visit([](const auto& held) { return read_shape(held); }, body.solid)});
  }
  audit.settings = read_knobs(k_baraff_knobs, o);
  audit.settings.push_back(number_fact("step_s", "s", o.step_s));
  return audit;
}

}  // namespace

Expected<std::unique_ptr<Simulation>> build_ourengine_baraff(const World& world,
                                                             const Settings& settings) {
  if (auto refused = refuse_friction(world, settings); !refused)
    return tl::make_unexpected(refused.error());
  std::vector<engine::RigidBody> bodies;
  for (const Body& fact : world.bodies) {
    bodies.push_back(to_engine(fact));
    bodies.back().surface = static_cast<int>(bodies.size()) - 1;
    set_state(bodies.back(), fact.initial);
  }
  return std::make_unique<BaraffSimulation>(std::move(bodies), world, settings);
}

}  // namespace brickbench
