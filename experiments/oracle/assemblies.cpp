#include "experiments/oracle/assemblies.hpp"

#include <fmt/format.h>

#include <array>
#include <random>

namespace brickbench::gate {
namespace {

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

// One course of a wall: `columns` whole bricks, or where `lap` > 0 one part brick of that share of
// a brick at one end, whole bricks between, and the rest of a brick at the other end, so that both
// ends are flush with the course below. `keep` has an entry for each brick.
struct Course {
  double shift_m = 0.0;  // out of the wall's plane
  double lap = 0.0;      // share of a brick, 0 <= lap < 1
  std::size_t columns = 0;

  std::size_t bricks() const { return lap > 0.0 ? columns + 1 : columns; }
};

void lay(World& world, std::size_t level, const Course& course, const std::vector<bool>& keep) {
  const double height_m = k_brick_m.z() * (static_cast<double>(level) + 0.5);
  double from = 0.0;  // in bricks
  for (std::size_t i = 0; i < course.bricks(); ++i) {
    const bool last = i + 1 == course.bricks();
    const double length = course.lap == 0.0 ? 1.0
                          : i == 0          ? course.lap
                          : last            ? 1.0 - course.lap
                                            : 1.0;
    if (keep[i]) {
      add_brick(world, {length * k_brick_m.x(), k_brick_m.y(), k_brick_m.z()},
                {(from + 0.5 * length) * k_brick_m.x(), course.shift_m, height_m});
    }
    from += length;
  }
}

// A bonded wall whose courses step out of its plane.
World leaning_courses(Draw& draw) {
  World world = empty_world(draw.between(0.3, 0.8));
  const std::size_t courses = 4 + draw.below(4);
  const double step_m = draw.between(0.002, 0.03);
  const double lap = draw.between(0.3, 0.7);
  for (std::size_t i = 0; i < courses; ++i) {
    const Course course{step_m * static_cast<double>(i) * draw.between(0.8, 1.2),
                        i % 2 == 1 ? lap : 0.0, 3};
    lay(world, i, course, std::vector<bool>(course.bricks(), true));
  }
  return world;
}

// A bonded wall from whose lower courses bricks were taken.
World missing_bricks(Draw& draw) {
  World world = empty_world(draw.between(0.3, 0.8));
  const std::size_t columns = 4;
  const std::size_t courses = 3 + draw.below(3);
  const std::size_t holes = 1 + draw.below(3);
  const double lap = draw.between(0.3, 0.7);
  std::vector<Course> wall;
  std::vector<std::vector<bool>> keep;
  for (std::size_t i = 0; i < courses; ++i) {
    wall.push_back({0.0, i % 2 == 1 ? lap : 0.0, columns});
    keep.emplace_back(wall.back().bricks(), true);
  }
  for (std::size_t i = 0; i < holes; ++i) {
    std::vector<bool>& course = keep[draw.below(courses - 1)];
    course[draw.below(course.size())] = false;
  }
  for (std::size_t i = 0; i < courses; ++i) lay(world, i, wall[i], keep[i]);
  return world;
}

// Bricks that reach over an edge on one side, with a random counterweight on the other.
World overhang(Draw& draw) {
  World world = empty_world(draw.between(0.3, 0.8));
  add_brick(world, {0.2, 0.2, 0.1}, {0.0, 0.0, 0.05});
  const double beam_m = draw.between(0.3, 0.6);
  const double shift_m = draw.between(0.0, 0.25);
  add_brick(world, {beam_m, 0.1, 0.1}, {shift_m, 0.0, 0.15});
  const double low_m = shift_m - 0.5 * beam_m;
  const double size_m = draw.between(0.05, 0.15);
  const double height_m = draw.between(0.05, 0.3);
  add_brick(world, {size_m, 0.1, height_m},
            {low_m + 0.5 * size_m + draw.between(0.0, 0.1), 0.0, 0.2 + 0.5 * height_m});
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

std::vector<LabelledAssembly> labelled_assemblies(std::size_t count, std::uint64_t seed,
                                                  const Margins& margins) {
  constexpr std::uint64_t most_draws = 1000;  // in a row without a strict label
  std::vector<LabelledAssembly> list;
  std::uint64_t last = 0;
  for (std::uint64_t n = 1; list.size() < count && n - last <= most_draws; ++n) {
    const Family& family = k_families[list.size() % k_families.size()];
    const bool stands = list.size() / k_families.size() % 2 == 0;
    const StaticLabel wanted = stands ? StaticLabel::stands : StaticLabel::falls;
    Draw draw{std::mt19937_64(seed * 1000003 + n)};
    LabelledAssembly item{family.name, n, family.make(draw), {}};
    item.verdict = static_verdict(item.world);
    if (item.verdict.label != wanted || !robust(item.world, wanted, margins)) continue;
    list.push_back(std::move(item));
    last = n;
  }
  return list;
}

}  // namespace brickbench::gate
