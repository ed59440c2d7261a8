// Bullet in double precision: btDiscreteDynamicsWorld, one variable step per call.
//
// Choices (measured effects: docs/engines/bullet.md):
//  * Every variant: Bullet's contact-added callback gives each contact World's law of its pair, so
//    any law is exact; sleeping off; inertia as in World.
//  * si, nncg: sequential impulses or nonlinear conjugate gradients, 50 iterations, warm starting,
//    two friction directions; split impulse for every penetration (the library's -0.04 m leaves
//    Baumgarte velocities in, which fake restitution); contact rows from a gap of 1e-8 m on
//    (earlier rows eat restitution, none but touching ones let bricks creep); no velocity threshold
//    of restitution; boxes without rounded edges (margin 0); up to four contacts between a box and
//    a plane at once.
//  * default: all of these as the library has them, that is sequential impulses, 10 iterations.
//  * Refused: several threads (Debian's Bullet is built without), and an initial spin that Bullet
//    would clamp (a quarter turn per step). A clamp later in the run shows in the diagnostics.
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <memory>

#include "adapters/bullet_scene.hpp"
#include "adapters/seam/knob_table.hpp"

namespace brickbench {
namespace {

using namespace bullet;

bool is_box(const btCollisionShape& shape) { return shape.getShapeType() == BOX_SHAPE_PROXYTYPE; }

std::string margins_text(std::span<const std::unique_ptr<btCollisionShape>> shapes) {
  LiveValues margins_m;
  for (const auto& shape : shapes) {
    if (is_box(*shape)) margins_m.push_back(shape->getMargin());
  }
  return common_text(margins_m);
}

class BulletSimulation final : public Simulation, ContactView, AuditView, DiagnosticView {
 public:
  BulletSimulation(const World& facts, const Settings& settings)
      : facts_(facts), step_s_(settings.step_s) {
    scene_ = std::make_unique<Scene>(facts_, settings.variant == "nncg",
                                     knob(settings, "max_box_margin_m"));
    set_knobs(k_knobs, settings, *scene_);
    scene_->join();
  }

  void apply(std::span<const Wrench> wrenches) override {
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      if (facts_.bodies[i].fixed) continue;
      scene_->bodies[i]->clearForces();
      scene_->bodies[i]->applyCentralForce(to_bt(wrenches[i].force_n));
      scene_->bodies[i]->applyTorque(to_bt(wrenches[i].torque_nm));
    }
  }

  Expected<void> step() override {
    if (scene_->watched != nullptr) scene_->watched->residual_m2ps2 = 0.0;
    scene_->world->stepSimulation(step_s_, 0);
    return inspect();
  }

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
  // The sweeps are counted, not judged, and a manifold has four points by design.
  Flags tellable() const override { return Flags(Flag::clamped); }

 private:
  State state_of(std::size_t i) const;
  Expected<void> inspect();

