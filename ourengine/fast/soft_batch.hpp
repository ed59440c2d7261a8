// Soft contact constraints, sixteen manifolds at a time, and the passes over them.
//
// A batch holds manifolds of one colour: no two of them share a moving body, so the lanes are
// independent and the order inside a colour does not matter. Velocities are of sub-steps, single
// precision; positions stay double and are touched once per step only.
//
// Two implementations of each pass: SIMD (Highway, chosen at run time for the processor) and a
// plain scalar twin that reads like the algorithm and is the oracle of tests. Both contract the
// same products and sums, and lanes never mix: both give the same bits. Where the processor cannot
// contract, the twin does the work, slowly: bits do not depend on the machine.
//
// Source: E. Catto, Solver2D, 2024 (soft step: one biased and one relaxing sweep per sub-step);
// M. Macklin et al., Small Steps in Physics Simulation, SCA 2019. Departures: friction is that of a
// manifold (two tangents and a twist at its centre), and the warm start of a sub-step costs no pass
// (see fast_dynamics.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace ourengine {

inline constexpr int k_lanes = 16;
inline constexpr int k_soft_points = 4;

using Lane = std::array<float, k_lanes>;
using Lane3 = std::array<Lane, 3>;

// One row of the Jacobian of a manifold: only the angular parts differ between its points.
struct alignas(64) SoftRow {
  Lane3 arm_a;   // r_a x direction; before soft_prepare(): the lever r_a itself
  Lane3 arm_b;   // r_b x direction
  Lane3 turn_a;  // I_a^-1 arm_a
  Lane3 turn_b;  // I_b^-1 arm_b
};

struct alignas(64) SoftPoint {
  SoftRow row;
  Lane mass;         // effective mass, kg; 0: no such point in this lane (1 before soft_prepare())
  Lane gap;          // m, at the start of the step
  Lane gap_now;      // m, where the bodies are in the current sub-step
  Lane impulse;      // N s per sub-step, accumulated
  Lane carried;      // N s: what it began the sub-step with
  Lane bounce;       // m/s: velocity to leave with if pushed; < 0: not struck
  Lane max_impulse;  // largest impulse of the step
  Lane total;        // N s: what all sub-steps applied
};

struct alignas(64) SoftBatch {
  std::array<std::int32_t, k_lanes> body_a;  // index into the velocities; the last body is at rest
  std::array<std::int32_t, k_lanes> body_b;
  Lane3 normal;  // from a to b
  std::array<Lane3, 2> tangent;
  Lane inverse_mass_a;
  Lane inverse_mass_b;
  std::array<SoftPoint, k_soft_points> point;
  int points = 0;       // largest number of points over the lanes
  int lanes = 0;        // in use, from the front; sweeps need not touch the rest
  bool struck = false;  // some lane comes fast enough to bounce
  std::array<SoftRow, 2> friction_row;
  Lane friction_mass_11, friction_mass_12, friction_mass_22;  // inverse of the 2x2 matrix
  std::array<Lane, 2> friction_impulse;
  std::array<Lane, 2> friction_total;  // N s, of the step
  Lane3 twist_a;                       // I_a^-1 normal
  Lane3 twist_b;
  Lane twist_mass;
  Lane twist_impulse;
  Lane twist_total;
  Lane twist_arm;  // m: mean distance of the points from their centre
  Lane friction;
  Lane weight;             // N s per sub-step: what weighs and pulls on both bodies gives
  Lane3 carried_friction;  // N s per sub-step on b, world axes: of the last step
};

// Per body: linear x y z, 0, angular x y z, 0. The last body stands for everything fixed.
using SoftVector = std::array<float, 8>;

// Per body: inverse inertia (world axes, symmetric) xx xy xz yy yz zz, inverse mass, 0.
using SoftInertia = std::array<float, 8>;

struct SoftStep {
  float step_s;          // of a sub-step
  float bias_rate_hz;    // share of an overlap that is pushed out per second
  float mass_scale;      // of the soft constraint, 1: rigid
  float impulse_scale;   // of the soft constraint, 0: rigid
  float push_limit_mps;  // an overlap is never pushed out faster
  float counted = 1.0F;  // 1 in the last relaxing sweep of a sub-step, whose impulses are summed up
};

// Everything that follows from what identifies a contact: from bodies, normal, levers, gaps, points
// present and impulses carried over to tangents, rows and effective masses. inertia: (bodies + 1),
// zeros for what is fixed.
void soft_prepare(std::span<SoftBatch> batches, std::span<const SoftInertia> inertia);
void soft_prepare_scalar(std::span<SoftBatch> batches, std::span<const SoftInertia> inertia);

// Adds to `change` the velocity that the impulses of one colour's batches give: (bodies + 1).
void soft_push(std::span<const SoftBatch> batches, std::span<SoftVector> change);
void soft_push_scalar(std::span<const SoftBatch> batches, std::span<SoftVector> change);

// One sweep over the batches of one colour. `biased` pushes overlaps apart; the relaxing sweep
// after the positions have moved takes that velocity out again and finds the gaps anew, which the
// next biased sweep uses too. velocity, moved: (bodies + 1); moved is displacement (m) and rotation
// (rad) since the step began.
void soft_sweep(std::span<SoftBatch> batches, const SoftStep& step, bool biased,
                std::span<SoftVector> velocity, std::span<const SoftVector> moved);
void soft_sweep_scalar(std::span<SoftBatch> batches, const SoftStep& step, bool biased,
                       std::span<SoftVector> velocity, std::span<const SoftVector> moved);

// Whether this processor multiplies and adds in one rounding, as the scalar twins always do.
bool soft_fuses();

}  // namespace ourengine
