// The variants of ourengine, one builder per class of its library.
#pragma once

#include <array>
#include <memory>

#include "adapters/seam/knob_table.hpp"
#include "adapters/seam/scheme.hpp"

namespace brickbench {

// Variants `baraff` and `paper`. `library` is the paper's plain choice, `tuned` that of `baraff`.
inline constexpr std::array k_baraff_knobs = {
    KnobRow{"ignore_friction", "1", 0, 0, 0, 1, true,
            "1: pairs with friction run frictionless, and the audit says so; 0: they are refused"},
    KnobRow{"contact_tolerance_m", "m", 1e-6, 1e-6, 1e-12, 1e-2, false,
            "gap up to which bodies are in contact"},
    KnobRow{"collision_velocity_mps", "m/s", 1e-3, 1e-3, 0, 10, false,
            "slower approach is resting contact and does not bounce"},
    KnobRow{"max_collision_sweeps", "1", 20000, 20000, 1, 1e6, true,
            "sweeps of colliding contact per step"},
    KnobRow{"hits_at_once", "1", 0, 1, 0, 1, true,
            "1: all points of a pair, and all contacts without restitution, are hit at once; 0: "
            "one after the other"},
    KnobRow{"depth_share", "1", 0, 0.25, 0, 1, false,
            "a step is cut where a pair could get deeper than this share of its thinner body; 0: "
            "never"},
    KnobRow{"forward_euler", "1", 1, 0, 0, 1, true,
            "1: the paper's motion of bodies; 0: exact for a force that is held over the step"},
    KnobRow{"velocity_share", "1", 0, 1, 0, 1, false,
            "share of a resting contact's normal velocity that its force undoes per step"},
    KnobRow{"overlap_share", "1", 0, 1, 0, 1, false,
            "share of an overlap that is undone per step by moving bodies apart"},
    KnobRow{"overlap_slop_m", "m", 1e-7, 1e-7, 0, 1e-2, false, "overlap that is left alone"},
    KnobRow{"max_bisections", "1", 0, 0, 0, 1000, true,
            "times per step that bisection looks for the time of contact"},
};

// Variant `exact`, and `lcp`, which has all of them too.
inline constexpr std::array k_exact_knobs = {
    KnobRow{"tolerance", "1", 1e-10, 1e-10, 1e-14, 1e-2, false,
            "residual of the contact law that a solve must reach, relative"},
    KnobRow{"slip_tolerance", "1", 1e-6, 1e-6, 1e-14, 1e-2, false,
            "the same where contacts slip in an impact and each digit is dear"},
    KnobRow{"integrator", "1", 2, 2, 0, 2, true,
            "of the attitude: 0 semi-implicit, 1 CF4, 2 discrete Moser-Veselov"},
    KnobRow{"margin_m", "m", 1e-3, 1e-3, 1e-9, 1e-1, false,
            "gap up to which contacts are stated, beyond what bodies approach in a step"},
    KnobRow{"overlap_recovery", "1", 0.2, 0.2, 0, 1, false, "share of an overlap undone per step"},
    KnobRow{"recovery_limit_mps", "m/s", 1, 1, 0, 100, false,
            "an overlap is never undone faster than this"},
    KnobRow{"resting_approach_steps", "1", 2, 2, 0, 1000, false,
            "an approach slower than this many steps of gravity does not bounce"},
};

// Variant `lcp`, beside k_exact_knobs.
inline constexpr std::array k_lcp_knobs = {
    KnobRow{"solver", "1", 0, 0, 0, 2, true,
            "of the frictionless problem: 0 interior point, 1 Dantzig, 2 projected Gauss-Seidel"},
    KnobRow{"ignore_friction", "1", 0, 0, 0, 1, true,
            "1: pairs with friction run frictionless, and the audit says so; 0: they are refused"},
};

// Variant `fast`.
inline constexpr std::array k_fast_knobs = {
    KnobRow{"substep_s", "s", 1.0 / 4800, 1.0 / 4800, 1e-6, 1, false,
            "longest sub-step: a step is cut into equal parts no longer than this"},
    KnobRow{"contact_frequency_hz", "1/s", 1e9, 1e9, 1, 1e12, false,
            "stiffness of contacts; at most one radian per sub-step is used"},
    KnobRow{"damping_ratio", "1", 5, 5, 0, 1000, false, "of the contacts"},
    KnobRow{"push_limit_mps", "m/s", 3, 3, 0, 100, false,
            "an overlap is never pushed out faster than this"},
    KnobRow{"margin_m", "m", 5e-4, 5e-4, 1e-9, 1e-1, false,
            "gap up to which contacts are stated, beyond what bodies approach in a step"},
    KnobRow{"resting_approach_mps", "m/s", 0.1, 0.1, 0, 100, false,
            "a slower approach does not bounce"},
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

// The contact of `fast` as its engine's own constants and the knobs state it.
SoftContact fast_contact(const Settings& settings);

// Fault::unsupported where bodies that may meet have friction and `ignore_friction` is not turned:
// for the laws that have none.
Expected<void> refuse_friction(const World& world, const Settings& settings);

}  // namespace brickbench
