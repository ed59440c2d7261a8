// The variants of ourengine, one builder per class of its library, and the knobs of each.
#pragma once

#include <array>
#include <memory>

#include "adapters/seam/knob_table.hpp"
#include "adapters/seam/scheme.hpp"
#include "ourengine/baraff/simulator.hpp"
#include "ourengine/contact/solvers.hpp"
#include "ourengine/exact/dynamics.hpp"
#include "ourengine/fast/fast_dynamics.hpp"

namespace brickbench {

using BaraffOptions = ourengine::baraff::Options;
using ExactOptions = ourengine::DynamicsOptions;
using FastOptions = ourengine::FastOptions;

// Held<member>::set and Held<member>::read in one, for a row of a table.
template <auto member, class Row>
constexpr Row held(Row row) {
  row.set = &Held<member>::set;
  row.read = &Held<member>::read;
  return row;
}

// Variants `baraff` and `paper`. `library` is the paper's plain choice, `tuned` that of `baraff`.
using BaraffRow = KnobRow<BaraffOptions>;
inline constexpr std::array k_baraff_knobs = {
    BaraffRow{
        "ignore_friction", "1", 0, 0, 0, 1, true,
        "1: pairs with friction run frictionless, and the audit says so; 0: they are refused"},
    held<&BaraffOptions::contact_tolerance_m>(BaraffRow{"contact_tolerance_m", "m", 1e-6, 1e-6,
                                                        1e-12, 1e-2, false,
                                                        "gap up to which bodies are in contact"}),
    held<&BaraffOptions::collision_velocity_mps>(
        BaraffRow{"collision_velocity_mps", "m/s", 1e-3, 1e-3, 0, 10, false,
                  "slower approach is resting contact and does not bounce"}),
    held<&BaraffOptions::max_collision_sweeps>(BaraffRow{"max_collision_sweeps", "1", 20000, 20000,
                                                         1, 1e6, true,
                                                         "sweeps of colliding contact per step"}),
    held<&BaraffOptions::hits_at_once>(
        BaraffRow{"hits_at_once", "1", 0, 1, 0, 1, true,
                  "1: all points of a pair, and all contacts without restitution, are hit at once; "
                  "0: one after the other"}),
    held<&BaraffOptions::depth_share>(BaraffRow{
        "depth_share", "1", 0, 0.25, 0, 1, false,
        "a step is cut where a pair could get deeper than this share of its thinner body; "
        "0: never"}),
    BaraffRow{"forward_euler", "1", 1, 0, 0, 1, true,
              "1: the paper's motion of bodies; 0: exact for a force that is held over the step",
              [](BaraffOptions& o, double value) {
                o.motion = value == 1.0 ? ourengine::baraff::Motion::forward_euler
                                        : ourengine::baraff::Motion::constant_force;
              },
              [](const BaraffOptions& o) -> LiveValues {
                return {o.motion == ourengine::baraff::Motion::forward_euler ? 1.0 : 0.0};
              }},
    held<&BaraffOptions::velocity_share>(
        BaraffRow{"velocity_share", "1", 0, 1, 0, 1, false,
                  "share of a resting contact's normal velocity that its force undoes per step"}),
    held<&BaraffOptions::overlap_share>(
        BaraffRow{"overlap_share", "1", 0, 1, 0, 1, false,
                  "share of an overlap that is undone per step by moving bodies apart"}),
    held<&BaraffOptions::overlap_slop_m>(
        BaraffRow{"overlap_slop_m", "m", 1e-7, 1e-7, 0, 1e-2, false, "overlap that is left alone"}),
    held<&BaraffOptions::max_bisections>(
        BaraffRow{"max_bisections", "1", 0, 0, 0, 1000, true,
                  "times per step that bisection looks for the time of contact"}),
};

// Variant `exact`, and `lcp`, which has all of them too.
using ExactRow = KnobRow<ExactOptions>;
inline constexpr std::array k_exact_knobs = {
    ExactRow{"tolerance", "1", 1e-10, 1e-10, 1e-14, 1e-2, false,
             "residual of the contact law that a solve must reach, relative",
             [](ExactOptions& o, double value) { o.solve.tolerance = value; },
             [](const ExactOptions& o) -> LiveValues { return {o.solve.tolerance}; }},
    ExactRow{"slip_tolerance", "1", 1e-6, 1e-6, 1e-14, 1e-2, false,
             "the same where contacts slip in an impact and each digit is dear",
             [](ExactOptions& o, double value) { o.solve.slip_tolerance = value; },
             [](const ExactOptions& o) -> LiveValues { return {o.solve.slip_tolerance}; }},
    held<&ExactOptions::rotation>(
        ExactRow{"integrator", "1", 1, 1, 0, 1, true,
                 "of the attitude: 0 semi-implicit, 1 discrete Moser-Veselov"}),
    held<&ExactOptions::margin_m>(
        ExactRow{"margin_m", "m", 1e-3, 1e-3, 1e-9, 1e-1, false,
                 "gap up to which contacts are stated, beyond what bodies approach in a step"}),
    held<&ExactOptions::overlap_recovery>(ExactRow{"overlap_recovery", "1", 0.2, 0.2, 0, 1, false,
                                                   "share of an overlap undone per step"}),
    held<&ExactOptions::recovery_limit_mps>(
        ExactRow{"recovery_limit_mps", "m/s", 1, 1, 0, 100, false,
                 "an overlap is never undone faster than this"}),
    held<&ExactOptions::resting_approach_steps>(
        ExactRow{"resting_approach_steps", "1", 2, 2, 0, 1000, false,
                 "an approach slower than this many steps of gravity does not bounce"}),
};

// Index: the value of the knob `solver` of `lcp`, the method that is tried first.
inline constexpr std::array<ourengine::Solver, 3> k_lcp_solvers = {
    &ourengine::solve_ipm_first, &ourengine::solve_dantzig_first, &ourengine::solve_nsgs_first};

template <std::size_t a, std::size_t b>
constexpr auto joined(const std::array<ExactRow, a>& first, const std::array<ExactRow, b>& second) {
  std::array<ExactRow, a + b> all{};
  std::ranges::copy(first, all.begin());
  std::ranges::copy(second, all.begin() + a);
  return all;
}

// Variant `lcp`.
inline constexpr auto k_lcp_knobs = joined(
    k_exact_knobs,
    std::array{
        ExactRow{
            "solver", "1", 0, 0, 0, 2, true,
            "of the frictionless problem: 0 interior point, 1 Dantzig, 2 projected Gauss-Seidel",
            [](ExactOptions& o, double value) {
              o.solver = k_lcp_solvers[static_cast<std::size_t>(value)];
            },
            [](const ExactOptions& o) -> LiveValues {
              return {double(std::ranges::find(k_lcp_solvers, o.solver) - k_lcp_solvers.begin())};
            }},
        ExactRow{"ignore_friction", "1", 0, 0, 0, 1, true,
                 "1: pairs with friction run frictionless, and the audit says so; 0: they are "
                 "refused"}});

// Variant `fast`.
using FastRow = KnobRow<FastOptions>;
inline constexpr std::array k_fast_knobs = {
    FastRow{"substep_s", "s", 1.0 / 4800, 1.0 / 4800, 1e-6, 1, false,
            "longest sub-step: a step is cut into equal parts no longer than this"},
    held<&FastOptions::contact_hz>(
        FastRow{"contact_frequency_hz", "1/s", 1e9, 1e9, 1, 1e12, false,
                "stiffness of contacts; at most one radian per sub-step is used"}),
    held<&FastOptions::damping_ratio>(
        FastRow{"damping_ratio", "1", 5, 5, 0, 1000, false, "of the contacts"}),
    held<&FastOptions::push_limit_mps>(FastRow{"push_limit_mps", "m/s", 3, 3, 0, 100, false,
                                               "an overlap is never pushed out faster than this"}),
    held<&FastOptions::margin_m>(
        FastRow{"margin_m", "m", 5e-4, 5e-4, 1e-9, 1e-1, false,
                "gap up to which contacts are stated, beyond what bodies approach in a step"}),
    held<&FastOptions::resting_approach_mps>(FastRow{"resting_approach_mps", "m/s", 0.1, 0.1, 0,
                                                     100, false,
                                                     "a slower approach does not bounce"}),
};

// The paper's system: variants `baraff` and `paper`.
Expected<std::unique_ptr<Simulation>> build_ourengine_baraff(const World& world,
                                                             const Settings& settings);
// Velocity-level contact with friction, the exact law.
Expected<std::unique_ptr<Simulation>> build_ourengine_exact(const World& world,
                                                            const Settings& settings);
// The paper's frictionless law at velocity level.
Expected<std::unique_ptr<Simulation>> build_ourengine_lcp(const World& world,
                                                          const Settings& settings);
// Soft contact in small steps.
Expected<std::unique_ptr<Simulation>> build_ourengine_fast(const World& world,
                                                           const Settings& settings);

// Equal parts into which `fast` cuts a step.
int fast_substeps(const Settings& settings);

// The contact of `fast` as its engine's own constants and the knobs state it.
SoftContact fast_contact(const Settings& settings);

// Fault::unsupported where bodies that may meet have friction and `ignore_friction` is not turned:
// for the laws that have none.
Expected<void> refuse_friction(const World& world, const Settings& settings);

}  // namespace brickbench
