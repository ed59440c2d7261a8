// The velocity-level variants of ourengine as Simulations: translation alone, see ourengine.cpp.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "adapters/ourengine_variants.hpp"
#include "adapters/seam/shape.hpp"
#include "ourengine/collision/manifold.hpp"

namespace brickbench {
namespace {

namespace engine = ourengine;

engine::BodyModel to_model(const Body& fact, int surface) {
  using engine::Geometry;
  engine::BodyModel model;
  model.geometry = by_shape(
      fact.shape,
      [](const BoxShape& box) -> Geometry { return engine::BoxGeometry{box.half_extents_m}; },
      [](const SphereShape& ball) -> Geometry { return engine::SphereGeometry{ball.radius_m}; },
      [](const PlaneShape&) -> Geometry { return engine::PlaneGeometry{}; });
  model.fixed = fact.fixed;
  model.mass_kg = fact.mass_kg;
  model.inertia_kgm2 = fact.inertia_kgm2;
  model.surface = surface;
  return model;
}

Shape read_shape(const engine::BoxGeometry& box) { return BoxShape{box.half_m}; }
Shape read_shape(const engine::SphereGeometry& ball) { return SphereShape{ball.radius_m}; }
Shape read_shape(const engine::PlaneGeometry&) { return PlaneShape{}; }

engine::Motion to_motion(const State& state, const engine::BodyModel& model) {
  engine::Motion motion{state.position_m, state.orientation, state.velocity_mps, {0, 0, 0}};
  if (!model.fixed) {
    const Eigen::Matrix3d r = state.orientation.toRotationMatrix();
    motion.angular_momentum_kgm2ps =
        r * model.inertia_kgm2.cwiseProduct(r.transpose() * state.angular_velocity_radps);
  }
  return motion;
}

State to_state(const engine::Motion& motion, const engine::BodyModel& model) {
  State state{motion.position_m, motion.attitude, motion.velocity_mps, {0, 0, 0}};
  if (!model.fixed) {
    state.angular_velocity_radps = engine::angular_velocity_radps(
        motion.attitude, model.inertia_kgm2, motion.angular_momentum_kgm2ps);
  }
  return state;
}

// Kinds of surface of the world, and their laws, by the first body of each kind.
struct Surfaces {
  std::vector<int> of_body;
  engine::SurfaceLaws laws;
};

Surfaces surfaces_of(const World& world) {
  std::vector<int> known;
  std::vector<std::size_t> example;
  Surfaces surfaces;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const auto found = std::ranges::find(known, world.bodies[i].surface);
    surfaces.of_body.push_back(static_cast<int>(found - known.begin()));
    if (found != known.end()) continue;
    known.push_back(world.bodies[i].surface);
    example.push_back(i);
  }
  const int kinds = static_cast<int>(known.size());
  surfaces.laws = engine::SurfaceLaws(kinds);
  for (int a = 0; a < kinds; ++a) {
    for (int b = 0; b <= a; ++b) {
      const ContactLaw law = contact_law(world, example[static_cast<std::size_t>(a)],
                                         example[static_cast<std::size_t>(b)]);
      surfaces.laws.set(a, b, {law.friction, law.restitution});
    }
  }
  return surfaces;
}

std::vector<Diagnostic> diagnostics_of(const engine::StepReport& report) {
  return {{"contact_residual", "1", report.residual},
          {"contacts", "1", double(report.contacts)},
          {"iterations", "1", double(report.iterations)},
          {"factorisations", "1", double(report.factorisations)},
          {"passes", "1", double(report.passes)},
          {"parts", "1", double(report.parts)},
          {"rebound_share", "1", report.rebound_share},
          {"overlap_left_m", "m", report.overlap_left_m},
          {"ran_out", "1", report.ran_out ? 1.0 : 0.0},
          {"unsolved", "1", report.status == engine::SolveStatus::kSolved ? 0.0 : 1.0}};
}

std::vector<Diagnostic> diagnostics_of(const engine::FastReport& report) {
  return {{"contacts", "1", double(report.contacts)},
          {"manifolds", "1", double(report.manifolds)},
          {"colours", "1", double(report.colours)},
          {"manifolds_made", "1", double(report.remade)},
          {"passes", "1", double(report.passes)},
          {"parts", "1", double(report.parts)},
          {"overlap_left_m", "m", report.overlap_left_m},
          {"deepest_m", "m", report.deepest_m},
          {"rebound_left_mps", "m/s", report.rebound_left_mps},
          {"energy_taken_j", "J", report.energy_taken_j},
          {"ran_out", "1", report.ran_out ? 1.0 : 0.0}};
}

Flags flags_of(const engine::StepReport& report) {
  Flags flags;
  flags.raise(Flag::unsolved, report.status != engine::SolveStatus::kSolved);
  flags.raise(Flag::overlap_left, report.overlap_left_m > 0.0 || report.ran_out);
  return flags;
}

// The sweeps of its sub-steps are counted, not judged: they have no tolerance to miss. Those over
// the laws of impact have.
Flags flags_of(const engine::FastReport& report) {
  Flags flags;
  flags.raise(Flag::unsolved, report.unsolved);
  flags.raise(Flag::overlap_left, report.overlap_left_m > 0.0 || report.ran_out);
  return flags;
}

constexpr Flags tellable_of(const engine::StepReport&) {
  return Flags(Flag::unsolved, Flag::overlap_left);
}
constexpr Flags tellable_of(const engine::FastReport&) {
  return Flags(Flag::unsolved, Flag::overlap_left);
}

std::vector<AuditFact> facts_of(const engine::DynamicsOptions& o) {
  std::vector<AuditFact> facts =
      o.frictionless ? read_knobs(k_lcp_knobs, o) : read_knobs(k_exact_knobs, o);
  if (o.solver == &engine::solve_exact) facts.push_back({"solver", "1", "exact"});
  facts.push_back({"rotation", "1", engine::rotation_name(o.rotation)});
  facts.push_back(number_fact("frictionless", "1", o.frictionless ? 1 : 0));
  facts.push_back(number_fact("step_s", "s", o.step_s));
  facts.push_back(number_fact("threads", "1", o.threads));
  return facts;
}

std::vector<AuditFact> facts_of(const engine::FastOptions& o) {
  std::vector<AuditFact> facts = read_knobs(k_fast_knobs, o);
  facts.push_back(number_fact("substeps", "1", o.substeps));
  facts.push_back(number_fact("step_s", "s", o.step_s));
  facts.push_back(number_fact("threads", "1", o.threads));
  return facts;
}

bool frictionless(const engine::DynamicsOptions& options) { return options.frictionless; }
bool frictionless(const engine::FastOptions&) { return false; }

// Engine is Dynamics or FastDynamics: the same calls, other options and reports.
template <typename Engine>
class VelocitySimulation final : public Simulation,
                                 ContactView,
                                 StateView,
                                 AuditView,
                                 DiagnosticView {
 public:
  template <typename Options>
  VelocitySimulation(const std::vector<engine::BodyModel>& bodies,
                     const std::vector<engine::Motion>& motions, const engine::SurfaceLaws& laws,
                     const Options& options)
      : engine_(bodies, motions, laws, options) {}

  void apply(std::span<const Wrench> wrenches) override {
    std::vector<engine::Load> loads;
    for (const Wrench& w : wrenches) loads.push_back({w.force_n, w.torque_nm});
    engine_.apply(loads);
  }

  Expected<void> step() override {
    const auto& report = engine_.step();
    diagnostics_ = diagnostics_of(report);
    flags_ = flags_of(report);
    return {};
  }

  void read(std::span<State> states) const override {
    for (std::size_t i = 0; i < states.size(); ++i) {
      states[i] = to_state(engine_.motions()[i], engine_.bodies()[i]);
    }
  }

  const ContactView* contact_view() const override { return this; }
  StateView* state_view() override { return this; }
  const AuditView* audit_view() const override { return this; }
  const DiagnosticView* diagnostic_view() const override { return this; }
  std::span<const Diagnostic> diagnostics() const override { return diagnostics_; }
  Flags flags() const override { return flags_; }
  Flags tellable() const override { return tellable_of(engine_.report()); }

  void contacts(std::vector<Contact>& contacts) const override {
    contacts.clear();
    for (const auto& p : engine_.contacts()) {
      contacts.push_back({static_cast<std::size_t>(p.body_a), static_cast<std::size_t>(p.body_b),
                          p.position_m, p.normal, p.gap_m, p.impulse_ns});
    }
  }

  Expected<void> set_state(std::span<const State> states) override {
    std::vector<engine::Motion> motions;
    for (std::size_t i = 0; i < states.size(); ++i) {
      motions.push_back(to_motion(states[i], engine_.bodies()[i]));
    }
    engine_.set_motions(motions);
    diagnostics_.clear();
    flags_ = {};
    return {};
  }

  Audit audit() const override {
    Audit audit;
    audit.gravity_mps2 = engine_.options().gravity_mps2;
    for (const engine::BodyModel& body : engine_.bodies()) {
      audit.bodies.push_back(
          {.fixed = body.fixed,
           .mass_kg = body.fixed ? 0.0 : body.mass_kg,
           .inertia_kgm2 = body.fixed ? Eigen::Vector3d(0, 0, 0) : body.inertia_kgm2,
           .shape = std::visit([](const auto& held) { return read_shape(held); }, body.geometry)});
    }
    audit.settings = facts_of(engine_.options());
    return audit;
  }

  ContactLaw pair_law(std::size_t a, std::size_t b) const override {
    const auto& law = engine_.laws()(engine_.bodies()[a].surface, engine_.bodies()[b].surface);
    return {frictionless(engine_.options()) ? 0.0 : law.friction, law.restitution};
  }

 private:
  Engine engine_;
  std::vector<Diagnostic> diagnostics_;
  Flags flags_;
};

template <typename Engine, typename Options>
std::unique_ptr<Simulation> simulate(const World& world, const Options& options) {
  const Surfaces surfaces = surfaces_of(world);
  std::vector<engine::BodyModel> bodies;
  std::vector<engine::Motion> motions;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    bodies.push_back(to_model(world.bodies[i], surfaces.of_body[i]));
    motions.push_back(to_motion(world.bodies[i].initial, bodies.back()));
  }
  return std::make_unique<VelocitySimulation<Engine>>(bodies, motions, surfaces.laws, options);
}

