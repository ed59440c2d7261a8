// The knobs of the Bullet adapter and the objects of one Bullet world; bullet.cpp says why they are
// set so.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexPlaneCollisionAlgorithm.h>
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <btBulletDynamicsCommon.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "adapters/seam/knob_table.hpp"
#include "adapters/seam/shape.hpp"

namespace brickbench::bullet {

static_assert(sizeof(btScalar) == 8, "the adapter wants Bullet in double precision");

inline constexpr double k_max_turn_rad =
    SIMD_HALF_PI;  // per step; btRigidBody::integrateVelocities clamps
// btTransformUtil::ANGULAR_MOTION_THRESHOLD, a macro of the source: larger turns come out smaller.
inline constexpr double k_largest_way_rad = 0.5 * SIMD_HALF_PI;

inline btVector3 to_bt(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3d from_bt(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
inline btTransform to_bt(const State& s) {
  const Eigen::Quaterniond& q = s.orientation;
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), to_bt(s.position_m));
}

inline std::size_t index_of(const btCollisionObject* object) {
  return static_cast<std::size_t>(object->getUserIndex());
}

// Bullet asks here for each new or refreshed contact point; the body carries its World. Both bodies
// of a point belong to the same one, and the law is symmetric.
inline bool set_pair_law(btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int,
                         const btCollisionObjectWrapper* b, int, int) {
  const btCollisionObject* body_a = a->getCollisionObject();
  const btCollisionObject* body_b = b->getCollisionObject();
  const auto* world = static_cast<const World*>(body_a->getUserPointer());
  const ContactLaw law = contact_law(*world, index_of(body_a), index_of(body_b));
  point.m_combinedFriction = law.friction;
  point.m_combinedRestitution = law.restitution;
  return true;
}

inline std::unique_ptr<btCollisionShape> make_shape(const Shape& shape, double max_box_margin_m) {
  using Made = std::unique_ptr<btCollisionShape>;
  return by_shape(
      shape,
      [&](const BoxShape& box) -> Made {
        auto made = std::make_unique<btBoxShape>(to_bt(box.half_extents_m));
        made->setMargin(std::min(made->getMargin(), max_box_margin_m));
        return made;
      },
      [](const SphereShape& ball) -> Made {
        return std::make_unique<btSphereShape>(ball.radius_m);
      },
      [](const PlaneShape&) -> Made {
        return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0);
      });
}

inline Shape read_shape(const btCollisionShape& shape) {
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
      return BoxShape{from_bt(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin())};
    case SPHERE_SHAPE_PROXYTYPE:
      return SphereShape{static_cast<const btSphereShape&>(shape).getRadius()};
    case STATIC_PLANE_PROXYTYPE:
      return PlaneShape{};
    default:
      throw std::logic_error("a shape of Bullet that this adapter never makes");
  }
}

inline int gyroscopic_flag(double knob) {
  constexpr std::array flags = {0, int{BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT},
                                int{BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD},
                                int{BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY}};
  return flags[static_cast<std::size_t>(knob)];
}

// The knob that gives a body these flags; -1: none does.
inline double gyroscopic_knob(int flags) {
  for (const int knob : {0, 1, 2, 3}) {
    if (gyroscopic_flag(knob) == flags) return knob;
  }
  return -1;
}

inline constexpr int k_two_directions = SOLVER_USE_2_FRICTION_DIRECTIONS;
inline constexpr const char* k_si_solver = "btSequentialImpulseConstraintSolver";
inline constexpr const char* k_nncg_solver = "btNNCGConstraintSolver";

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

  // Bodies stand in the world after join() alone.
  Scene(const World& facts, bool conjugate_gradients, double max_box_margin_m);
  ~Scene() {
    for (auto& body : bodies) world->removeRigidBody(body.get());
  }
  void join() {
    for (auto& body : bodies) world->addRigidBody(body.get());
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

 private:
  void make(const World& facts, std::size_t index, double max_box_margin_m);
};

// As the function that makes box-plane algorithms holds it.
inline double plane_perturbations(const Scene& scene) {
  using Create = btConvexPlaneCollisionAlgorithm::CreateFunc;
  auto& configuration = const_cast<btDefaultCollisionConfiguration&>(scene.configuration);
  const auto* create = static_cast<const Create*>(
      configuration.getCollisionAlgorithmCreateFunc(BOX_SHAPE_PROXYTYPE, STATIC_PLANE_PROXYTYPE));
  return create->m_minimumPointsPerturbationThreshold == 0 ? 0
                                                           : create->m_numPerturbationIterations;
}

inline void Scene::make(const World& facts, std::size_t index, double max_box_margin_m) {
  const Body& fact = facts.bodies[index];
  shapes.push_back(make_shape(fact.shape, max_box_margin_m));
  btRigidBody::btRigidBodyConstructionInfo info(
      fact.fixed ? 0.0 : fact.mass_kg, nullptr, shapes.back().get(),
      fact.fixed ? btVector3(0, 0, 0) : to_bt(fact.inertia_kgm2));
  info.m_startWorldTransform = to_bt(fact.initial);
  bodies.push_back(std::make_unique<btRigidBody>(info));
  btRigidBody& body = *bodies.back();
  body.setUserIndex(static_cast<int>(index));
  body.setUserPointer(const_cast<World*>(&facts));
  body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
  if (!fact.fixed) {
    body.setActivationState(DISABLE_DEACTIVATION);
    body.setLinearVelocity(to_bt(fact.initial.velocity_mps));
    body.setAngularVelocity(to_bt(fact.initial.angular_velocity_radps));
  }
}