  World facts_;  // the bodies point at it
  double step_s_;
  std::unique_ptr<Scene> scene_;
  std::vector<Diagnostic> diagnostics_;
  Flags flags_;
};

State BulletSimulation::state_of(std::size_t i) const {
  const btRigidBody& body = *scene_->bodies[i];
  const btQuaternion q = body.getWorldTransform().getRotation();
  return {.position_m = from_bt(body.getWorldTransform().getOrigin()),
          .orientation = {q.w(), q.x(), q.y(), q.z()},
          .velocity_mps = from_bt(body.getLinearVelocity()),
          .angular_velocity_radps = from_bt(body.getAngularVelocity())};
}

// What Bullet does without telling: bodies switched off because their bounding box overflowed,
// spins clamped to a quarter turn per step, turns beyond an eighth that come out smaller.
Expected<void> BulletSimulation::inspect() {
  double clamped = 0.0;
  double cut = 0.0;
  for (std::size_t i = 0; i < facts_.bodies.size(); ++i) {
    if (facts_.bodies[i].fixed) continue;
    // Of a body that is nowhere any more, the seam says so.
    if (scene_->bodies[i]->getActivationState() != DISABLE_DEACTIVATION && is_finite(state_of(i))) {
      return fail(Fault::crashed, fmt::format("Bullet switched off body '{}' (its bounding box "
                                              "overflowed)",
                                              facts_.bodies[i].name));
    }
    const double turn_rad = scene_->bodies[i]->getAngularVelocity().length() * step_s_;
    if (turn_rad >= k_max_turn_rad * (1.0 - 1e-12)) clamped += 1.0;
    if (turn_rad > k_largest_way_rad) cut += 1.0;
  }
  diagnostics_ = {{"spin_clamped_bodies", "1", clamped}, {"turn_cut_bodies", "1", cut}};
  flags_ = {};
  flags_.raise(Flag::clamped, clamped + cut > 0.0);
  if (scene_->watched != nullptr) {
    diagnostics_.push_back(
        {"last_sweep_velocity_change_mps", "m/s", std::sqrt(scene_->watched->residual_m2ps2)});
  }
  return {};
}

void BulletSimulation::contacts(std::vector<Contact>& contacts) const {
  contacts.clear();
  for (int m = 0; m < scene_->dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *scene_->dispatcher.getManifoldByIndexInternal(m);
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      const btManifoldPoint& p = manifold.getContactPoint(k);
      // The solver skipped this point; the impulses in it are those of an earlier step.
      if (p.getDistance() > manifold.getContactProcessingThreshold()) continue;
      btVector3 on_a = p.m_normalWorldOnB * p.m_appliedImpulse +
                       p.m_lateralFrictionDir1 * p.m_appliedImpulseLateral1;
      if ((scene_->world->getSolverInfo().m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS) != 0) {
        on_a += p.m_lateralFrictionDir2 * p.m_appliedImpulseLateral2;
      }
      contacts.push_back({.body_a = index_of(manifold.getBody0()),
                          .body_b = index_of(manifold.getBody1()),
                          .position_m = from_bt(p.getPositionWorldOnB()),
                          .normal = -from_bt(p.m_normalWorldOnB),
                          .gap_m = p.getDistance(),
                          .impulse_ns = -from_bt(on_a)});
    }
  }
}

Audit BulletSimulation::audit() const {
  Audit audit;
  audit.gravity_mps2 = from_bt(scene_->world->getGravity());
  for (const auto& body : scene_->bodies) {
    const bool fixed = body->isStaticObject();
    const btVector3& inverse = body->getInvInertiaDiagLocal();
    const auto damping_hz = [](double per_second) { return -std::log1p(-per_second); };
    audit.bodies.push_back(
        {.fixed = fixed,
         .mass_kg = fixed ? 0.0 : body->getMass(),
         .inertia_kgm2 = fixed ? Eigen::Vector3d::Zero() : from_bt(inverse).cwiseInverse().eval(),
         .shape = read_shape(*body->getCollisionShape()),
         .linear_damping_hz = damping_hz(body->getLinearDamping()),
         .angular_damping_hz = damping_hz(body->getAngularDamping()),
         .can_sleep = !fixed && body->getActivationState() != DISABLE_DEACTIVATION});
  }
  const bool nncg = scene_->solver->getSolverType() == BT_NNCG_SOLVER;
  audit.settings = read_knobs(k_knobs, *scene_);
  audit.settings.push_back(number_fact("step_s", "s", step_s_));
  audit.settings.push_back({"solver", "", nncg ? k_nncg_solver : k_si_solver});
  audit.settings.push_back({"box_margins_m", "m", margins_text(scene_->shapes)});
  const btContactSolverInfo& info = scene_->world->getSolverInfo();
  audit.settings.push_back(number_fact("linear_slop_m", "m", info.m_linearSlop));
  audit.settings.push_back(number_fact("solver_mode_bits", "", info.m_solverMode));
  return audit;
}

// Sends a contact point through Bullet's own path for new points, on a manifold of its own.
ContactLaw BulletSimulation::pair_law(std::size_t a, std::size_t b) const {
  const auto wrap = [&](std::size_t i) {
    const btRigidBody* body = scene_->bodies[i].get();
    return btCollisionObjectWrapper(nullptr, body->getCollisionShape(), body,
                                    body->getWorldTransform(), -1, -1);
  };
  const btCollisionObjectWrapper wrap_a = wrap(a);
  const btCollisionObjectWrapper wrap_b = wrap(b);
  btPersistentManifold manifold(wrap_a.getCollisionObject(), wrap_b.getCollisionObject(), 0, 1.0,
                                1.0);
  btManifoldResult result(&wrap_a, &wrap_b);
  result.setPersistentManifold(&manifold);
  result.addContactPoint(btVector3(0, 0, 1), btVector3(0, 0, 0), 0.0);
  const btManifoldPoint& point = manifold.getContactPoint(0);
  return {.friction = point.m_combinedFriction, .restitution = point.m_combinedRestitution};
}

