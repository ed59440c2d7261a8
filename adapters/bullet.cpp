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
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <btBulletDynamicsCommon.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "adapters/seam/knob_table.hpp"

namespace brickbench {
namespace {

static_assert(sizeof(btScalar) == 8, "the adapter wants Bullet in double precision");

constexpr double k_max_turn_rad =
    SIMD_HALF_PI;  // per step; btRigidBody::integrateVelocities clamps

constexpr std::array k_knobs = {
    KnobRow{"iterations", "1", 10, 50, 1, 1e6, true, "sweeps of the contact solver"},
    KnobRow{"erp", "1", 0.2, 0.2, 0, 1, false, "share of a penetration removed per step"},
    KnobRow{"cfm", "1", 0, 0, 0, 1e6, false, "constraint force mixing of the contact rows"},
    KnobRow{"split_impulse", "1", 1, 1, 0, 1, true, "1: depth is corrected outside the velocities"},
    KnobRow{"split_impulse_threshold_m", "m", -0.04, 0, -1e6, 0, false,
            "gap below which split impulse replaces Baumgarte velocities"},
    KnobRow{"restitution_threshold_mps", "m/s", 0.2, 0, 0, 1e6, false,
            "approach speed below which nothing bounces"},
    KnobRow{"contact_processing_threshold_m", "m", BT_LARGE_FLOAT, 1e-8, 0, BT_LARGE_FLOAT, false,
            "gap above which a contact point gets no row in the solver"},
    KnobRow{"gyroscopic", "1", 3, 3, 0, 3, true,
            "0 off, 1 explicit, 2 implicit in the world frame, 3 implicit in the body frame"},
    KnobRow{"warm_starting", "1", 0.85, 0.85, 0, 1, false,
            "share of the last impulse to start from"},
    KnobRow{"friction_directions", "1", 1, 2, 1, 2, true, "friction rows per contact point"},
    KnobRow{
        "max_box_margin_m", "m", 0.04, 0, 0, 0.04, false,
        "radius of a box's rounded edges against spheres (also at most a tenth of its half size)"},
    KnobRow{"plane_perturbations", "1", 0, 8, 0, 64, true,
            "extra support queries between a box and a plane while they share fewer than 4 points"},
};

btVector3 to_bt(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d from_bt(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
btTransform to_bt(const State& s) {
  const Eigen::Quaterniond& q = s.orientation;
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), to_bt(s.position_m));
}

std::size_t index_of(const btCollisionObject* object) {
  return static_cast<std::size_t>(object->getUserIndex());
}

// Bullet asks here for each new or refreshed contact point; the body carries its World. Both bodies
// of a point belong to the same one, and the law is symmetric.
bool set_pair_law(btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int,
                  const btCollisionObjectWrapper* b, int, int) {
  const btCollisionObject* body_a = a->getCollisionObject();
  const btCollisionObject* body_b = b->getCollisionObject();
  const auto* world = static_cast<const World*>(body_a->getUserPointer());
  const ContactLaw law = contact_law(*world, index_of(body_a), index_of(body_b));
  point.m_combinedFriction = law.friction;
  point.m_combinedRestitution = law.restitution;
  return true;
}

std::unique_ptr<btCollisionShape> make_shape(const Shape& shape, double max_box_margin_m) {
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    auto made = std::make_unique<btBoxShape>(to_bt(box->half_extents_m));
    made->setMargin(std::min(made->getMargin(), max_box_margin_m));
    return made;
  }
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
    return std::make_unique<btSphereShape>(sphere->radius_m);
  }
  return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0);
}

Shape read_shape(const btCollisionShape& shape) {
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
      return BoxShape{from_bt(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin())};
    case SPHERE_SHAPE_PROXYTYPE:
      return SphereShape{static_cast<const btSphereShape&>(shape).getRadius()};
    default:
      return PlaneShape{};
  }
}

