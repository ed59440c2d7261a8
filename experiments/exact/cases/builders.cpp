#include "experiments/exact/cases/builders.hpp"

#include <cmath>
#include <limits>

namespace brickbench::exact {

using Eigen::Vector3d;

std::size_t step_count(const ParameterValues& values) {
  return static_cast<std::size_t>(
      std::llround(value_of(values, "duration_s") / value_of(values, "step_s")));
}

double one_step_s(const ParameterValues& values) { return value_of(values, "step_s"); }

std::string outruns(const ParameterValues& values, double speed_mps, double most_m) {
  const bool too_far = speed_mps * value_of(values, "step_s") > most_m;
  return too_far ? "a step of the approach is not small against the bodies" : "";
}

std::string leaves_floor(double way_m) {
  return way_m > k_way_on_floor_m ? "the brick slides off the floor" : "";
}

ExactRun start_run(const ParameterValues& values, bool gravity) {
  ExactRun run;
  run.step_s = value_of(values, "step_s");
  run.steps = step_count(values);
  run.world.gravity_mps2 = {0.0, 0.0, gravity ? -k_gravity_mps2 : 0.0};
  return run;
}

State at(const Vector3d& position_m, const Vector3d& velocity_mps,
         const Vector3d& angular_velocity_radps) {
  State state;
  state.position_m = position_m;
  state.velocity_mps = velocity_mps;
  state.angular_velocity_radps = angular_velocity_radps;
  return state;
}

Body box(std::string name, const Vector3d& half_extents_m, double mass_kg, State initial) {
  const BoxShape shape{half_extents_m};
  return solid_body(std::move(name), shape, mass_kg / solid_mass_kg(shape, 1.0), initial);
}

Body ball(std::string name, double radius_m, double mass_kg, State initial) {
  const SphereShape shape{radius_m};
  return solid_body(std::move(name), shape, mass_kg / solid_mass_kg(shape, 1.0), initial);
}

Body floor_slab() { return fixed_body("floor", BoxShape{{10.0, 10.0, 0.5}}, at({0.0, 0.0, -0.5})); }

Vector3d tilted_gravity_mps2(double angle_rad) {
  return k_gravity_mps2 * Vector3d(std::sin(angle_rad), 0.0, -std::cos(angle_rad));
}

ContactGeometry flat_contact(std::size_t ground, std::size_t body, double half_height_m) {
  return [=](std::span<const State> states, std::vector<PointContact>& contacts) {
    PointContact contact;
    contact.body_a = ground;
    contact.body_b = body;
    contact.gap_m = states[body].position_m.z() - half_height_m;
    contact.position_m = states[body].position_m - Vector3d(0.0, 0.0, half_height_m);
    contact.points = 4;
    contact.boxes = true;
    contact.central = true;
    contacts.push_back(contact);
  };
}

ContactGeometry sphere_contact(std::size_t ground, std::size_t body, double radius_m,
                               bool frictionless) {
  return [=](std::span<const State> states, std::vector<PointContact>& contacts) {
    PointContact contact;
    contact.body_a = ground;
    contact.body_b = body;
    contact.gap_m = states[body].position_m.z() - radius_m;
    contact.position_m = states[body].position_m - Vector3d(0.0, 0.0, radius_m);
    contact.central = frictionless;
    contacts.push_back(contact);
  };
}

ContactGeometry sphere_row_contact(std::vector<std::size_t> bodies, double radius_m) {
  return [=](std::span<const State> states, std::vector<PointContact>& contacts) {
    for (std::size_t i = 0; i + 1 < bodies.size(); ++i) {
      PointContact contact;
      contact.body_a = bodies[i];
      contact.body_b = bodies[i + 1];
      const Vector3d apart = states[contact.body_b].position_m - states[contact.body_a].position_m;
      contact.normal = apart.normalized();
      contact.gap_m = apart.norm() - 2.0 * radius_m;
      contact.position_m = states[contact.body_a].position_m + radius_m * contact.normal;
      contact.central = true;
      contacts.push_back(contact);
    }
  };
}

ContactGeometry both(ContactGeometry first, ContactGeometry second) {
  return [first = std::move(first), second = std::move(second)](
             std::span<const State> states, std::vector<PointContact>& contacts) {
    first(states, contacts);
    second(states, contacts);
  };
}

std::string symmetric_impact_law(std::span<const double> values, const ExactRun& run) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Truth& truth = run.truths[i];
    if (!(std::abs(values[i] - truth.value) <= k_law_band * truth.scale)) return "neither";
  }
  return "simultaneous";
}

Measure latest(std::function<void(const Sample&, std::span<double>)> look) { return look; }

double kinetic_energy_j(const World& world, std::span<const State> states) {
  double energy = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed) continue;
    energy += 0.5 * body.mass_kg * states[i].velocity_mps.squaredNorm() +
              0.5 * states[i].angular_velocity_radps.dot(spin_momentum_nms(body, states[i]));
  }
  return energy;
}

Vector3d momentum_ns(const World& world, std::span<const State> states) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!world.bodies[i].fixed) sum += world.bodies[i].mass_kg * states[i].velocity_mps;
  }
  return sum;
}

Vector3d angular_momentum_nms(const World& world, std::span<const State> states) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed) continue;
    sum += spin_momentum_nms(body, states[i]) +
           body.mass_kg * states[i].position_m.cross(states[i].velocity_mps);
  }
  return sum;
}

Vector3d spin_momentum_nms(const Body& body, const State& state) {
  const Eigen::Quaterniond& q = state.orientation;
  return q * body.inertia_kgm2.cwiseProduct(q.conjugate() * state.angular_velocity_radps);
}

double angle_between_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond turn = a.conjugate() * b;
  return 2.0 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

double lean_rad(const State& state) {
  const Vector3d axis = state.orientation * Vector3d::UnitZ();
  return std::atan2(axis.head<2>().norm(), axis.z());
}

Vector3d pair_impulse_ns(const Sample& sample, std::size_t a, std::size_t b) {
  if (sample.contacts == nullptr) {
    return Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  Vector3d sum = Vector3d::Zero();
  for (const Contact& contact : *sample.contacts) {
    if (contact.body_a == a && contact.body_b == b) sum += contact.impulse_ns;
    if (contact.body_a == b && contact.body_b == a) sum -= contact.impulse_ns;
  }
  return sum;
}

}  // namespace brickbench::exact
