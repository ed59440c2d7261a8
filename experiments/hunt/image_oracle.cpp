#include "experiments/hunt/image_oracle.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/exact/validation/metamorphic.hpp"
#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/dice.hpp"
#include "experiments/hunt/extent.hpp"

namespace brickbench::hunt {
namespace {

// Of the thinnest edge, of the speeds, and of a radian: far above rounding, far below anything that
// one could see. The second is for engines that count in single precision inside.
constexpr double k_nudge = 1e-7;
constexpr double k_single_nudge = 1e-4;
constexpr int k_nudges = 2;
constexpr double k_sensitivity = 10.0;
// Of the thinnest edge: what events inside a step may do beside that.
constexpr double k_image_share = 0.01;
constexpr std::size_t k_most_steps = 500;
// Up to this friction, that of a rod's end, a contact has one answer to Coulomb's law; beyond it
// may have several (P. Painleve, 1895), and an image may find another.
constexpr double k_one_answer_friction = 4.0 / 3.0;

Eigen::Vector3d some_vector(Dice& dice) {
  const double x = dice.uniform(-1.0, 1.0);
  const double y = dice.uniform(-1.0, 1.0);
  return {x, y, dice.uniform(-1.0, 1.0)};
}

Scene nudged(const Scene& scene, Dice& dice, double speed_mps, double share) {
  Scene other = scene;
  const double edge_m = thinnest_m(scene.world);
  for (Body& body : other.world.bodies) {
    if (body.fixed) continue;
    const Eigen::Vector3d angle_rad = share * some_vector(dice);
    body.initial.position_m += share * edge_m * some_vector(dice);
    body.initial.velocity_mps += share * speed_mps * some_vector(dice);
    body.initial.angular_velocity_radps += share * speed_mps / edge_m * some_vector(dice);
    body.initial.orientation =
        (Eigen::Quaterniond(1.0, 0.5 * angle_rad.x(), 0.5 * angle_rad.y(), 0.5 * angle_rad.z()) *
         body.initial.orientation)
            .normalized();
  }
  return other;
}

// (steps + 1) largest distances, m, of any moving body from its image taken back.
std::vector<double> distances_m(const Motion& scene, const Motion& other,
                                const exact::Symmetry& symmetry) {
  std::vector<double> all;
  const std::size_t common = std::min(scene.states.size(), other.states.size());
  for (std::size_t n = 0; n < common; ++n) {
    double most_m = 0.0;
    for (std::size_t i = 0; i < scene.states[n].size(); ++i) {
      if (scene.scene.world.bodies[i].fixed) continue;
      const State back = exact::taken_back(other.states[n][i], symmetry);
      most_m = std::max(most_m, (scene.states[n][i].position_m - back.position_m).norm());
    }
    all.push_back(most_m);
  }
  return all;
}

// Those that leave lengths, times and masses alone: engines have constants in metres and seconds.
// A pyramid of friction has axes of its own: turned, it is another one.
std::vector<exact::Symmetry> rigid_symmetries(const Motion& motion) {
  std::vector<exact::Symmetry> list;
  const bool round = motion.scheme && motion.scheme->friction == FrictionSet::circle;
  for (const exact::Symmetry& s : exact::symmetries()) {
    const bool rigid = s.length == 1.0 && s.time == 1.0 && s.mass == 1.0;
    const bool turns = !s.turn.isApprox(Eigen::Quaterniond::Identity());
    if (rigid && (round || !turns)) list.push_back(s);
  }
  return list;
}

bool is_fit(const Motion& motion) {
  const World& world = motion.scene.world;
  const std::size_t moving = moving_count(world);
  return motion.outcome == "ok" && motion.scene.blows.empty() && motion.scene.pushes.empty() &&
         greatest_law(world).friction <= k_one_answer_friction && moving >= 1 && moving <= 2 &&
         motion.steps() <= k_most_steps && world.bodies.size() <= 2;
}

}  // namespace

std::optional<Breach> image_breach(const Adapter& adapter, const Settings& settings,
                                   const Motion& motion) {
  if (!is_fit(motion)) return std::nullopt;
  const World& world = motion.scene.world;
  Fastest fastest(world);
  for (const auto& states : motion.states) fastest.see(states);
  double speed_mps = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    speed_mps = std::max(speed_mps, fastest.of(i));
  }
  std::vector<double> moved_m(motion.states.size(), 0.0);
  const bool single = motion.single;
  const double nudge_share = single ? k_single_nudge : k_nudge;
  Dice dice({0}, "nudge");
  for (int nudge = 0; nudge < k_nudges; ++nudge) {
    const Motion other = run_motion(
        adapter, settings, nudged(motion.scene, dice, speed_mps, nudge_share), motion.steps());
    if (other.outcome != "ok") return std::nullopt;
    const auto apart_m = distances_m(motion, other, {});
    for (std::size_t n = 0; n < apart_m.size(); ++n) moved_m[n] = std::max(moved_m[n], apart_m[n]);
  }
  // Rounding decides in which sub-step a tie falls.
  const int substeps = motion.scheme && motion.scheme->soft() ? motion.scheme->soft()->substeps : 0;
  const double tie_m = substeps > 0 ? speed_mps * motion.step_s / substeps : 0.0;
  Worst worst;
  for (const exact::Symmetry& symmetry : rigid_symmetries(motion)) {
    Scene image = motion.scene;
    image.world = exact::image(world, symmetry);
    const Motion other = run_motion(adapter, settings, image, motion.steps());
    const auto apart_m = distances_m(motion, other, symmetry);
    double sensitive_m = 0.0;
    for (std::size_t n = 0; n < apart_m.size(); ++n) {
      sensitive_m = std::max(sensitive_m, moved_m[n]);
      const double allowed_m =
          k_sensitivity * sensitive_m + k_image_share * thinnest_m(world) + tie_m;
      worst.see({"image", apart_m[n], allowed_m, "m", n, 0.0, symmetry.name});
    }
  }
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