int gyroscopic_flag(double knob) {
  constexpr std::array flags = {0, int{BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT},
                                int{BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD},
                                int{BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY}};
  return flags[static_cast<std::size_t>(knob)];
}

// Sequential impulses that keep the worst residual of the islands of a step: squared change of a
// row's velocity in the last sweep (Bullet's own analytics hold the last island only).
struct WatchedSolver final : btSequentialImpulseConstraintSolver {
  double residual_m2ps2 = 0.0;

  btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int body_count,
                                             btPersistentManifold** manifolds, int manifold_count,
                                             btTypedConstraint** joints, int joint_count,
                                             const btContactSolverInfo& info,
                                             btIDebugDraw* drawer) override {
    const btScalar result = btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations(
        bodies, body_count, manifolds, manifold_count, joints, joint_count, info, drawer);
    residual_m2ps2 = std::max(residual_m2ps2, m_leastSquaresResidual);
    return result;
  }
};

// The objects of one Bullet world, in the order in which they must be made.
struct Scene {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  WatchedSolver* watched = nullptr;  // `solver`, if it is sequential impulses
  std::unique_ptr<btSequentialImpulseConstraintSolver> solver;
  std::unique_ptr<btDiscreteDynamicsWorld> world;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;  // order of World::bodies

