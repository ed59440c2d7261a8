// ODE in double precision: collide, then dWorldQuickStep or dWorldStep, then the contact joints go.
//
// Choices (measured effects: docs/engines/ode.md):
//  * Every variant: each contact joint gets World's law of its pair (dContactApprox1: friction is a
//    coefficient, not a force limit; dContactBounce without a velocity threshold), up to 8 points
//    per pair; sleeping and damping off; inertia as in World.
//  * quick, dantzig: QuickStep with 50 iterations, or the Lemke-Dantzig solver of dWorldStep
//  (exact,
//    for some 15 bodies at most); correcting velocity at most 0.1 m/s (unlimited, a penetration
//    bounces); the first axis of ODE's friction pyramid along the slip that the step would bring.
//  * default: what ODE does when nobody asks: QuickStep, 20 iterations, pyramid in fixed world
//  axes,
//    no limit of the correcting velocity.
//  * QuickStep shuffles its rows with a random generator that the whole process shares: each
//    simulation keeps its own seed, starting from 0, and lends it to ODE during its steps.
//  * ODE's errors and assertions (they would end the process) become failures; its messages, such
//    as "LCP internal error", are counted in the diagnostics and never printed.
//  * Refused: several threads.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "adapters/ode_scene.hpp"
#include "adapters/seam/knob_table.hpp"

namespace brickbench {
namespace {

using namespace ode;

const char* solver_name(const Settings& settings) {
  return settings.variant == "dantzig" ? "dWorldStep" : "dWorldQuickStep";
}

class OdeSimulation final : public Simulation, ContactView, AuditView, DiagnosticView {
 public:
  OdeSimulation(const World& facts, Settings settings)
      : facts_(facts), settings_(std::move(settings)) {
    const Session session(seed_);
    if (!session.ready()) throw std::runtime_error("ODE could not be initialised");
    scene_ = std::make_unique<Scene>(facts_);
    set_knobs(k_knobs, settings_, *scene_);
  }
  ~OdeSimulation() override {
    const Session session(seed_);
    scene_.reset();
  }

  void apply(std::span<const Wrench> wrenches) override {
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      const dBodyID body = scene_->bodies[i];
      if (body == nullptr) continue;
      const Eigen::Vector3d& force = wrenches[i].force_n;
      const Eigen::Vector3d& torque = wrenches[i].torque_nm;
      dBodySetForce(body, force.x(), force.y(), force.z());
      dBodySetTorque(body, torque.x(), torque.y(), torque.z());
    }
  }

  Expected<void> step() override;

  void read(std::span<State> states) const override {
    for (std::size_t i = 0; i < states.size(); ++i) states[i] = state_of(i);
  }

  const ContactView* contact_view() const override { return this; }
  const AuditView* audit_view() const override { return this; }
  const DiagnosticView* diagnostic_view() const override { return this; }

  void contacts(std::vector<Contact>& contacts) const override;
  Audit audit() const override;
  ContactLaw pair_law(std::size_t a, std::size_t b) const override;
  std::span<const Diagnostic> diagnostics() const override { return diagnostics_; }
  Flags flags() const override { return flags_; }
  Flags tellable() const override;

 private:
  State state_of(std::size_t i) const;
  void collide(dGeomID a, dGeomID b);
  bool is_cut(dGeomID a, dGeomID b, int found) const;
  dSurfaceParameters surface(std::size_t a, std::size_t b) const;
  Eigen::Vector3d free_velocity_mps(dBodyID body, const dReal* point_m) const;
  void align_friction(dContact& point) const;

