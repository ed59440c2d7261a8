#include "tests/faults/seeded_faults.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "adapters/seam/shape.hpp"

namespace brickbench::testing {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

template <typename Edit>
void each_moving(World& world, const Edit& edit) {
  for (Body& body : world.bodies) {
    if (!body.fixed) edit(body);
  }
}

void each_law(World& world, void (*edit)(ContactLaw&)) {
  edit(world.law);
  for (PairLaw& pair : world.exceptions) edit(pair.law);
}

std::vector<std::size_t> moving(const World& world) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (!world.bodies[i].fixed) indices.push_back(i);
  }
  return indices;
}

// The first knob that the correct engine shows and that can be doubled or halved.
void change_a_knob(Settings& settings) {
  const Adapter adapter = correct_adapter();
  const World world = demanding_world();
  for (const AuditFact& fact : asked_of(adapter, world, settings)) {
    if (std::ranges::find(adapter.knobs, fact.name, &Knob::name) == adapter.knobs.end()) continue;
    for (const double factor : {2.0, 0.5}) {
      Settings changed = settings;
      changed.knobs[fact.name] = factor * std::stod(fact.value);
      if (changed.knobs[fact.name] == std::stod(fact.value) ||
          !build(adapter, world, changed).has_value()) {
        continue;
      }
      settings = changed;
      return;
    }
  }
}