  Scene(const World& facts, const Settings& settings);
  ~Scene() {
    for (auto& body : bodies) world->removeRigidBody(body.get());
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

 private:
  void configure(const Settings& settings);
  void add(const World& facts, std::size_t index, const Settings& settings);
};

void Scene::configure(const Settings& settings) {
  const auto value = [&](std::string_view name) { return knob_value(k_knobs, settings, name); };
  btContactSolverInfo& info = world->getSolverInfo();
  info.m_numIterations = static_cast<int>(value("iterations"));
  info.m_erp2 = value("erp");
  info.m_globalCfm = value("cfm");
  info.m_splitImpulse = static_cast<int>(value("split_impulse"));
  info.m_splitImpulsePenetrationThreshold = value("split_impulse_threshold_m");
  info.m_restitutionVelocityThreshold = value("restitution_threshold_mps");
  info.m_warmstartingFactor = value("warm_starting");
  info.m_solverMode = SOLVER_USE_WARMSTARTING | SOLVER_SIMD;
  if (value("friction_directions") > 1) info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
  if (const int turns = static_cast<int>(value("plane_perturbations")); turns > 0) {
    configuration.setPlaneConvexMultipointIterations(turns, 4);
  }
}

void Scene::add(const World& facts, std::size_t index, const Settings& settings) {
  const Body& fact = facts.bodies[index];
  shapes.push_back(make_shape(fact.shape, knob_value(k_knobs, settings, "max_box_margin_m")));
  btRigidBody::btRigidBodyConstructionInfo info(
      fact.fixed ? 0.0 : fact.mass_kg, nullptr, shapes.back().get(),
      fact.fixed ? btVector3(0, 0, 0) : to_bt(fact.inertia_kgm2));
  info.m_startWorldTransform = to_bt(fact.initial);
  bodies.push_back(std::make_unique<btRigidBody>(info));
  btRigidBody& body = *bodies.back();
  body.setUserIndex(static_cast<int>(index));
  body.setUserPointer(const_cast<World*>(&facts));
  body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
  body.setContactProcessingThreshold(
      knob_value(k_knobs, settings, "contact_processing_threshold_m"));
  body.setFlags(gyroscopic_flag(knob_value(k_knobs, settings, "gyroscopic")));
  if (!fact.fixed) {
    body.setActivationState(DISABLE_DEACTIVATION);
    body.setLinearVelocity(to_bt(fact.initial.velocity_mps));
    body.setAngularVelocity(to_bt(fact.initial.angular_velocity_radps));
  }
  world->addRigidBody(&body);
}

Scene::Scene(const World& facts, const Settings& settings) {
  if (settings.variant == "nncg") {
    solver = std::make_unique<btNNCGConstraintSolver>();
  } else {
    auto made = std::make_unique<WatchedSolver>();
    watched = made.get();
    solver = std::move(made);
  }
  world = std::make_unique<btDiscreteDynamicsWorld>(&dispatcher, &broadphase, solver.get(),
                                                    &configuration);
  world->setGravity(to_bt(facts.gravity_mps2));
  configure(settings);
  for (std::size_t i = 0; i < facts.bodies.size(); ++i) add(facts, i, settings);
}

class BulletSimulation final : public Simulation,
                               ContactView,
                               StateView,
                               AuditView,
                               DiagnosticView {
 public:
  BulletSimulation(const World& facts, Settings settings)
      : facts_(facts), settings_(std::move(settings)) {
    scene_ = std::make_unique<Scene>(facts_, settings_);
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
    scene_->world->stepSimulation(settings_.step_s, 0);
    return inspect();
  }

  void read(std::span<State> states) const override {
    for (std::size_t i = 0; i < states.size(); ++i) states[i] = state_of(i);
  }

  const ContactView* contact_view() const override { return this; }
  StateView* state_view() override { return this; }
  const AuditView* audit_view() const override { return this; }
  const DiagnosticView* diagnostic_view() const override { return this; }

  void contacts(std::vector<Contact>& contacts) const override;
  Expected<void> set_state(std::span<const State> states) override;
  Audit audit() const override;
  ContactLaw pair_law(std::size_t a, std::size_t b) const override;
  std::span<const Diagnostic> diagnostics() const override { return diagnostics_; }

 private:
  State state_of(std::size_t i) const;
  Expected<void> inspect();

  World facts_;  // the bodies point at it; its initial states are those of the last set_state
  Settings settings_;
  std::unique_ptr<Scene> scene_;
  std::vector<Diagnostic> diagnostics_;
};

State BulletSimulation::state_of(std::size_t i) const {
  const btRigidBody& body = *scene_->bodies[i];
  const btQuaternion q = body.getWorldTransform().getRotation();
  return {.position_m = from_bt(body.getWorldTransform().getOrigin()),
          .orientation = {q.w(), q.x(), q.y(), q.z()},
          .velocity_mps = from_bt(body.getLinearVelocity()),
          .angular_velocity_radps = from_bt(body.getAngularVelocity())};
}

// What Bullet does without telling: states that are not finite, bodies switched off because their
// bounding box overflowed, spins clamped to a quarter turn per step.
Expected<void> BulletSimulation::inspect() {
  double clamped = 0.0;
  for (std::size_t i = 0; i < facts_.bodies.size(); ++i) {
    if (facts_.bodies[i].fixed) continue;
    const State state = state_of(i);
    const std::string& name = facts_.bodies[i].name;
    if (!is_finite(state)) {
      return fail(Fault::diverged, fmt::format("state of body '{}' is not finite", name));
    }
    if (scene_->bodies[i]->getActivationState() != DISABLE_DEACTIVATION) {
      return fail(Fault::crashed, fmt::format("Bullet switched off body '{}' (its bounding box "
                                              "overflowed)",
                                              name));
    }
    const double turn_rad = state.angular_velocity_radps.norm() * settings_.step_s;
    if (turn_rad >= k_max_turn_rad * (1.0 - 1e-12)) clamped += 1.0;
  }
  diagnostics_ = {{"spin_clamped_bodies", "1", clamped}};
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

// Builds the world anew: Bullet's future depends on manifolds, pair order and trees as well.
Expected<void> BulletSimulation::set_state(std::span<const State> states) {
  World next = facts_;
  for (std::size_t i = 0; i < next.bodies.size(); ++i) {
    if (!next.bodies[i].fixed) next.bodies[i].initial = states[i];
  }
  if (auto valid = validate(next); !valid) return valid;
  scene_.reset();
  facts_ = std::move(next);
  scene_ = std::make_unique<Scene>(facts_, settings_);
  diagnostics_.clear();
  return {};
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
  const btContactSolverInfo& info = scene_->world->getSolverInfo();
  const auto fact = [&](const char* name, const char* unit, auto value) {
    audit.settings.push_back({name, unit, fmt::format("{}", value)});
  };
  const bool nncg = scene_->solver->getSolverType() == BT_NNCG_SOLVER;
  fact("solver", "", nncg ? "btNNCGConstraintSolver" : "btSequentialImpulseConstraintSolver");
  fact("solver_mode_bits", "", info.m_solverMode);
  fact("iterations", "1", info.m_numIterations);
  fact("erp", "1", info.m_erp2);
  fact("cfm", "1", info.m_globalCfm);
  fact("split_impulse", "1", info.m_splitImpulse);
  fact("split_impulse_threshold_m", "m", info.m_splitImpulsePenetrationThreshold);
  fact("linear_slop_m", "m", info.m_linearSlop);
  fact("restitution_threshold_mps", "m/s", info.m_restitutionVelocityThreshold);
  fact("warm_starting", "1", info.m_warmstartingFactor);
  if (scene_->bodies.empty()) return audit;
  const btRigidBody& last = *scene_->bodies.back();
  fact("contact_processing_threshold_m", "m", last.getContactProcessingThreshold());
  fact("gyroscopic_flags", "", last.getFlags());
  fact("margin_of_last_body_m", "m", last.getCollisionShape()->getMargin());
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

std::optional<Scheme> bullet_scheme(const Settings& settings) {
  const auto value = [&](std::string_view name) { return knob_value(k_knobs, settings, name); };
  constexpr std::array gyroscopic = {GyroscopicRule::neglected, GyroscopicRule::explicit_body,
                                     GyroscopicRule::explicit_body, GyroscopicRule::newton_body};
  const auto flag = static_cast<std::size_t>(value("gyroscopic"));
  if (flag == 2) return std::nullopt;  // its implicit world-frame update has no name in Scheme
  Scheme scheme;
  scheme.source =
      "Coumans, Bullet 3.24: btRigidBody::predictIntegratedTransform, computeGyroscopicImpulse*, "
      "btSequentialImpulseConstraintSolver::setupContactConstraint";
  scheme.gyroscopic = gyroscopic[flag];
  // A larger threshold is cut by the breaking threshold of the shapes at hand: not one number.
  const double margin_m = value("contact_processing_threshold_m");
  if (margin_m > 1e-6) return scheme;
  scheme.impulse = {.margin_m = margin_m,
                    .approach_allowed = true,
                    .restitution_threshold_mps = value("restitution_threshold_mps"),
                    .sum_of_targets = true,
                    .error_reduction = value("erp"),
                    .softness_per_kgs = value("cfm")};
  if (value("split_impulse") > 0) {
    scheme.impulse->split_at_gap_m = value("split_impulse_threshold_m");
  }
  return scheme;
}

Expected<std::unique_ptr<Simulation>> build_bullet(const World& world, const Settings& settings) {
  if (auto ranges = check_ranges(k_knobs, settings); !ranges) {
    return tl::make_unexpected(ranges.error());
  }
  if (settings.threads > 1) {
    return fail(Fault::unsupported, "this Bullet is built without threads; threads must be 1");
  }
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
  return {
      .name = "bullet",
      .version = fmt::format("{}.{:02}", version / 100, version % 100),
      .precision = btIsDoublePrecision() ? "f64" : "f32",
      .variants = {{"si", "sequential impulses, 50 iterations, tuned"},
                   {"nncg", "nonlinear conjugate gradients, 50 iterations, tuned"},
                   {"default", "the library's own settings: sequential impulses, 10 iterations"}},
      .knobs = to_knobs(k_knobs),
      .build = &build_bullet,
      .scheme = &bullet_scheme};
}

}  // namespace brickbench