engine::DynamicsOptions dynamics_options(const World& world, const Settings& settings) {
  engine::DynamicsOptions options;
  options.step_s = settings.step_s;
  options.gravity_mps2 = world.gravity_mps2;
  options.threads = settings.threads;
  return options;
}

engine::FastOptions fast_options(const Settings& settings) {
  engine::FastOptions options;
  options.step_s = settings.step_s;
  options.substeps = fast_substeps(settings);
  options.threads = settings.threads;
  set_knobs(k_fast_knobs, settings, options);
  return options;
}

}  // namespace

Expected<std::unique_ptr<Simulation>> build_ourengine_exact(const World& world,
                                                            const Settings& settings) {
  engine::DynamicsOptions options = dynamics_options(world, settings);
  options.solver = &engine::solve_exact;
  set_knobs(k_exact_knobs, settings, options);
  return simulate<engine::Dynamics>(world, options);
}

Expected<std::unique_ptr<Simulation>> build_ourengine_lcp(const World& world,
                                                          const Settings& settings) {
  if (auto checked = refuse_friction(world, settings); !checked) {
    return tl::make_unexpected(checked.error());
  }
  engine::DynamicsOptions options = dynamics_options(world, settings);
  options.frictionless = true;
  set_knobs(k_lcp_knobs, settings, options);
  return simulate<engine::Dynamics>(world, options);
}

