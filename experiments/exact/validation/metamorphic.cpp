#include "experiments/exact/validation/metamorphic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adapters/seam/shape.hpp"
#include "experiments/step/stepper.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::size_t k_samples = 16;
// Differences below this share of a metre are rounding of coordinates of size one.
constexpr double k_rounding_m = 1e-14;

Vector3d reflected(const Vector3d& v) { return {v.x(), -v.y(), v.z()}; }

// Reflection of y: a rotation with axis (x, y, z) becomes one with axis (-x, y, -z).
Quaterniond reflected(const Quaterniond& q) { return {q.w(), -q.x(), q.y(), -q.z()}; }
Vector3d reflected_spin(const Vector3d& w) { return {-w.x(), w.y(), -w.z()}; }

State imaged(const State& state, const Symmetry& s) {
  State out = state;
  if (s.mirror) {
    out.position_m = reflected(state.position_m);
    out.velocity_mps = reflected(state.velocity_mps);
    out.orientation = reflected(state.orientation);
    out.angular_velocity_radps = reflected_spin(state.angular_velocity_radps);
  }
  out.position_m = s.turn * (s.length * out.position_m) + s.shift_m;
  out.velocity_mps = s.turn * (s.length / s.time * out.velocity_mps);
  out.orientation = s.turn * out.orientation;
  out.angular_velocity_radps = s.turn * (out.angular_velocity_radps / s.time);
  return out;
}

// Slope of ln(difference) over time, by least squares.
double growth_rate_per_s(const std::vector<GrowthSample>& growth) {
  double n = 0.0, st = 0.0, sy = 0.0, stt = 0.0, sty = 0.0;
  for (const GrowthSample& sample : growth) {
    if (!(sample.difference_m > k_rounding_m)) continue;
    const double y = std::log(sample.difference_m);
    n += 1.0;
    st += sample.time_s;
    sy += y;
    stt += sample.time_s * sample.time_s;
    sty += sample.time_s * y;
  }
  if (n < 3.0) return 0.0;
  return (n * sty - st * sy) / (n * stt - st * st);
}

}  // namespace

std::vector<Symmetry> symmetries() {
  const auto about_z = [](double angle) {
    return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ()));
  };
  return {{.name = "mirrored", .mirror = true},
          {.name = "turned_90_degrees", .turn = about_z(std::numbers::pi / 2.0)},
          {.name = "turned_0.7_rad", .turn = about_z(0.7)},
          {.name = "shifted", .shift_m = {8.0, -4.0, 0.0}},
          {.name = "lengths_x4_times_x2", .length = 4.0, .time = 2.0},
          {.name = "times_x2", .time = 2.0},
          {.name = "masses_x1000", .mass = 1000.0}};
}

World image(const World& world, const Symmetry& s) {
  World out = world;
  const Vector3d gravity = s.mirror ? reflected(world.gravity_mps2) : world.gravity_mps2;
  out.gravity_mps2 = s.turn * (s.length / (s.time * s.time) * gravity);
  for (Body& body : out.bodies) {
    // A level plane is its own image, wherever its origin is.
    const bool level_plane =
        is_half_space(body.shape) && body.initial.orientation.isApprox(Quaterniond::Identity());
    body.shape = scaled(body.shape, s.length);
    body.mass_kg *= s.mass;
    body.inertia_kgm2 *= s.mass * s.length * s.length;
    const double height = body.initial.position_m.z();
    body.initial = imaged(body.initial, s);
    if (level_plane) body.initial.position_m = {0.0, 0.0, s.length * height + s.shift_m.z()};
    body.initial.orientation.normalize();
  }
  return out;
}

State taken_back(const State& state, const Symmetry& s) {
  State out = state;
  const Quaterniond back = s.turn.conjugate();
  out.position_m = back * Vector3d(state.position_m - s.shift_m) / s.length;
  out.velocity_mps = back * state.velocity_mps * (s.time / s.length);
  out.orientation = back * state.orientation;
  out.angular_velocity_radps = back * state.angular_velocity_radps * s.time;
  if (s.mirror) {
    out.position_m = reflected(out.position_m);
    out.velocity_mps = reflected(out.velocity_mps);
    out.orientation = reflected(out.orientation);
    out.angular_velocity_radps = reflected_spin(out.angular_velocity_radps);
  }
  return out;
}

Scene image(const Scene& scene, const Symmetry& s) {
  Scene out = scene;
  out.world = image(scene.world, s);
  out.length_scale_m *= s.length;
  const double impulse = s.mass * s.length / s.time;
  for (Blow& blow : out.blows) {
    if (s.mirror) {
      blow.impulse_ns = reflected(blow.impulse_ns);
      blow.angular_impulse_nms = reflected_spin(blow.angular_impulse_nms);
    }
    blow.time_s *= s.time;
    blow.impulse_ns = s.turn * (impulse * blow.impulse_ns);
    blow.angular_impulse_nms = s.turn * (impulse * s.length * blow.angular_impulse_nms);
  }
  const double force = impulse / s.time;
  for (Push& push : out.pushes) {
    if (s.mirror) {
      push.force_n = reflected(push.force_n);
      push.torque_nm = reflected_spin(push.torque_nm);
      push.point_m = reflected(push.point_m);
    }
    for (double& time_s : push.times_s) time_s *= s.time;
    push.force_n = s.turn * (force * push.force_n);
    push.torque_nm = s.turn * (force * s.length * push.torque_nm);
    push.point_m *= s.length;
  }
  return out;
}

MetamorphicResult compare_image(const Adapter& adapter, const Settings& settings,
                                const Scene& scene, const Symmetry& symmetry, std::size_t steps) {
  MetamorphicResult result;
  result.symmetry = symmetry.name;
  const auto note = [&](const Failure& failure) {
    result.outcome = to_outcome(failure.fault);
    result.reason = failure.reason;
    return result;
  };
  Settings image_settings = settings;
  image_settings.step_s *= symmetry.time;
  const Scene other = image(scene, symmetry);
  auto here = Stepper::start(adapter, scene, settings);
  auto there = Stepper::start(adapter, other, image_settings);
  if (!here) return note(here.error());
  if (!there) return note(there.error());
  const std::size_t stride = std::max<std::size_t>(1, steps / k_samples);
  for (std::size_t step = 1; step <= steps; ++step) {
    if (auto ok = here->advance(); !ok) return note(ok.error());
    if (auto ok = there->advance(); !ok) return note(ok.error());
    if (step % stride != 0 && step != steps) continue;
    GrowthSample sample;
    sample.time_s = here->time_s();
    for (std::size_t i = 0; i < scene.world.bodies.size(); ++i) {
      if (scene.world.bodies[i].fixed) continue;
      const State back = taken_back(there->states()[i], symmetry);
      sample.difference_m =
          std::max(sample.difference_m, (here->states()[i].position_m - back.position_m).norm());
    }
    result.growth.push_back(sample);
  }
  result.rate_per_s = growth_rate_per_s(result.growth);
  return result;
}

}  // namespace brickbench::exact
