#include "tests/faults/step_faults.hpp"

#include <algorithm>

#include "adapters/seam/shape.hpp"

namespace brickbench::testing {
namespace {

double reach_of(const Body& body) {
  return is_half_space(body.shape) ? 0.0 : bounding_radius_m(body.shape);
}

template <typename Edit>
void each_free(SpoiledStep& s, const Edit& edit) {
  for (std::size_t i = 0; i < s.world.bodies.size(); ++i) {
    if (!s.world.bodies[i].fixed) edit(i, s.after[i]);
  }
}

// What the contacts of a body do to it from the first hit of any body on.
template <typename Edit>
bool each_touched_since_a_hit(SpoiledStep& s, const Edit& edit) {
  constexpr double k_touched_mps = 1e-6;
  if (s.is_hit()) s.memory = 1;
  bool any = false;
  each_free(s, [&](std::size_t i, State& state) {
    if (s.memory == 0 || s.struck_mps(i) < k_touched_mps) return;
    edit(i, state);
    any = true;
  });
  return any;
}

}  // namespace

double SpoiledStep::struck_mps(std::size_t i) const {
  if (world.bodies[i].fixed) return 0.0;
  return (after[i].velocity_mps - free(i).velocity_mps).norm();
}

bool SpoiledStep::is_hit() const {
  constexpr double k_least_mps = 0.5;
  const double fall_mps = 3.0 * step_s * world.gravity_mps2.norm();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (struck_mps(i) > k_least_mps + fall_mps) return true;
  }
  return false;
}

State SpoiledStep::free(std::size_t i) const {
  State state = before[i];
  state.velocity_mps +=
      step_s * (world.gravity_mps2 + wrenches[i].force_n / world.bodies[i].mass_kg);
  state.position_m += step_s * state.velocity_mps;
  return state;
}

bool plastic_is_elastic_once(SpoiledStep& s) {
  if (s.world.law.restitution > 0.0 || s.memory > 0 || !s.is_hit()) return false;
  s.memory = 1;
  each_free(s, [&](std::size_t i, State& state) {
    state.velocity_mps += state.velocity_mps - s.before[i].velocity_mps;
  });
  return true;
}

bool restitution_adds_energy(SpoiledStep& s) {
  if (s.world.law.restitution == 0.0 || !s.is_hit()) return false;
  each_free(s, [](std::size_t, State& state) { state.velocity_mps *= 1.3; });
  return true;
}

// A bounce that is foreseen moves a whole step more at the velocity after it.
bool bounce_gains_a_step(SpoiledStep& s) {
  if (s.world.law.restitution == 0.0 || !s.is_hit()) return false;
  each_free(s, [&](std::size_t i, State& state) {
    if (s.struck_mps(i) > 0.0) state.position_m += s.step_s * state.velocity_mps;
  });
  return true;
}

// The overlap is moved away first, then no contact is found: the place is held, the fall goes on.
bool contact_is_lost_when_moved_apart(SpoiledStep& s) {
  return each_touched_since_a_hit(s, [&](std::size_t i, State& state) {
    state.position_m = s.before[i].position_m;
    state.velocity_mps = s.free(i).velocity_mps;
  });
}

bool light_bricks_explode(SpoiledStep& s) {
  bool any = false;
  each_free(s, [&](std::size_t i, State& state) {
    if (s.world.bodies[i].mass_kg > 0.6 || s.struck_mps(i) < 1e-6) return;
    state.velocity_mps *= 3.0;
    any = true;
  });
  return any;
}

bool flies_to_1e33_m(SpoiledStep& s) {
  if (s.memory > 0 || !s.is_hit()) return false;
  s.memory = 1;
  each_free(s, [&](std::size_t i, State& state) {
    if (s.struck_mps(i) > 0.0) state.velocity_mps.x() = 1e33 / s.step_s;
  });
  return true;
}

bool is_carried_to_1e33_m(SpoiledStep& s) {
  if (s.memory > 0 || !s.is_hit()) return false;
  s.memory = 1;
  each_free(s, [&](std::size_t i, State& state) {
    if (s.struck_mps(i) > 0.0) state.position_m.x() = 1e33;
  });
  return true;
}

// What a blow has moved finds the ground no more.
bool sinks_after_a_blow(SpoiledStep& s) {
  for (const Wrench& wrench : s.wrenches) {
    if (wrench.force_n.norm() > 0.0) s.memory = 1;
  }
  bool any = false;
  each_free(s, [&](std::size_t i, State& state) {
    const bool low = s.before[i].position_m.z() < reach_of(s.world.bodies[i]);
    if (s.memory == 0 || !s.world.bodies.front().fixed || !low) return;
    state = s.free(i);
    any = true;
  });
  return any;
}

bool passes_at_a_hit(SpoiledStep& s) {
  if (!s.is_hit() || s.world.bodies.size() != 2) return false;
  each_free(s, [&](std::size_t i, State& state) {
    const Eigen::Vector3d way = s.before[i].velocity_mps.normalized();
    state = s.before[i];
    state.position_m += 2.0 * (reach_of(s.world.bodies[0]) + reach_of(s.world.bodies[1])) * way;
  });
  return true;
}

bool nan_is_hidden(SpoiledStep& s) {
  if (s.is_hit()) s.memory = 1;
  if (s.memory == 0) return false;
  std::ranges::copy(s.before, s.after.begin());
  return true;
}

bool creeps(SpoiledStep& s) {
  bool any = false;
  each_free(s, [&](std::size_t i, State& state) {
    if (state.velocity_mps.norm() > 0.005 || s.struck_mps(i) == 0.0) return;
    state.velocity_mps.x() += 0.02;
    any = true;
  });
  return any;
}

bool leaks_momentum(SpoiledStep& s) {
  each_free(s, [](std::size_t, State& state) { state.velocity_mps *= 1.0 - 1e-6; });
  return true;
}

bool pulls_to_the_left(SpoiledStep& s) {
  if (!s.is_hit()) return false;
  each_free(s,
            [&](std::size_t i, State& state) { state.velocity_mps.y() -= 0.2 * s.struck_mps(i); });
  return true;
}

bool differs_from_run_to_run(SpoiledStep& s) {
  static int runs = 0;
  if (s.memory == 0) s.memory = ++runs;
  each_free(s, [&](std::size_t, State& state) { state.position_m.x() += 1e-13 * s.memory; });
  return true;
}

}  // namespace brickbench::testing