constexpr std::array k_faults = {
    SeededFault{.name = "none", .story = "the correct engine"},
    // Facts translated wrongly.
    SeededFault{.name = "gravity_1_percent",
                .story = "gravity times 1.01",
                .world = [](World& w) { w.gravity_mps2 *= 1.01; }},
    SeededFault{.name = "gravity_missing",
                .story = "gravity never passed on",
                .world = [](World& w) { w.gravity_mps2.setZero(); }},
    SeededFault{.name = "gravity_sideways",
                .story = "only the vertical part of gravity passed on",
                .world = [](World& w) { w.gravity_mps2.head<2>().setZero(); }},
    SeededFault{.name = "friction_ignored",
                .story = "friction 0",
                .world = [](World& w) { each_law(w, [](ContactLaw& l) { l.friction = 0.0; }); }},
    SeededFault{
        .name = "friction_squared",
        .story = "both surfaces carry mu and the engine multiplies them",
        .world = [](World& w) { each_law(w, [](ContactLaw& l) { l.friction *= l.friction; }); }},
    SeededFault{.name = "restitution_ignored",
                .story = "restitution 0",
                .world = [](World& w) { each_law(w, [](ContactLaw& l) { l.restitution = 0.0; }); }},
    SeededFault{
        .name = "restitution_squared",
        .story = "both surfaces carry e and the engine multiplies them",
        .world =
            [](World& w) { each_law(w, [](ContactLaw& l) { l.restitution *= l.restitution; }); }},
    SeededFault{.name = "laws_swapped",
                .story = "friction and restitution exchanged",
                .world =
                    [](World& w) {
                      each_law(w, [](ContactLaw& l) {
                        std::swap(l.friction, l.restitution);
                        l.restitution = std::min(l.restitution, 1.0);
                      });
                    }},
    SeededFault{.name = "exceptions_forgotten",
                .story = "laws of single pairs lost, the general law for all",
                .world = [](World& w) { w.exceptions.clear(); }},
    SeededFault{.name = "mass_1_percent",
                .story = "mass times 1.01",
                .world = [](World& w) { each_moving(w, [](Body& b) { b.mass_kg *= 1.01; }); }},
    SeededFault{.name = "inertia_of_a_sphere",
                .story = "the mean moment about all axes",
                .world =
                    [](World& w) {
                      each_moving(
                          w, [](Body& b) { b.inertia_kgm2.setConstant(b.inertia_kgm2.mean()); });
                    }},
    SeededFault{.name = "inertia_axes_rotated",
                .story = "moments in the order y, z, x",
                .world =
                    [](World& w) {
                      each_moving(w, [](Body& b) {
                        b.inertia_kgm2 =
                            Vector3d(b.inertia_kgm2[1], b.inertia_kgm2[2], b.inertia_kgm2[0]);
                      });
                    }},
    SeededFault{
        .name = "size_1_permille",
        .story = "half extents and radii times 1.001",
        .world =
            [](World& w) { each_moving(w, [](Body& b) { b.shape = scaled(b.shape, 1.001); }); }},
    SeededFault{
        .name = "velocity_lost",
        .story = "initial velocities not passed on",
        .world =
            [](World& w) { each_moving(w, [](Body& b) { b.initial.velocity_mps.setZero(); }); }},
    SeededFault{.name = "spin_turned",
                .story = "initial spin turned by 0.3 rad about x",
                .world =
                    [](World& w) {
                      each_moving(w, [](Body& b) {
                        b.initial.angular_velocity_radps =
                            Quaterniond(Eigen::AngleAxisd(0.3, Vector3d::UnitX())) *
                            b.initial.angular_velocity_radps;
                      });
                    }},
    SeededFault{.name = "attitude_inverted",
                .story = "initial orientation world to body",
                .world =
                    [](World& w) {
                      each_moving(w, [](Body& b) {
                        b.initial.orientation = b.initial.orientation.conjugate();
                      });
                    }},
    // Settings passed on wrongly.
    SeededFault{.name = "step_halved",
                .story = "the engine advances by half a step",
                .settings = [](Settings& s) { s.step_s *= 0.5; }},
    SeededFault{.name = "step_rounded",
                .story = "the step is 1e-6 too long",
                .settings = [](Settings& s) { s.step_s *= 1.0 + 1e-6; }},
    SeededFault{.name = "setting_swallowed",
                .story = "one setting of the solver has not the value asked for",
                .settings = change_a_knob},
    SeededFault{.name = "knob_swallowed",
                .story = "the knobs that were turned never arrive",
                .settings = [](Settings& s) { s.knobs.clear(); }},
    SeededFault{.name = "variant_swallowed",
                .story = "another variant of the engine runs than the one asked for",
                .settings = [](Settings& s) { s.variant = correct_adapter().variants[1].name; }},
    // Wrenches.
    SeededFault{.name = "wrench_ignored",
                .story = "applied forces never arrive",
                .load = [](std::span<Wrench> w, std::span<const State>,
                           int) { std::ranges::fill(w, Wrench{}); }},
    SeededFault{.name = "wrench_late",
                .story = "the first step's forces are lost",
                .load =
                    [](std::span<Wrench> w, std::span<const State>, int step) {
                      if (step == 0) std::ranges::fill(w, Wrench{});
                    }},
    SeededFault{.name = "torque_sign",
                .story = "torques with the wrong sign",
                .load =
                    [](std::span<Wrench> w, std::span<const State>, int) {
                      for (Wrench& one : w) one.torque_nm = -one.torque_nm;
                    }},
    // Read-out of states.
    SeededFault{.name = "momentum_leak",
                .story = "1e-6 of the velocities is lost in every step",
                .read =
                    [](Readout& r) {
                      for (State& s : r.states) s.velocity_mps *= std::pow(1.0 - 1e-6, r.step);
                    }},
    SeededFault{.name = "spin_read_in_body_frame",
                .story = "angular velocities reported in body axes",
                .read =
                    [](Readout& r) {
                      for (State& s : r.states) {
                        s.angular_velocity_radps =
                            s.orientation.conjugate() * s.angular_velocity_radps;
                      }
                    }},
    SeededFault{.name = "quaternion_order",
                .story = "x, y, z, w reported as w, x, y, z",
                .read =
                    [](Readout& r) {
                      for (State& s : r.states) {
                        const Quaterniond q = s.orientation;
                        s.orientation = Quaterniond(q.x(), q.y(), q.z(), q.w());
                      }
                    }},
    SeededFault{.name = "attitude_read_inverted",
                .story = "world to body reported",
                .read =
                    [](Readout& r) {
                      for (State& s : r.states) s.orientation = s.orientation.conjugate();
                    }},
    SeededFault{.name = "bodies_swapped",
                .story = "the first two moving bodies report each other's state",
                .read =
                    [](Readout& r) {
                      const auto indices = moving(r.world);
                      if (indices.size() > 1) std::swap(r.states[indices[0]], r.states[indices[1]]);
                    }},
    SeededFault{.name = "state_one_step_old",
                .story = "the state before the step is reported",
                .read = [](Readout& r) { std::ranges::copy(r.previous, r.states.begin()); }},
    SeededFault{.name = "velocity_from_positions",
                .story = "velocity reported as the last displacement over twice the step",
                .read =
                    [](Readout& r) {
                      for (std::size_t i = 0; i < r.states.size(); ++i) {
                        r.states[i].velocity_mps =
                            (r.states[i].position_m - r.previous[i].position_m) / (2.0 * r.step_s);
                      }
                    }},
    SeededFault{.name = "single_precision",
                .story = "positions rounded to single precision",
                .read =
                    [](Readout& r) {
                      for (State& s : r.states) {
                        s.position_m = s.position_m.cast<float>().cast<double>();
                      }
                    }},
    SeededFault{.name = "not_a_number",
                .story = "a position becomes NaN in step 7",
                .read =
                    [](Readout& r) {
                      if (r.step < 7) return;
                      r.states[moving(r.world).front()].position_m.x() =
                          std::numeric_limits<double>::quiet_NaN();
                    }},
    // Read-out of contacts.
    SeededFault{
        .name = "impulse_sign",
        .story = "impulses reported on the other body",
        .contacts =
            [](std::vector<Contact>& now, const std::vector<Contact>&, double) {
              for (Contact& c : now) c.impulse_ns = -c.impulse_ns;
            }},
    SeededFault{
        .name = "impulse_as_force",
        .story = "forces reported as impulses",
        .contacts =
            [](std::vector<Contact>& now, const std::vector<Contact>&, double step_s) {
              for (Contact& c : now) c.impulse_ns /= step_s;
            }},
    SeededFault{
        .name = "contact_dropped",
        .story = "the first contact of each step is missing",
        .contacts =
            [](std::vector<Contact>& now, const std::vector<Contact>&, double) {
              if (!now.empty()) now.erase(now.begin());
            }},
    SeededFault{
        .name = "friction_not_reported",
        .story = "only normal impulses reported",
        .contacts =
            [](std::vector<Contact>& now, const std::vector<Contact>&, double) {
              for (Contact& c : now) c.impulse_ns = c.normal * c.normal.dot(c.impulse_ns);
            }},
    SeededFault{
        .name = "contact_point_shifted",
        .story = "contact points 1 cm to the side",
        .contacts =
            [](std::vector<Contact>& now, const std::vector<Contact>&, double) {
              for (Contact& c : now) c.position_m.x() += 0.01;
            }},
    SeededFault{
        .name = "contacts_doubled",
        .story = "last step's contacts are reported again with this step's",
        .contacts = [](std::vector<Contact>& now, const std::vector<Contact>& previous,
                       double) { now.insert(now.end(), previous.begin(), previous.end()); }},
    // Steps that go wrong.
    SeededFault{.name = "plastic_is_elastic_once",
                .story = "the first plastic hit bounces",
                .step = plastic_is_elastic_once},
    SeededFault{.name = "restitution_adds_energy",
                .story = "a bounce comes back 1.3 times as fast",
                .step = restitution_adds_energy},
    SeededFault{.name = "bounce_gains_a_step",
                .story = "a bounce moves one step too far at the velocity u after it: m g h u more",
                .step = bounce_gains_a_step},
    SeededFault{.name = "contact_is_lost_when_moved_apart",
                .story = "overlaps are moved away before contacts are looked for: the place is "
                         "held, the fall goes on",
                .step = contact_is_lost_when_moved_apart},
    SeededFault{.name = "light_bricks_explode",
                .story = "bricks below 0.6 kg triple their speed at contacts",
                .step = light_bricks_explode},
    SeededFault{.name = "flies_to_1e33_m",
                .story = "a hit gives a velocity of 1e33 m per step",
                .step = flies_to_1e33_m},
    SeededFault{.name = "is_carried_to_1e33_m",
                .story = "a hit puts a body 1e33 m away, at a velocity like any other",
                .step = is_carried_to_1e33_m},
    SeededFault{.name = "sinks_after_a_blow",
                .story = "what a blow has moved falls into the ground",
                .step = sinks_after_a_blow,
                .hunted_in = "explosion"},
    SeededFault{.name = "passes_at_a_hit",
                .story = "a hit puts the bodies on the other side",
                .step = passes_at_a_hit,
                .hunted_in = "two_bricks brick_drop"},
    SeededFault{.name = "nan_is_hidden",
                .story = "the solver yields NaN, and from then on the old state is told",
                .step = nan_is_hidden},
    SeededFault{.name = "creeps",
                .story = "what rests on the ground moves at 2 cm/s",
                .step = creeps,
                .hunted_in = "brick_drop incline tower"},
    SeededFault{.name = "leaks_momentum",
                .story = "a millionth of all velocities is lost in every step",
                .step = leaks_momentum,
                .hunted_in = "two_bricks free_brick assembly"},
    SeededFault{.name = "pulls_to_the_left",
                .story = "every hit gives a velocity along -y",
                .step = pulls_to_the_left,
                .hunted_in = "two_bricks brick_drop"},
    SeededFault{.name = "differs_from_run_to_run",
                .story = "every run starts a little elsewhere",
                .step = differs_from_run_to_run},
};

}  // namespace

std::span<const SeededFault> seeded_faults() { return k_faults; }

KnobValues turned_knob() {
  Settings settings;
  settings.variant = correct_adapter().variants.front().name;
  change_a_knob(settings);
  return settings.knobs;
}

std::size_t fault_named(std::string_view name) {
  const auto found = std::ranges::find(k_faults, name, &SeededFault::name);
  return static_cast<std::size_t>(found - k_faults.begin());
}

}  // namespace brickbench::testing