std::vector<AuditFact> asked_of_bullet(const World& world, const Settings& settings) {
  std::vector<AuditFact> facts = asked_knobs(k_knobs, world, settings);
  // Boxes may be too small for the margin asked for.
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  for (const Body& body : world.bodies) {
    shapes.push_back(make_shape(body.shape, knob(settings, "max_box_margin_m")));
  }
  facts.push_back({"box_margins_m", "m", margins_text(shapes)});
  facts.push_back({"solver", "", settings.variant == "nncg" ? k_nncg_solver : k_si_solver});
  return facts;
}

std::optional<Scheme> bullet_scheme(const Settings& settings) {
  const auto value = [&](std::string_view name) { return knob(settings, name); };
  constexpr std::array gyroscopic = {GyroscopicRule::neglected, GyroscopicRule::explicit_body,
                                     GyroscopicRule::explicit_body, GyroscopicRule::newton_body};
  const auto flag = static_cast<std::size_t>(value("gyroscopic"));
  if (flag == 2) return std::nullopt;  // its implicit world-frame update has no name in Scheme
  Scheme scheme;
  scheme.source =
      "Coumans, Bullet 3.24: btRigidBody::predictIntegratedTransform, computeGyroscopicImpulse*, "
      "btSequentialImpulseConstraintSolver::setupContactConstraint";
  scheme.gyroscopic = gyroscopic[flag];
  scheme.turn_limit_rad = k_largest_way_rad;
  const double margin_m = value("contact_processing_threshold_m");
  // A larger threshold is cut by the breaking threshold of the shapes at hand
  // (btCollisionShape::getContactBreakingThreshold), up to which planes look
  // (btConvexPlaneCollisionAlgorithm); two balls or boxes are seen when they touch.
  const double reach_share =
      margin_m > 1e-6 ? gContactBreakingThreshold : std::numeric_limits<double>::infinity();
  ImpulseContact contact{.margin_m = margin_m,
                         .plane_reach_share = reach_share,
                         .most_corners = MANIFOLD_CACHE_SIZE,
                         .approach_allowed = true,
                         .restitution_threshold_mps = value("restitution_threshold_mps"),
                         .sum_of_targets = true,
                         .error_reduction = value("erp"),
                         .softness_per_kgs = value("cfm")};
  if (value("split_impulse") > 0) {
    contact.split_at_gap_m = value("split_impulse_threshold_m");
    contact.split_turn_share = btContactSolverInfo().m_splitImpulseTurnErp;
  }
  scheme.contact = contact;
  return scheme;
}

Expected<std::unique_ptr<Simulation>> build_bullet(const World& world, const Settings& settings) {
  for (const Body& body : world.bodies) {
    const double spin_radps = body.initial.angular_velocity_radps.norm();
    if (spin_radps * settings.step_s > k_max_turn_rad) {
      return fail(Fault::unsupported,
                  fmt::format("body '{}' spins {} rad/s; Bullet clamps to pi/2 per step = {} rad/s",
                              body.name, spin_radps, k_max_turn_rad / settings.step_s));
    }
  }
  // Process-wide in Bullet, but stateless: it asks the bodies. A static initialiser runs once.
  static const bool installed = (gContactAddedCallback = &set_pair_law) != nullptr;
  static_cast<void>(installed);
  return std::make_unique<BulletSimulation>(world, settings);
}

}  // namespace

Adapter bullet_adapter() {
  const int version = btGetVersion();
  const std::string precision = btIsDoublePrecision() ? "f64" : "f32";
  return {.name = "bullet",
          .version = fmt::format("{}.{:02}", version / 100, version % 100),
          .variants = {{"si", "sequential impulses, 50 iterations, tuned", precision,
                        tuned_values(k_knobs)},
                       {"nncg", "nonlinear conjugate gradients, 50 iterations, tuned", precision,
                        tuned_values(k_knobs)},
                       {"default", "the library's own settings: sequential impulses, 10 iterations",
                        precision, library_values(k_knobs)}},
          .knobs = to_knobs(k_knobs),
          .build = &build_bullet,
          .scheme = &bullet_scheme,
          .asked = &asked_of_bullet};
}

}  // namespace brickbench
