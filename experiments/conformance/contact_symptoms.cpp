// Symptoms of contacts: laws, sizes, and what is told of contacts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/conformance/diagnosis.hpp"

namespace brickbench::conformance {
namespace {

using Eigen::Vector3d;

constexpr double k_gravity_mps2 = 9.81;

// Whether the engine builds and steps this world at all.
bool is_possible(const Subject& subject, const World& world) {
  const auto simulation = subject.build(world, k_step_s);
  return simulation && (*simulation)->step();
}

// A brick on a floor whose pair has this law; all other pairs have the other law.
World floor_world(const ContactLaw& pair, const ContactLaw& others, const State& brick) {
  World world;
  world.law = others;
  world.exceptions.push_back({0, 1, pair});
  world.bodies.push_back(fixed_body("floor", BoxShape{{20, 20, 1}}, at(0, 0, -1)));
  world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.1, 0.05}}, 2000.0, brick));
  world.bodies[1].surface = 1;
  return world;
}

double distance(double a, double b) { return std::abs(a - b); }

// The law that seems to act, where `right` should; the bands are wide because library defaults are.
std::string law_symptom(double seen, double right, double other_number, double of_others,
                        const std::string& what, const std::string& other_what, double band) {
  constexpr double fit = 0.05;
  if (distance(seen, right) <= band) return {};
  std::string words = fmt::format("{} acts like {:.3g} where {:.3g} was asked", what, seen, right);
  const std::vector<Model<double>> models = {
      {fmt::format("{} does not act", what), 0.0},
      {fmt::format("{} looks squared: multiplied over both surfaces", what), right * right},
      {fmt::format("{} looks like its square root", what), std::sqrt(right)},
      {fmt::format("{} and {} look exchanged", what, other_what), other_number},
      {fmt::format("the law of a single pair looks forgotten: {} is that of all others", what),
       of_others}};
  return nearest_model(seen, right, models, fit, distance, words);
}

// A slope of 1, so that all frictions below 1 let a brick slide, from rest: engines differ most in
// fast slip.
const Vector3d& slope_gravity_mps2() {
  static const Vector3d gravity = k_gravity_mps2 * Vector3d(1.0, 0.0, -1.0).normalized();
  return gravity;
}

// The friction with which a brick goes as far down the slope as it does.
double sliding_friction(const Subject& subject, const World& world) {
  constexpr int steps = 300;
  constexpr double time_s = steps * k_step_s;
  const States states = run(subject, world, k_step_s, steps, true);
  const double way_m = states[1].position_m.x() - world.bodies[1].initial.position_m.x();
  return 1.0 - 2.0 * way_m / (slope_gravity_mps2().x() * time_s * time_s);
}

std::string friction_symptom(const Subject& subject) {
  const State brick = at(0, 0, 0.05);
  const ContactLaw pair{0.6, 0.3}, others{0.9, 0.1}, dry{0.6, 0.0}, dry_others{0.9, 0.0};
  World world = floor_world(pair, others, brick);
  world.gravity_mps2 = slope_gravity_mps2();
  double exchanged = pair.restitution;
  if (!is_possible(subject, world)) {
    world = floor_world(dry, dry_others, brick);
    world.gravity_mps2 = slope_gravity_mps2();
    exchanged = 0.0;
  }
  if (!is_possible(subject, world)) return {};
  return law_symptom(sliding_friction(subject, world), pair.friction, exchanged, others.friction,
                     "friction", "restitution", 0.08);
}

// Speed of the first return over speed of the fall, from the height of the return.
double bounce(const Subject& subject, const World& world) {
  constexpr double step_s = 1.0 / 240.0, drop_m = 0.5, radius_m = 0.1;
  double highest_m = 0.0, last_m = 1.0;
  bool rising = false;
  run(subject, world, step_s, 216, true, [&](int, const States& states) {
    const double z_m = states[1].position_m.z();
    rising = rising || (z_m > last_m && z_m < 0.3);
    if (rising) highest_m = std::max(highest_m, z_m - radius_m);
    last_m = z_m;
  });
  return std::sqrt(std::max(highest_m, 0.0) / drop_m);
}

std::string restitution_symptom(const Subject& subject) {
  const ContactLaw pair{0.3, 0.6}, others{0.1, 0.9}, smooth{0.0, 0.6}, smooth_others{0.0, 0.9};
  const auto world_of = [](const ContactLaw& law, const ContactLaw& rest) {
    World world = floor_world(law, rest, at(0, 0, 0.6));
    world.bodies[1] = solid_body("ball", SphereShape{0.1}, 2000.0, at(0, 0, 0.6));
    world.bodies[1].surface = 1;
    return world;
  };
  World world = world_of(pair, others);
  double exchanged = pair.friction;
  if (!is_possible(subject, world)) {
    world = world_of(smooth, smooth_others);
    exchanged = 0.0;
  }
  if (!is_possible(subject, world)) return {};
  return law_symptom(bounce(subject, world), pair.restitution, exchanged, others.restitution,
                     "restitution", "friction", 0.18);
}