inline Scene::Scene(const World& facts, bool conjugate_gradients, double max_box_margin_m) {
  if (conjugate_gradients) {
    solver = std::make_unique<btNNCGConstraintSolver>();
  } else {
    auto made = std::make_unique<WatchedSolver>();
    watched = made.get();
    solver = std::move(made);
  }
  world = std::make_unique<btDiscreteDynamicsWorld>(&dispatcher, &broadphase, solver.get(),
                                                    &configuration);
  world->setGravity(to_bt(facts.gravity_mps2));
  world->getSolverInfo().m_solverMode = SOLVER_USE_WARMSTARTING | SOLVER_SIMD;
  for (std::size_t i = 0; i < facts.bodies.size(); ++i) make(facts, i, max_box_margin_m);
}

// set and read of a knob that is a member of the solver's settings.
template <auto member>
struct OfSolver;
template <class Value, Value btContactSolverInfoData::*member>
struct OfSolver<member> {
  static void set(Scene& scene, double value) {
    scene.world->getSolverInfo().*member = static_cast<Value>(value);
  }
  static LiveValues read(const Scene& scene) {
    return {static_cast<double>(scene.world->getSolverInfo().*member)};
  }
};

template <typename Ask>
LiveValues of_bodies(const Scene& scene, const Ask& ask) {
  LiveValues values;
  for (const auto& body : scene.bodies) values.push_back(ask(*body));
  return values;
}

using Row = KnobRow<Scene>;
using Info = btContactSolverInfo;

inline constexpr std::array k_knobs = {
    Row{"iterations", "1", 10, 50, 1, 1e6, true, "sweeps of the contact solver",
        &OfSolver<&Info::m_numIterations>::set, &OfSolver<&Info::m_numIterations>::read},
    Row{"erp", "1", 0.2, 0.2, 0, 1, false, "share of a penetration removed per step",
        &OfSolver<&Info::m_erp2>::set, &OfSolver<&Info::m_erp2>::read},
    Row{"cfm", "1", 0, 0, 0, 1e6, false, "constraint force mixing of the contact rows",
        &OfSolver<&Info::m_globalCfm>::set, &OfSolver<&Info::m_globalCfm>::read},
    Row{"split_impulse", "1", 1, 1, 0, 1, true, "1: depth is corrected outside the velocities",
        &OfSolver<&Info::m_splitImpulse>::set, &OfSolver<&Info::m_splitImpulse>::read},
    Row{"split_impulse_threshold_m", "m", -0.04, 0, -1e6, 0, false,
        "gap below which split impulse replaces Baumgarte velocities",
        &OfSolver<&Info::m_splitImpulsePenetrationThreshold>::set,
        &OfSolver<&Info::m_splitImpulsePenetrationThreshold>::read},
    Row{"restitution_threshold_mps", "m/s", 0.2, 0, 0, 1e6, false,
        "approach speed below which nothing bounces",
        &OfSolver<&Info::m_restitutionVelocityThreshold>::set,
        &OfSolver<&Info::m_restitutionVelocityThreshold>::read},
    Row{"contact_processing_threshold_m", "m", BT_LARGE_FLOAT, 1e-8, 0, BT_LARGE_FLOAT, false,
        "gap above which a contact point gets no row in the solver",
        [](Scene& scene, double value) {
          for (auto& body : scene.bodies) body->setContactProcessingThreshold(value);
        },
        [](const Scene& scene) {
          return of_bodies(scene, [](auto& body) { return body.getContactProcessingThreshold(); });
        },
        true},
    Row{"gyroscopic", "1", 3, 3, 0, 3, true,
        "0 off, 1 explicit, 2 implicit in the world frame, 3 implicit in the body frame",
        [](Scene& scene, double value) {
          for (auto& body : scene.bodies) body->setFlags(gyroscopic_flag(value));
        },
        [](const Scene& scene) {
          return of_bodies(scene, [](auto& body) { return gyroscopic_knob(body.getFlags()); });
        },
        true},
    Row{"warm_starting", "1", 0.85, 0.85, 0, 1, false, "share of the last impulse to start from",
        &OfSolver<&Info::m_warmstartingFactor>::set, &OfSolver<&Info::m_warmstartingFactor>::read},
    Row{"friction_directions", "1", 1, 2, 1, 2, true, "friction rows per contact point",
        [](Scene& scene, double value) {
          if (value > 1) scene.world->getSolverInfo().m_solverMode |= k_two_directions;
        },
        [](const Scene& scene) -> LiveValues {
          return {(scene.world->getSolverInfo().m_solverMode & k_two_directions) != 0 ? 2.0 : 1.0};
        }},
    Row{"max_box_margin_m", "m", 0.04, 0, 0, 0.04, false,
        "radius of a box's rounded edges against spheres (also at most a tenth of its half size)"},
    Row{"plane_perturbations", "1", 0, 8, 0, 64, true,
        "extra support queries between a box and a plane while they share fewer than 4 points",
        [](Scene& scene, double value) {
          if (value == 0.0) return;
          scene.configuration.setPlaneConvexMultipointIterations(static_cast<int>(value), 4);
        },
        [](const Scene& scene) -> LiveValues { return {plane_perturbations(scene)}; }},
};

}  // namespace brickbench::bullet
