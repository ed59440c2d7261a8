// The variants of ourengine, one builder per class of its library.
#pragma once

#include <array>
#include <memory>

#include "adapters/seam/knob_table.hpp"

namespace brickbench {

// `library` is the paper's plain choice (variant `paper`), `tuned` that of `baraff`.
inline constexpr std::array k_ourengine_knobs = {
    KnobRow{"ignore_friction", "1", 0, 0, 0, 1, true,
            "1: pairs with friction run frictionless, and the audit says so; 0: they are refused"},
    KnobRow{"contact_tolerance_m", "m", 1e-6, 1e-6, 1e-12, 1e-2, false,
            "gap up to which bodies are in contact"},
    KnobRow{"collision_velocity_mps", "m/s", 1e-3, 1e-3, 0, 10, false,
            "slower approach is resting contact and does not bounce"},
    KnobRow{"max_collision_sweeps", "1", 20000, 20000, 1, 1e6, true,
            "sweeps of colliding contact per step"},
    KnobRow{"velocity_share", "1", 0, 1, 0, 1, false,
            "share of a resting contact's normal velocity that its force undoes per step"},
    KnobRow{"overlap_share", "1", 0, 1, 0, 1, false,
            "share of an overlap that is undone per step by moving bodies apart"},
    KnobRow{"overlap_slop_m", "m", 1e-7, 1e-7, 0, 1e-2, false, "overlap that is left alone"},
    KnobRow{"max_bisections", "1", 0, 0, 0, 1000, true,
            "times per step that bisection looks for the time of contact"},
};

// The paper's system: variants `baraff` and `paper`.
Expected<std::unique_ptr<Simulation>> build_ourengine_baraff(const World& world,
                                                             const Settings& settings);

}  // namespace brickbench