  World facts_;
  Settings settings_;
  unsigned long seed_ = 0;
  double lcp_messages_ = 0.0;  // since the start
  std::unique_ptr<Scene> scene_;
  std::vector<Diagnostic> diagnostics_;
  Flags flags_;
};

State OdeSimulation::state_of(std::size_t i) const {
  const dBodyID body = scene_->bodies[i];
  if (body == nullptr) return facts_.bodies[i].initial;
  const dReal* q = dBodyGetQuaternion(body);
  return {.position_m = to_eigen(dBodyGetPosition(body)),
          .orientation = {q[0], q[1], q[2], q[3]},
          .velocity_mps = to_eigen(dBodyGetLinearVel(body)),
          .angular_velocity_radps = to_eigen(dBodyGetAngularVel(body))};
}

dSurfaceParameters OdeSimulation::surface(std::size_t a, std::size_t b) const {
  const ContactLaw law = contact_law(facts_, a, b);
  dSurfaceParameters surface{};
  surface.mode = dContactApprox1;
  surface.mu = law.friction;
  if (law.restitution > 0.0) {
    surface.mode |= dContactBounce;
    surface.bounce = law.restitution;
    surface.bounce_vel = scene_->restitution_threshold_mps;
  }
  return surface;
}

// Velocity that a point of the body would have after the step if nothing touched it (turning
// aside).
Eigen::Vector3d OdeSimulation::free_velocity_mps(dBodyID body, const dReal* point_m) const {
  if (body == nullptr) return Eigen::Vector3d::Zero();
  dVector3 now_mps;
  dBodyGetPointVel(body, point_m[0], point_m[1], point_m[2], now_mps);
  dMass mass;
  dBodyGetMass(body, &mass);
  return to_eigen(now_mps) +
         settings_.step_s * (facts_.gravity_mps2 + to_eigen(dBodyGetForce(body)) / mass.mass);
}

void OdeSimulation::align_friction(dContact& point) const {
  const Eigen::Vector3d normal = to_eigen(point.geom.normal);
  const Eigen::Vector3d relative = free_velocity_mps(dGeomGetBody(point.geom.g1), point.geom.pos) -
                                   free_velocity_mps(dGeomGetBody(point.geom.g2), point.geom.pos);
  const Eigen::Vector3d slip = relative - normal.dot(relative) * normal;
  if (slip.norm() < k_no_slip_mps) return;
  point.surface.mode |= dContactFDir1;
  Eigen::Map<Eigen::Vector3d>(point.fdir1) = slip.normalized();
}

// Whether ODE has more points for the pair than the room that collide() gave it.
bool OdeSimulation::is_cut(dGeomID a, dGeomID b, int found) const {
  if (found < static_cast<int>(scene_->points.size())) return false;
  std::array<dContactGeom, k_most_points> all;
  return dCollide(a, b, k_most_points, all.data(), static_cast<int>(sizeof(dContactGeom))) > found;
}

// QuickStep counts its sweeps and knows no tolerance; the exact solver says when it gave up.
Flags OdeSimulation::tellable() const {
  Flags flags(Flag::contacts_dropped);
  flags.raise(Flag::unsolved, settings_.variant == "dantzig");
  return flags;
}

// Makes the contact joints between two geoms, the moving body first, so that ODE swaps none.
void OdeSimulation::collide(dGeomID a, dGeomID b) {
  if (dGeomGetBody(a) == nullptr) std::swap(a, b);
  if (dGeomGetBody(a) == nullptr) return;
  auto& points = scene_->points;
  const int found = dCollide(a, b, static_cast<int>(points.size()), &points[0].geom,
                             static_cast<int>(sizeof(dContact)));
  flags_.raise(Flag::contacts_dropped, is_cut(a, b, found));
  for (int k = 0; k < found; ++k) {
    dContact& point = points[static_cast<std::size_t>(k)];
    point.surface = surface(index_of(a), index_of(b));
    if (scene_->slip_aligned) align_friction(point);
    const dJointID joint = dJointCreateContact(scene_->world, scene_->joints, &point);
    dJointAttach(joint, dGeomGetBody(a), dGeomGetBody(b));
    scene_->touches.push_back({.geom = point.geom});
    dJointSetFeedback(joint, &scene_->touches.back().feedback);
  }
}

Expected<void> OdeSimulation::step() {
  const Session session(seed_);
  if (!session.ready()) return fail(Fault::out_of_memory, "ODE has no memory for this thread");
  scene_->touches.clear();
  flags_ = {};
  dSpaceCollide(scene_->space, this, [](void* self, dGeomID a, dGeomID b) {
    static_cast<OdeSimulation*>(self)->collide(a, b);
  });
  const int done = settings_.variant == "dantzig"
                       ? dWorldStep(scene_->world, settings_.step_s)
                       : dWorldQuickStep(scene_->world, settings_.step_s);
  if (done == 0) return fail(Fault::out_of_memory, "ODE could not get the memory for its step");
  dJointGroupEmpty(scene_->joints);
  lcp_messages_ += messages().count;
  flags_.raise(Flag::unsolved, messages().count > 0);
  diagnostics_ = {{"solver_messages", "1", static_cast<double>(messages().count)},
                  {"solver_messages_total", "1", lcp_messages_}};
  return {};
}

void OdeSimulation::contacts(std::vector<Contact>& contacts) const {
  contacts.clear();
  for (const Touch& touch : scene_->touches) {
    // ODE's normal points into g1; f1 is the force on g1's body.
    contacts.push_back({.body_a = index_of(touch.geom.g1),
                        .body_b = index_of(touch.geom.g2),
                        .position_m = to_eigen(touch.geom.pos),
                        .normal = -to_eigen(touch.geom.normal),
                        .gap_m = -touch.geom.depth,
                        .impulse_ns = -settings_.step_s * to_eigen(touch.feedback.f1)});
  }
}

BodyAudit audit_body(dBodyID body, dGeomID geom, double step_s) {
  if (body == nullptr) return {.fixed = true, .shape = read_shape(geom)};
  dMass mass;
  dBodyGetMass(body, &mass);
  // ODE's damping is the share of the velocity that is lost per step.
  return {.fixed = false,
          .mass_kg = mass.mass,
          .inertia_kgm2 = {mass.I[0], mass.I[5], mass.I[10]},
          .shape = read_shape(geom),
          .linear_damping_hz = dBodyGetLinearDamping(body) / step_s,
          .angular_damping_hz = dBodyGetAngularDamping(body) / step_s,
          .can_sleep = dBodyGetAutoDisableFlag(body) != 0};
}

Audit OdeSimulation::audit() const {
  Audit audit;
  dVector3 gravity_mps2;
  dWorldGetGravity(scene_->world, gravity_mps2);
  audit.gravity_mps2 = to_eigen(gravity_mps2);
  for (std::size_t i = 0; i < scene_->geoms.size(); ++i) {
    audit.bodies.push_back(audit_body(scene_->bodies[i], scene_->geoms[i], settings_.step_s));
  }
  audit.settings = read_knobs(k_knobs, *scene_);
  audit.settings.push_back(number_fact("step_s", "s", settings_.step_s));
  audit.settings.push_back({"solver", "", solver_name(settings_)});
  audit.settings.push_back(
      number_fact("max_angular_speed_radps", "rad/s", dWorldGetMaxAngularSpeed(scene_->world)));
  audit.settings.push_back({"configuration", "", dGetConfiguration()});
  return audit;
}

// ODE keeps no law per body: this is what collide() writes into each contact joint of the pair.
ContactLaw OdeSimulation::pair_law(std::size_t a, std::size_t b) const {
  const dSurfaceParameters joint = surface(a, b);
  return {.friction = joint.mu, .restitution = joint.bounce};
}

std::vector<AuditFact> asked_of_ode(const World& world, const Settings& settings) {
  std::vector<AuditFact> facts = asked_knobs(k_knobs, world, settings);
  facts.push_back({"solver", "", solver_name(settings)});
  return facts;
}

std::optional<Scheme> ode_scheme(const Settings& settings) {
  const auto value = [&](std::string_view name) { return knob(settings, name); };
  Scheme scheme;
  scheme.source =
      "Smith, ODE 0.16: dxStepBody (util.cpp), gyroscopic torque in step.cpp and quickstep.cpp, "
      "dxJointContact::getInfo2";
  scheme.gyroscopic =
      value("gyroscopic") > 0 ? GyroscopicRule::frozen_momentum : GyroscopicRule::neglected;
  scheme.attitude =
      value("finite_rotation") > 0 ? AttitudeRule::exponential : AttitudeRule::normalised_euler;
  scheme.friction = value("slip_aligned_friction") > 0 ? FrictionSet::circle : FrictionSet::square;
  if (value("contact_surface_layer_m") > 0) return scheme;  // Scheme has no such layer
  scheme.contact = ImpulseContact{.restitution_threshold_mps = value("restitution_threshold_mps"),
                                  .error_reduction = value("erp"),
                                  .max_correction_mps = value("max_correcting_velocity_mps"),
                                  .softness_per_kgs = value("cfm"),
                                  .gives_up_at_zero_pivot = settings.variant == "dantzig"};
  return scheme;
}

Expected<std::unique_ptr<Simulation>> build_ode(const World& world, const Settings& settings) {
  if (dCheckConfiguration("ODE_double_precision") == 0) {
    return fail(Fault::unsupported, "the ODE library at run time is not in double precision");
  }
  return std::make_unique<OdeSimulation>(world, settings);
}

}  // namespace

Adapter ode_adapter() {
  const std::string precision = dCheckConfiguration("ODE_double_precision") != 0 ? "f64" : "f32";
  return {
      .name = "ode",
      .version = BRICKBENCH_ODE_VERSION,
      .variants = {{"quick", "QuickStep, 50 iterations, tuned", precision, tuned_values(k_knobs)},
                   {"dantzig", "dWorldStep (Lemke-Dantzig), tuned; for some 15 bodies at most",
                    precision, tuned_values(k_knobs)},
                   {"default", "the library's own settings: QuickStep, 20 iterations", precision,
                    library_values(k_knobs)}},
      .knobs = to_knobs(k_knobs),
      .build = &build_ode,
      .scheme = &ode_scheme,
      .asked = &asked_of_ode};
}

}  // namespace brickbench
