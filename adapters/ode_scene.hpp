// The knobs of the ODE adapter, its turn with what ODE keeps per process, and the objects of one
// ODE world; ode.cpp says why they are set so.
#pragma once

#include <fmt/core.h>
#include <ode/ode.h>

#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <stdexcept>

#include "adapters/seam/knob_table.hpp"
#include "adapters/seam/shape.hpp"

namespace brickbench::ode {

static_assert(sizeof(dReal) == 8, "the adapter wants ODE in double precision");

inline constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Below this slip (m/s) a contact keeps the friction axes that ODE would choose.
inline constexpr double k_no_slip_mps = 1e-9;

// More points than ODE makes for any pair of its shapes that we use: eight for two boxes.
inline constexpr int k_most_points = 64;

// What ODE said since the session began. Guarded by Session's lock.
struct Messages {
  int count = 0;
  std::string last;
};
inline Messages& messages() {
  static Messages heard;
  return heard;
}

inline std::string to_text(const char* format, va_list arguments) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  return text.data();
}
inline void on_message(int, const char* format, va_list arguments) {
  ++messages().count;
  messages().last = to_text(format, arguments);
}
[[noreturn]] inline void on_error(int number, const char* format, va_list arguments) {
  throw std::runtime_error(fmt::format("ODE error {}: {}", number, to_text(format, arguments)));
}

// One simulation's turn with what ODE keeps per process: the random seed and the message handlers.
// The library is opened at the first turn and never closed: other worlds may be alive. Throws
// nothing, so that a destructor may have its turn: ready() says whether ODE can be used.
class Session {
 public:
  explicit Session(unsigned long& seed) : lock_(mutex()), seed_(seed), foreign_(dRandGetSeed()) {
    static const bool opened = dInitODE2(0) != 0;
    ready_ = opened && dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll)) != 0;
    dSetErrorHandler(&on_error);
    dSetDebugHandler(&on_error);
    dSetMessageHandler(&on_message);
    messages() = {};
    dRandSetSeed(seed_);
  }
  ~Session() {
    seed_ = dRandGetSeed();
    dRandSetSeed(foreign_);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  bool ready() const { return ready_; }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  unsigned long& seed_;
  unsigned long foreign_;
  bool ready_ = false;
};

inline Eigen::Vector3d to_eigen(const dReal* v) { return {v[0], v[1], v[2]}; }
inline std::size_t index_of(dGeomID geom) {
  return reinterpret_cast<std::size_t>(dGeomGetData(geom));
}

inline void set_position(dGeomID geom, const State& s) {
  const Eigen::Quaterniond& q = s.orientation;
  const dQuaternion turn = {q.w(), q.x(), q.y(), q.z()};
  dGeomSetPosition(geom, s.position_m.x(), s.position_m.y(), s.position_m.z());
  dGeomSetQuaternion(geom, turn);
}

inline dGeomID make_geom(dSpaceID space, const Body& fact) {
  return by_shape(
      fact.shape,
      [&](const BoxShape& box) {
        const Eigen::Vector3d sides_m = 2.0 * box.half_extents_m;
        return dCreateBox(space, sides_m.x(), sides_m.y(), sides_m.z());
      },
      [&](const SphereShape& ball) { return dCreateSphere(space, ball.radius_m); },
      [&](const PlaneShape&) {
        const Eigen::Vector3d normal = fact.initial.orientation * Eigen::Vector3d::UnitZ();
        return dCreatePlane(space, normal.x(), normal.y(), normal.z(),
                            normal.dot(fact.initial.position_m));
      });
}

inline Shape read_shape(dGeomID geom) {
  switch (dGeomGetClass(geom)) {
    case dBoxClass: {
      dVector3 sides_m;
      dGeomBoxGetLengths(geom, sides_m);
      return BoxShape{0.5 * to_eigen(sides_m)};
    }
    case dSphereClass:
      return SphereShape{dGeomSphereGetRadius(geom)};
    case dPlaneClass:
      return PlaneShape{};
    default:
      throw std::logic_error("a geom of ODE that this adapter never makes");
  }
}

// A contact joint of the last step. ODE writes the forces of the step into `feedback`.
struct Touch {
  dContactGeom geom{};
  dJointFeedback feedback{};
};

// The objects of one ODE world; destroyed in the reverse order of making.
struct Scene {
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  dJointGroupID joints = dJointGroupCreate(0);
  std::vector<dBodyID> bodies;  // order of World::bodies; nullptr for fixed bodies
  std::vector<dGeomID> geoms;   // order of World::bodies
  std::deque<Touch> touches;    // stable addresses
  // What ODE leaves to its user, for each contact.
  std::vector<dContact> points;  // (most per pair), scratch
  double restitution_threshold_mps = 0.0;
  bool slip_aligned = false;