// A block of 20 m comes down on a floor: how far its centre is from it when it is first held up.
std::string size_symptom(const Subject& subject) {
  constexpr double half_m = 10.0, gap_m = 0.05, speed_mps = 1.0;
  World world;
  world.gravity_mps2.setZero();
  world.bodies.push_back(fixed_body("floor", BoxShape{{50, 50, 5}}, at(0, 0, -5)));
  world.bodies.push_back(
      solid_body("block", BoxShape{Vector3d::Constant(half_m)}, 1000.0, at(0, 0, half_m + gap_m)));
  world.bodies[1].initial.velocity_mps.z() = -speed_mps;
  if (!is_possible(subject, world)) return {};
  int held = 0;
  run(subject, world, k_step_s, 100, true, [&](int step, const States& states) {
    if (held == 0 && states[1].velocity_mps.z() > -0.99 * speed_mps) held = step;
  });
  if (held == 0) return "contact does not act: a block falls through the floor";
  constexpr double steps_of_grace = 5.0 * k_step_s * speed_mps;  // margins, and softness
  const double early_m = gap_m - held * k_step_s * speed_mps;
  if (std::abs(early_m) <= steps_of_grace) return {};
  return fmt::format("shapes look {:.4g} times as large as asked", 1.0 + early_m / half_m);
}

// What the contacts of a brick add up to, over many steps.
struct Told {
  Vector3d impulse_ns = Vector3d::Zero();   // on the brick
  Vector3d momentum_ns = Vector3d::Zero();  // that it got from contacts, as its states say
  double outside_m = 0.0;                   // furthest of a contact from the brick's surface
  bool normals_turned = false;
};

void see_contacts(const std::vector<Contact>& contacts, const State& state, Told& told) {
  const Vector3d half_m(0.1, 0.1, 0.05);
  for (const Contact& contact : contacts) {
    const double side = contact.body_b == 1 ? 1.0 : -1.0;
    told.impulse_ns += side * contact.impulse_ns;
    const Vector3d place = state.orientation.conjugate() * (contact.position_m - state.position_m);
    told.outside_m = std::max(told.outside_m, (place.cwiseAbs() - half_m).maxCoeff());
    told.normals_turned = told.normals_turned || side * contact.normal.z() < -0.5;
  }
}

std::optional<Told> told_of(const Subject& subject, const World& world, int settling) {
  constexpr int steps = 100;
  const auto simulation = must_build(subject, world, k_step_s, true);
  const ContactView* view = simulation->contact_view();
  if (view == nullptr) return std::nullopt;
  Told told;
  States before = read(*simulation, world);
  std::vector<Contact> contacts;
  for (int step = 0; step < settling + steps; ++step) {
    const States after = step_and_read(*simulation, world, true);
    view->contacts(contacts);
    if (step >= settling) {
      see_contacts(contacts, after[1], told);
      told.momentum_ns +=
          world.bodies[1].mass_kg *
          (after[1].velocity_mps - before[1].velocity_mps - k_step_s * world.gravity_mps2);
    }
    before = after;
  }
  return told;
}

std::string rest_symptom(const Told& told) {
  constexpr double allowed_m = 3e-3;
  if (told.normals_turned)
    return "contact normals look turned; asked is from body a towards body b";
  if (told.outside_m > allowed_m) {
    return fmt::format("contact points lie up to {:.2g} m outside the bodies", told.outside_m);
  }
  const double share = told.impulse_ns.z() / told.momentum_ns.z();
  const std::vector<Model<double>> models = {
      {"contact impulses look as if on body a; asked is on body b", -1.0},
      {"contact impulses look like forces; asked are N s of the step", 1.0 / k_step_s},
      {"contacts look told twice, or those of the step before again", 2.0},
      {"contact impulses are missing", 0.0}};
  const auto relative = [](double a, double b) {
    return std::abs(a - b) / std::max(std::abs(b), 1.0);
  };
  return nearest_model(share, 1.0, models, 0.02, relative,
                       fmt::format("contacts look incomplete: they carry {:.3g} of what the states "
                                   "show",
                                   share));
}

Symptoms told_symptoms(const Subject& subject) {
  Symptoms symptoms;
  World resting = floor_world({}, {}, at(0.2, 0.1, 0.05));
  if (!is_possible(subject, resting)) return symptoms;
  if (const auto told = told_of(subject, resting, 300)) {
    if (auto words = rest_symptom(*told); !words.empty()) return {words};
  }
  State moving = at(0, 0, 0.05);
  moving.velocity_mps.x() = 3.0;
  const World sliding = floor_world({0.5, 0.0}, {0.5, 0.0}, moving);
  if (!is_possible(subject, sliding)) return symptoms;
  const auto told = told_of(subject, sliding, 20);
  if (told && std::abs(told->momentum_ns.x()) > 0.1 * std::abs(told->momentum_ns.z()) &&
      std::abs(told->impulse_ns.x()) < 0.1 * std::abs(told->momentum_ns.x())) {
    symptoms.emplace_back("friction is missing from the impulses of contacts");
  }
  return symptoms;
}

}  // namespace

Symptoms contact_symptoms(const Subject& subject) {
  Symptoms symptoms;
  for (const auto& probe : {friction_symptom, restitution_symptom, size_symptom}) {
    if (auto words = probe(subject); !words.empty()) symptoms.push_back(words);
  }
  if (!symptoms.empty()) return symptoms;
  return told_symptoms(subject);
}

}  // namespace brickbench::conformance