int fast_substeps(const Settings& settings) {
  const double longest_s = knob(settings, "substep_s");
  // The quotient of two roundings may land a hair above a whole number.
  return std::max(1, static_cast<int>(std::ceil(settings.step_s / longest_s - 1e-9)));
}

SoftContact fast_contact(const Settings& settings) {
  using engine::FastLimits;
  const engine::FastOptions options = fast_options(settings);
  return {.substeps = options.substeps,
          .frequency_hz = options.contact_hz,
          .damping_ratio = options.damping_ratio,
          .push_limit_mps = options.push_limit_mps,
          .margin_m = options.margin_m,
          .resting_approach_mps = options.resting_approach_mps,
          .keep_share = engine::ManifoldSet::k_recycle_share,
          .same_point_share = engine::ManifoldSet::k_same_point,
          .same_normal = engine::ManifoldSet::k_same_normal,
          .boxes = {.axis_bias = engine::k_axis_bias,
                    .parallel = engine::k_parallel_edges,
                    .border_share = engine::k_clip_slack},
          .too_deep_share = FastLimits::k_look_tolerance,
          .most_trials = FastLimits::k_trials,
          .most_sweeps = FastLimits::k_sweeps,
          .rebound_share = engine::k_rebound_share,
          .plain_sweeps = engine::k_plain_sweeps,
          .restart_growth = engine::k_restart_growth,
          .rebound_sweeps = engine::k_rebound_sweeps,
          .rebound_tolerated = engine::k_rebound_tolerated,
          .most_rebound_sweeps = engine::k_most_rebound_sweeps,
          .row_rounds = engine::k_row_rounds,
          .row_share = engine::k_row_share,
          .round_share = engine::k_round_share,
          .small_turn_rad = FastLimits::k_small_turn_rad,
          .turn_limit_rad = FastLimits::k_turn_rad,
          .energy_share = FastLimits::k_energy_share};
}

Expected<std::unique_ptr<Simulation>> build_ourengine_fast(const World& world,
                                                           const Settings& settings) {
  engine::FastOptions options = fast_options(settings);
  options.gravity_mps2 = world.gravity_mps2;
  return simulate<engine::FastDynamics>(world, options);
}

}  // namespace brickbench
