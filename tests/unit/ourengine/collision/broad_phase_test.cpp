#include "ourengine/collision/broad_phase.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

namespace ourengine {
namespace {

std::vector<Aabb> random_boxes(std::mt19937_64& random, int count, double room) {
  std::uniform_real_distribution<double> place(0.0, room);
  std::uniform_real_distribution<double> size(0.05, 0.2);
  std::vector<Aabb> boxes;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d centre(place(random), place(random), place(random));
    const Eigen::Vector3d half(size(random), size(random), size(random));
    boxes.push_back({centre - half, centre + half});
  }
  return boxes;
}

// Every overlapping pair must be there; the order must be sorted and without repeats.
void expect_complete(const BroadPhase& phase, const std::vector<Aabb>& boxes,
                     const std::vector<bool>& fixed) {
  const std::set<BodyPair> found(phase.pairs().begin(), phase.pairs().end());
  ASSERT_EQ(found.size(), phase.pairs().size());
  ASSERT_TRUE(std::is_sorted(phase.pairs().begin(), phase.pairs().end()));
  for (int i = 0; i < static_cast<int>(boxes.size()); ++i)
    for (int j = i + 1; j < static_cast<int>(boxes.size()); ++j) {
      const auto a = static_cast<std::size_t>(i);
      const auto b = static_cast<std::size_t>(j);
      if (fixed[a] && fixed[b]) {
        ASSERT_FALSE(found.contains({i, j}));
      } else if (boxes[a].overlaps(boxes[b])) {
        ASSERT_TRUE(found.contains({i, j})) << i << " " << j;
      }
    }
}

// Bodies that an engine threw away, or whose places are no numbers, must not stop the others from
// being found.
TEST(BroadPhase, SurvivesBodiesThatAreNowhere) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double far : {1e18, 1e25, 1e300, inf, -inf, nan}) {
    for (const int lost : {1, 90, 200}) {
      std::mt19937_64 random(12);
      std::vector<Aabb> boxes = random_boxes(random, 200, 2.0);
      BroadPhase phase(std::vector<bool>(boxes.size(), false), 0.01);
      phase.update(boxes);
      for (int i = 0; i < lost; ++i) {
        Aabb& box = boxes[static_cast<std::size_t>(i)];
        box.lower_m[i % 3] += far;
        box.upper_m[i % 3] += far;
      }
      phase.update(boxes);
      expect_complete(phase, boxes, std::vector<bool>(boxes.size(), false));
    }
  }
}

TEST(BroadPhase, NeverMissesAPairWhileBodiesWander) {
  std::mt19937_64 random(11);
  const int count = 200;
  std::vector<Aabb> boxes = random_boxes(random, count, 2.0);
  const double inf = std::numeric_limits<double>::infinity();
  boxes[0] = {Eigen::Vector3d::Constant(-inf), Eigen::Vector3d::Constant(inf)};  // a half space
  boxes[1] = {Eigen::Vector3d::Constant(-5.0), Eigen::Vector3d(5.0, 5.0, 0.1)};  // a large slab
  std::vector<bool> fixed(count, false);
  fixed[0] = fixed[1] = fixed[2] = true;
  BroadPhase phase(fixed, 0.01);
  std::normal_distribution<double> drift(0.0, 0.002);
  std::normal_distribution<double> leap(0.0, 0.5);
  for (int step = 0; step < 60; ++step) {
    phase.update(boxes);
    expect_complete(phase, boxes, fixed);
    for (std::size_t i = 3; i < boxes.size(); ++i) {
      const double d = step % 20 == 19 || i == 7 ? leap(random) : drift(random);
      const Eigen::Vector3d move(d, -d, 0.5 * d);
      boxes[i].lower_m += move;
      boxes[i].upper_m += move;
    }
  }
}

TEST(BroadPhase, ForgetsOnClear) {
  std::mt19937_64 random(12);
  const std::vector<Aabb> boxes = random_boxes(random, 50, 1.0);
  BroadPhase used(std::vector<bool>(50, false), 0.05);
  used.update(random_boxes(random, 50, 1.0));
  used.clear();
  used.update(boxes);
  BroadPhase fresh(std::vector<bool>(50, false), 0.05);
  fresh.update(boxes);
  EXPECT_TRUE(std::ranges::equal(used.pairs(), fresh.pairs()));
}

}  // namespace
}  // namespace ourengine
