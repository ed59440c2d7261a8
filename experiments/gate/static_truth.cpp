#include "experiments/gate/static_truth.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <random>

#include "experiments/gate/impulse_oracle.hpp"

namespace brickbench::gate {
namespace {

constexpr double k_balanced_share = 1e-6;  // of the weight: upper bound of "balanced"
constexpr double k_proven_share = 1e-5;    // lower bound of "cannot be balanced"
constexpr double k_density_kgpm3 = 1800.0;

const Eigen::Vector3d k_brick_m(0.2, 0.1, 0.1);

struct Draw {
  std::mt19937_64 random;
  // 0 <= u < 1, the same on every platform.
  double unit() { return static_cast<double>(random() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random() % n); }
};

void add_brick(World& world, const Eigen::Vector3d& size_m, const Eigen::Vector3d& centre_m) {
  State state;
  state.position_m = centre_m;
  world.bodies.push_back(solid_body(fmt::format("brick_{}", world.bodies.size()),
                                    BoxShape{0.5 * size_m}, k_density_kgpm3, state));
}

World empty_world(double friction) {
  World world;
  world.law = {.friction = friction, .restitution = 0.0};
  world.bodies.push_back(ground_plane());
  return world;
}

// A stack of single bricks, each shifted against the one below.
World tower(Draw& draw) {
  World world = empty_world(draw.between(0.3, 0.8));
  const std::size_t courses = 3 + draw.below(6);
  const double reach = draw.between(0.02, 0.09);
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < courses; ++i) {
    at.z() = k_brick_m.z() * (static_cast<double>(i) + 0.5);
    add_brick(world, k_brick_m, at);
    at.x() += draw.between(-0.4, 1.0) * reach;
    at.y() += draw.between(-0.5, 0.5) * reach;
  }
  return world;
}

// Bricks of a course without gaps between `from` and `to` half bricks, shifted by `shift_m`.
void lay(World& world, std::size_t course, double shift_m, std::size_t columns,
         const std::vector<bool>& keep) {
  const double height = k_brick_m.z() * (static_cast<double>(course) + 0.5);
  const double offset = course % 2 == 1 ? 0.5 * k_brick_m.x() : 0.0;
  for (std::size_t c = 0; c < columns; ++c) {
    if (!keep[c]) continue;
    const double x = offset + k_brick_m.x() * (static_cast<double>(c) + 0.5);
    add_brick(world, k_brick_m, {x, shift_m, height});
  }
}

// A running-bond wall whose courses step out of its plane.
World leaning_courses(Draw& draw) {
  World world = empty_world(draw.between(0.3, 0.8));
  const std::size_t courses = 4 + draw.below(4);
  const double step = draw.between(0.002, 0.03);
  for (std::size_t i = 0; i < courses; ++i) {
    lay(world, i, step * static_cast<double>(i) * draw.between(0.8, 1.2), 3, {true, true, true});
  }
  return world;
}

// A running-bond wall from whose lower courses bricks were taken.
World missing_bricks(Draw& draw) {
  World world = empty_world(draw.between(0.3, 0.8));
  const std::size_t columns = 4;
  const std::size_t courses = 3 + draw.below(3);
  const std::size_t holes = 1 + draw.below(3);
  std::vector<std::vector<bool>> keep(courses, std::vector<bool>(columns, true));
  for (std::size_t i = 0; i < holes; ++i)
    keep[draw.below(courses - 1)][draw.below(columns)] = false;
  for (std::size_t i = 0; i < courses; ++i) lay(world, i, 0.0, columns, keep[i]);
  return world;
}

// Bricks that reach over an edge on one side, with a random counterweight on the other.
World overhang(Draw& draw) {
  World world = empty_world(draw.between(0.3, 0.8));
  add_brick(world, {0.2, 0.2, 0.1}, {0.0, 0.0, 0.05});
  const double beam = draw.between(0.3, 0.6);
  const double shift = draw.between(0.0, 0.25);
  add_brick(world, {beam, 0.1, 0.1}, {shift, 0.0, 0.15});
  const double low = shift - 0.5 * beam;
  const double size = draw.between(0.05, 0.15);
  add_brick(world, {size, 0.1, draw.between(0.05, 0.3)}, {0.0, 0.0, 0.0});
  Body& weight = world.bodies.back();
  weight.initial.position_m = {low + 0.5 * size + draw.between(0.0, 0.1), 0.0,
                               0.2 + std::get<BoxShape>(weight.shape).half_extents_m.z()};
  return world;
}

struct Family {
  const char* name;
  World (*make)(Draw&);
};
constexpr std::array<Family, 4> k_families = {{{"tower", tower},
                                               {"leaning_courses", leaning_courses},
                                               {"missing_bricks", missing_bricks},
                                               {"overhang", overhang}}};

}  // namespace

StaticVerdict static_verdict(const World& world) {
  constexpr double unit_time_s = 1.0;  // forces times one second, as impulses
  std::vector<State> states;
  double weight_n = 0.0;
  for (const Body& body : world.bodies) {
    states.push_back(body.initial);
    if (!body.fixed) weight_n += body.mass_kg * world.gravity_mps2.norm();
  }
  const std::vector<Wrench> none(world.bodies.size());
  const ConeProblem problem = cone_problem(world, {states, states, none, unit_time_s},
                                           {.gap_share = 1e-5, .border_share = -1e-5});
  const ConeSolution solution = solve(problem, 0.1 * k_balanced_share * weight_n * unit_time_s);
  const ConeBounds bounds = certify(problem, solution);
  StaticVerdict verdict;
  verdict.upper_share = bounds.upper_ns / (weight_n * unit_time_s);
  verdict.lower_share = bounds.lower_ns / (weight_n * unit_time_s);
  if (verdict.lower_share > k_proven_share) verdict.label = StaticLabel::falls;
  if (verdict.upper_share < k_balanced_share) verdict.label = StaticLabel::stands;
  return verdict;
}

bool robust(const World& world, StaticLabel label, double tilt_rad) {
  for (int side = 0; side < 4; ++side) {
    World tilted = world;
    const double angle = side * M_PI_2;
    const double g = world.gravity_mps2.norm();
    tilted.gravity_mps2 =
        g * Eigen::Vector3d(std::sin(tilt_rad) * std::cos(angle),
                            std::sin(tilt_rad) * std::sin(angle), -std::cos(tilt_rad));
    if (static_verdict(tilted).label != label) return false;
  }
  return true;
}

std::vector<LabelledAssembly> labelled_assemblies(std::size_t count, std::uint64_t seed,
                                                  double tilt_rad) {
  std::vector<LabelledAssembly> list;
  for (std::uint64_t n = 1; list.size() < count; ++n) {
    const Family& family = k_families[list.size() % k_families.size()];
    Draw draw{std::mt19937_64(seed * 1000003 + n)};
    LabelledAssembly item{family.name, n, family.make(draw), {}};
    item.verdict = static_verdict(item.world);
    if (item.verdict.label == StaticLabel::undecided) continue;
    if (!robust(item.world, item.verdict.label, tilt_rad)) continue;
    list.push_back(std::move(item));
  }
  return list;
}

}  // namespace brickbench::gate
