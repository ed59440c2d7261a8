// Symptoms in flight: what is read back before any step, after one, and after ten.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/conformance/diagnosis.hpp"

namespace brickbench::conformance {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int k_flight_steps = 10;
// Spin and attitude change by 1e-3 of themselves in a step; wrong models are off by 1e-1 and more.
constexpr double k_turning_tolerance = 0.02;
// Straight flight is exact but for the rounding of a few additions at 10 m, 1e-14 of a step's way.
constexpr double k_straight_tolerance = 1e-9;

// A fixed body first and last, three that fly apart in between.
World flight_world() {
  World world;
  world.gravity_mps2.setZero();
  world.bodies.push_back(fixed_body("fixed", BoxShape{{0.1, 0.2, 0.3}}, at(-20, 0, 0)));
  const Vector3d velocities[] = {{0.9, -1.7, 2.3}, {-2.1, 0.7, 1.1}, {1.3, 2.9, -0.6}};
  const Vector3d spins[] = {{0.3, -0.2, 0.8}, {-0.5, 0.7, 0.2}, {0.6, 0.1, -0.4}};
  for (int i = 0; i < 3; ++i) {
    Body body = turned_box({7.0 * i + 1.0 / 3.0, 5.0 / 3.0, -1.0 / 7.0});
    body.initial.orientation =
        Quaterniond(Eigen::AngleAxisd(0.4 * i, Vector3d::UnitY())) * body.initial.orientation;
    body.initial.velocity_mps = velocities[i];
    body.initial.angular_velocity_radps = spins[i];
    world.bodies.push_back(body);
  }
  world.bodies.push_back(fixed_body("fixed too", BoxShape{{0.3, 0.2, 0.1}}, at(40, 0, 0)));
  return world;
}

States initial_states(const World& world) {
  States states;
  for (const Body& body : world.bodies) states.push_back(body.initial);
  return states;
}

// Where the bodies are after so many steps; spins are taken as constant.
States flown(const World& world, int steps) {
  States states = initial_states(world);
  const double time_s = steps * k_step_s;
  for (State& state : states) {
    state.position_m += time_s * state.velocity_mps;
    const Vector3d turn = time_s * state.angular_velocity_radps;
    if (turn.norm() > 0.0) {
      state.orientation =
          Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * state.orientation;
    }
  }
  return states;
}

// One kind of number of all bodies, in a row.
using Numbers = Eigen::VectorXd;

Numbers row(const States& states, Eigen::Index size, const auto& part) {
  Numbers all(static_cast<Eigen::Index>(states.size()) * size);
  for (std::size_t i = 0; i < states.size(); ++i) {
    all.segment(static_cast<Eigen::Index>(i) * size, size) = part(states[i]);
  }
  return all;
}

Numbers positions(const States& states) {
  return row(states, 3, [](const State& s) -> Vector3d { return s.position_m; });
}
Numbers velocities(const States& states) {
  return row(states, 3, [](const State& s) -> Vector3d { return s.velocity_mps; });
}
Numbers spins(const States& states) {
  return row(states, 3, [](const State& s) -> Vector3d { return s.angular_velocity_radps; });
}
// As rotations, so that q and -q are one.
Numbers attitudes(const States& states) {
  return row(states, 9, [](const State& s) -> Eigen::Matrix<double, 9, 1> {
    const Eigen::Matrix3d turn = s.orientation.normalized().toRotationMatrix();
    return Eigen::Map<const Eigen::Matrix<double, 9, 1>>(turn.data());
  });
}

double apart(const Numbers& a, const Numbers& b) {
  return (a - b).norm() / std::max(b.norm(), 1e-300);
}

States changed(States states, const auto& change) {
  for (State& state : states) change(state);
  return states;
}

Vector3d in_body(const State& s, const Vector3d& v) { return s.orientation.conjugate() * v; }

struct Found {
  Symptoms symptoms;
  void add(const std::string& words) {
    if (!words.empty()) symptoms.push_back(words);
  }
};

std::string order_symptom(const States& seen, const States& right) {
  const double here = apart(positions(seen), positions(right));
  const auto fits = [&](const States& other) {
    return apart(positions(seen), positions(other)) <= k_straight_tolerance;
  };
  if (here <= 1e-3) return {};
  for (std::size_t a = 1; a < right.size() - 1; ++a) {
    for (std::size_t b = a + 1; b < right.size() - 1; ++b) {
      States swapped = right;
      std::swap(swapped[a], swapped[b]);
      if (fits(swapped)) return fmt::format("bodies {} and {} show each other's states", a, b);
    }
  }
  States reversed(right.rbegin(), right.rend());
  if (fits(reversed)) return "bodies come in reversed order";
  States moving_first = right;
  std::rotate(moving_first.begin(), moving_first.begin() + 1, moving_first.end());
  if (fits(moving_first)) return "bodies look sorted: fixed ones do not keep their place";
  const States turned = changed(right, [](State& s) {
    s.position_m = Vector3d(s.position_m.x(), s.position_m.z(), -s.position_m.y());
  });
  if (fits(turned)) return "y looks up; asked is z up";
  const States millimetres = changed(right, [](State& s) { s.position_m *= 1000.0; });
  if (fits(millimetres)) return "positions look like millimetres; asked are metres";
  return "positions come back other than they should be";
}

std::string attitude_symptom(const States& seen, const States& right) {
  const std::vector<Model<Numbers>> models = {
      {"orientations look inverted (world to body); asked is body to world",
       attitudes(changed(right, [](State& s) { s.orientation = s.orientation.conjugate(); }))},
      {"quaternion order looks x, y, z, w; asked is w, x, y, z",
       attitudes(changed(right,
                         [](State& s) {
                           const Quaterniond q = s.orientation;
                           s.orientation = Quaterniond(q.x(), q.y(), q.z(), q.w());
                         }))},
      {"orientations are lost: they come back as none",
       attitudes(changed(right, [](State& s) { s.orientation.setIdentity(); }))}};
  return nearest_model(attitudes(seen), attitudes(right), models, k_turning_tolerance, apart,
                       "orientations come back other than they should be");
}

// The rotation that carries the right vectors to those that are seen, as words.
std::string turn_words(const Numbers& seen, const Numbers& right, const char* what) {
  Eigen::Map<const Eigen::Matrix3Xd> to(seen.data(), 3, seen.size() / 3);
  Eigen::Map<const Eigen::Matrix3Xd> from(right.data(), 3, right.size() / 3);
  const Eigen::Matrix3d covariance = to * from.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  const Eigen::Matrix3d turn = svd.matrixU() * flip * svd.matrixV().transpose();
  if ((turn * from - to).norm() > k_turning_tolerance * to.norm()) {
    return fmt::format("{} come back other than they should be", what);
  }
  const Eigen::AngleAxisd angle(turn);
  return fmt::format("{} look turned by {:.3g} rad about ({:.2g}, {:.2g}, {:.2g})", what,
                     angle.angle(), angle.axis().x(), angle.axis().y(), angle.axis().z());
}

std::string spin_symptom(const States& seen, const States& right) {
  const auto with = [&](const auto& change) { return spins(changed(right, change)); };
  const double degrees = 180.0 / std::acos(-1.0);
  const std::vector<Model<Numbers>> models = {
      {"angular velocities look body-framed; asked is the world frame",
       with([](State& s) { s.angular_velocity_radps = in_body(s, s.angular_velocity_radps); })},
      {"angular velocities come with the wrong sign",
       with([](State& s) { s.angular_velocity_radps *= -1.0; })},
      {"angular velocities look like degrees per second; asked are radians",
       with([&](State& s) { s.angular_velocity_radps *= degrees; })},
      {"angular velocities are lost: they come back zero",
       with([](State& s) { s.angular_velocity_radps.setZero(); })}};
  return nearest_model(spins(seen), spins(right), models, k_turning_tolerance, apart,
                       turn_words(spins(seen), spins(right), "angular velocities"));
}

std::string velocity_symptom(const States& seen, const States& right) {
  const auto with = [&](const auto& change) { return velocities(changed(right, change)); };
  const std::vector<Model<Numbers>> models = {
      {"velocities look body-framed; asked is the world frame",
       with([](State& s) { s.velocity_mps = in_body(s, s.velocity_mps); })},
      {"velocities come with the wrong sign", with([](State& s) { s.velocity_mps *= -1.0; })},
      {"velocities are lost: they come back zero",
       with([](State& s) { s.velocity_mps.setZero(); })}};
  const double factor = velocities(seen).dot(velocities(right)) / velocities(right).squaredNorm();
  const std::string otherwise =
      apart(velocities(seen), factor * velocities(right)) < k_straight_tolerance
          ? fmt::format("velocities look {:.7g} times what they should be", factor)
          : "velocities come back other than they should be";
  return nearest_model(velocities(seen), velocities(right), models, k_straight_tolerance, apart,
                       otherwise);
}

bool is_single(const States& states) {
  return std::ranges::all_of(
      positions(states), [](double x) { return static_cast<double>(static_cast<float>(x)) == x; });
}

// How far bodies went in the first step, as a share of step_s times velocity.
double way_share(const States& before, const States& after, const States& right) {
  const Numbers way = positions(after) - positions(before);
  return way.dot(velocities(right)) / (k_step_s * velocities(right).squaredNorm());
}

struct Flight {
  States built, first, second, last;
};

Flight fly(const Subject& subject, const World& world) {
  Flight flight;
  const auto simulation = must_build(subject, world, k_step_s, false);
  flight.built = read(*simulation, world);
  for (int step = 1; step <= k_flight_steps; ++step) {
    flight.last = step_and_read(*simulation, world, false);
    if (step == 1) flight.first = flight.last;
    if (step == 2) flight.second = flight.last;
  }
  return flight;
}

// What one state says, whenever it was read; `right` is what it should be.
void see_state(const States& seen, const States& right, Found& found) {
  const std::string order = order_symptom(seen, right);
  if (!order.empty()) return found.add(order);
  found.add(attitude_symptom(seen, right));
  found.add(spin_symptom(seen, right));
}

void see_flight(const Subject& subject, const World& world, const Flight& flight, Found& found) {
  see_state(flight.built, initial_states(world), found);
  if (!found.symptoms.empty()) return;
  found.add(velocity_symptom(flight.built, initial_states(world)));
  if (!found.symptoms.empty()) return;
  see_state(flight.first, flown(world, 1), found);
  if (!found.symptoms.empty()) return;
  const States right = flown(world, 1);
  if (variant_of(subject.adapter, subject.variant).precision == "f64" && is_single(flight.first)) {
    return found.add("positions look rounded to single precision, and the variant says f64");
  }
  const double share = way_share(flight.built, flight.first, right);
  const double next = way_share(flight.first, flight.second, right);
  if (std::abs(share) < k_straight_tolerance && std::abs(next - 1.0) < k_straight_tolerance) {
    return found.add("states look one step old");
  }
  if (std::abs(share - 1.0) > k_straight_tolerance) {
    found.add(fmt::format("step is not exactly step_s: bodies go {:.9g} of the way of one", share));
  }
  const double kept_1 = velocities(flight.first).norm() / velocities(right).norm();
  const double kept_10 = velocities(flight.last).norm() / velocities(right).norm();
  if (std::abs(kept_1 - 1.0) > 1e-12 &&
      std::abs((kept_10 - 1.0) / (kept_1 - 1.0) - k_flight_steps) < 0.5) {
    return found.add(fmt::format("velocities change by {:.3g} of themselves in each step: damping?",
                                 kept_1 - 1.0));
  }
  found.add(velocity_symptom(flight.first, right));
}

// Free fall from rest: what acceleration there is.
void see_gravity(const Subject& subject, Found& found) {
  World world;
  world.gravity_mps2 = {0.3, -0.2, -9.81};
  world.bodies.push_back(turned_box({0, 0, 100}));
  const States states = run(subject, world, k_step_s, k_flight_steps, false);
  const Vector3d seen = states[0].velocity_mps / (k_flight_steps * k_step_s);
  const Vector3d& right = world.gravity_mps2;
  const double factor = seen.dot(right) / right.squaredNorm();
  const std::vector<Model<Vector3d>> models = {
      {"gravity does not act", Vector3d::Zero()},
      {"gravity acts with the wrong sign", -right},
      {"only the vertical part of gravity acts", Vector3d(0, 0, right.z())},
      {"gravity acts along -y; asked is the vector of the World", Vector3d(0, right.z(), 0)}};
  const auto distance = [&](const Vector3d& a, const Vector3d& b) {
    return (a - b).norm() / right.norm();
  };
  const std::string otherwise =
      (seen - factor * right).norm() < 1e-9 * right.norm()
          ? fmt::format("gravity looks {:.9g} times what it should be", factor)
          : fmt::format("gravity looks like ({:.4g}, {:.4g}, {:.4g}) m/s2", seen.x(), seen.y(),
                        seen.z());
  found.add(nearest_model(seen, right, models, k_straight_tolerance, distance, otherwise));
}

}  // namespace

Symptoms motion_symptoms(const Subject& subject) {
  Found found;
  const World world = flight_world();
  see_flight(subject, world, fly(subject, world), found);
  if (found.symptoms.empty()) see_gravity(subject, found);
  return found.symptoms;
}

}  // namespace brickbench::conformance
