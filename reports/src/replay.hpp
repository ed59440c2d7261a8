// Replay: the motion of one run as the 3D view shows it.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "adapters/seam/failure.hpp"

namespace brickbench {

enum class ReplayShape { box, sphere, plane };
enum class ReplayRole { brick, projectile, fixed };

struct ReplayBody {
  std::string name;
  ReplayShape shape = ReplayShape::box;
  ReplayRole role = ReplayRole::brick;
  std::array<double, 3> half_extents_m = {0.5, 0.5, 0.5};  // sphere: the radius three times

  bool operator==(const ReplayBody&) const = default;
};

struct Replay {
  std::string scene;   // label of the scene; replays of one scene are shown side by side
  std::string engine;  // label of the contender
  std::string cell;
  std::vector<ReplayBody> bodies;
  std::vector<double> times_s;         // (frames), ascending
  std::vector<double> positions_m;     // (frames, bodies, 3), world frame
  std::vector<double> orientations;    // (frames, bodies, 4), w x y z, body to world
  std::vector<double> penetrations_m;  // empty, or (frames, bodies): deepest overlap of each body
  std::vector<std::size_t> contact_offsets = {};  // empty, or (frames + 1): first point of a frame
  std::vector<double> contact_points_m = {};      // (points, 3), world frame
  std::string note = {};                          // how the run ended, unless well; or its flags
  std::optional<double> flagged_from_s = {};      // the first flagged step of a run with flags
  std::size_t recorded_frames = 0;                // in the trajectory, before any thinning
};

// What a page holds of all its replays together at most, so that it stays a few megabytes: each
// replay gets the same number of frames, and contact points stand with every n-th of them.
inline constexpr std::size_t k_page_body_frames = 1'500'000;
inline constexpr std::size_t k_page_contact_points = 600'000;
inline constexpr std::size_t k_fewest_frames = 30;

// Frames per replay that keep this many bodies (over all replays) within the page; `wanted` at
// most, k_fewest_frames at least.
std::size_t frames_within_page(std::size_t bodies, std::size_t wanted);

// Fault::invalid with the reason if the sizes do not fit each other, times do not ascend or a
// number is not finite.
Expected<void> check(const Replay& replay);

// At most `frames` frames (>= 2), evenly chosen, the first and the last among them.
Replay thinned(const Replay& replay, std::size_t frames);

// Steps of the lattices that positions and quaternion components are rounded to.
inline constexpr double k_position_lattice_m = 1e-4;
inline constexpr double k_quaternion_lattice = 1.0 / 8192;
inline constexpr double k_penetration_lattice_m = 1e-5;
inline constexpr double k_contact_lattice_m = 1e-3;

// For the page: {engine, cell, times, lattices, data}. `data` is base64 of raw deflate of byte
// planes: for each channel (x y z, w x y z, and the penetration where recorded), of each body, of
// each frame, the zigzag-coded difference from the frame before; all lowest bytes first, then the
// next, four of them. Quaternions keep the sign that is nearer to the frame before.
//
// `contacts`, where recorded, is coded likewise: the number of points of each frame, then x of all
// points, y, z; the points of a frame are sorted and of equal ones one is kept. Only every
// `contact_stride`-th frame has points.
nlohmann::ordered_json to_json(const Replay& replay, std::size_t contact_stride = 1);

// The bodies, for the page.
nlohmann::ordered_json bodies_json(const std::vector<ReplayBody>& bodies);

}  // namespace brickbench