  explicit Scene(const World& facts);
  ~Scene() {
    dJointGroupDestroy(joints);
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

 private:
  dBodyID make_body(const Body& fact, dGeomID geom);
};

inline dBodyID Scene::make_body(const Body& fact, dGeomID geom) {
  const dBodyID body = dBodyCreate(world);
  dMass mass;
  const Eigen::Vector3d& inertia = fact.inertia_kgm2;
  dMassSetParameters(&mass, fact.mass_kg, 0, 0, 0, inertia.x(), inertia.y(), inertia.z(), 0, 0, 0);
  dBodySetMass(body, &mass);
  dGeomSetBody(geom, body);
  set_position(geom, fact.initial);  // of a geom with a body: moves the body
  const Eigen::Vector3d& v = fact.initial.velocity_mps;
  const Eigen::Vector3d& w = fact.initial.angular_velocity_radps;
  dBodySetLinearVel(body, v.x(), v.y(), v.z());
  dBodySetAngularVel(body, w.x(), w.y(), w.z());
  return body;
}

inline Scene::Scene(const World& facts) {
  dWorldSetGravity(world, facts.gravity_mps2.x(), facts.gravity_mps2.y(), facts.gravity_mps2.z());
  dWorldSetAutoDisableFlag(world, 0);
  dWorldSetDamping(world, 0, 0);
  for (std::size_t i = 0; i < facts.bodies.size(); ++i) {
    const Body& fact = facts.bodies[i];
    const dGeomID geom = make_geom(space, fact);
    dGeomSetData(geom, reinterpret_cast<void*>(i));
    geoms.push_back(geom);
    bodies.push_back(fact.fixed ? nullptr : make_body(fact, geom));
    if (fact.fixed && dGeomGetClass(geom) != dPlaneClass) set_position(geom, fact.initial);
  }
}

// set and read of a knob that ODE keeps in its world.
template <auto set_in_world, auto get_from_world>
struct OfWorld {
  static void set(Scene& scene, double value) {
    using Value = decltype(get_from_world(scene.world));
    set_in_world(scene.world, static_cast<Value>(value));
  }
  static LiveValues read(const Scene& scene) {
    return {static_cast<double>(get_from_world(scene.world))};
  }
};

// set and read of a mode, 0 or 1, that ODE keeps in each body.
template <auto set_in_body, auto get_from_body>
struct OfBodies {
  static void set(Scene& scene, double value) {
    for (const dBodyID body : scene.bodies) {
      if (body != nullptr) set_in_body(body, static_cast<int>(value));
    }
  }
  static LiveValues read(const Scene& scene) {
    LiveValues values;
    for (const dBodyID body : scene.bodies) {
      if (body != nullptr) values.push_back(get_from_body(body) != 0 ? 1.0 : 0.0);
    }
    return values;
  }
};

using Row = KnobRow<Scene>;
using Iterations = OfWorld<&dWorldSetQuickStepNumIterations, &dWorldGetQuickStepNumIterations>;
using Relaxation = OfWorld<&dWorldSetQuickStepW, &dWorldGetQuickStepW>;
using Erp = OfWorld<&dWorldSetERP, &dWorldGetERP>;
using Cfm = OfWorld<&dWorldSetCFM, &dWorldGetCFM>;
using Correcting = OfWorld<&dWorldSetContactMaxCorrectingVel, &dWorldGetContactMaxCorrectingVel>;
using Layer = OfWorld<&dWorldSetContactSurfaceLayer, &dWorldGetContactSurfaceLayer>;
using Gyroscopic = OfBodies<&dBodySetGyroscopicMode, &dBodyGetGyroscopicMode>;
using FiniteRotation = OfBodies<&dBodySetFiniteRotationMode, &dBodyGetFiniteRotationMode>;
using Threshold = Held<&Scene::restitution_threshold_mps>;
using SlipAligned = Held<&Scene::slip_aligned>;

inline constexpr std::array k_knobs = {
    Row{"iterations", "1", 20, 50, 1, 1e6, true, "sweeps of QuickStep", &Iterations::set,
        &Iterations::read},
    Row{"over_relaxation", "1", 1.3, 1.3, 0.1, 1.9, false, "over-relaxation of QuickStep",
        &Relaxation::set, &Relaxation::read},
    Row{"erp", "1", 0.2, 0.2, 0, 1, false, "share of a penetration removed per step", &Erp::set,
        &Erp::read},
    Row{"cfm", "1", 1e-10, 1e-10, 0, 1e6, false, "constraint force mixing of all rows", &Cfm::set,
        &Cfm::read},
    Row{"max_correcting_velocity_mps", "m/s", k_infinity, 0.1, 0, k_infinity, false,
        "limit of the velocity that removes penetrations", &Correcting::set, &Correcting::read},
    Row{"contact_surface_layer_m", "m", 0, 0, 0, 1, false, "penetration that is left alone",
        &Layer::set, &Layer::read},
    Row{"max_contacts", "1", 8, 8, 1, 64, true,
        "contact points per pair (ODE leaves the number to its user)",
        [](Scene& scene, double value) { scene.points.resize(static_cast<std::size_t>(value)); },
        [](const Scene& scene) -> LiveValues {
          return {static_cast<double>(scene.points.size())};
        }},
    Row{"restitution_threshold_mps", "m/s", 0, 0, 0, 1e6, false,
        "approach speed below which nothing bounces (ODE leaves it to its user)", &Threshold::set,
        &Threshold::read},
    Row{"slip_aligned_friction", "1", 0, 1, 0, 1, true,
        "1: the friction pyramid's first axis follows the slip; 0: fixed axes", &SlipAligned::set,
        &SlipAligned::read},
    Row{"gyroscopic", "1", 1, 1, 0, 1, true, "1: gyroscopic torque of free bodies; 0: none",
        &Gyroscopic::set, &Gyroscopic::read, true},
    Row{"finite_rotation", "1", 0, 0, 0, 1, true,
        "1: orientations turn by finite rotations; 0: by one Euler step of the quaternion",
        &FiniteRotation::set, &FiniteRotation::read, true},
};

}  // namespace brickbench::ode
