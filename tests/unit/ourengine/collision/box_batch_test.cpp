#include "tests/support/box_batch.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "tests/support/tolerance.hpp"

namespace ourengine {
namespace {

using brickbench::testing::Worst;

struct Scene {
  std::vector<PosedBox> boxes;
  std::vector<PackedBox> packed;
  std::vector<BodyPair> pairs;
};

// Pairs near contact: far ones are uninteresting. tilt_rad: how far attitudes are from the grid.
Scene scene_of(unsigned seed, double tilt_rad, int pairs) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> size(0.03, 0.15);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Scene scene;
  for (int i = 0; i < pairs; ++i) {
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector3d axis(any(random), any(random), any(random));
      const Eigen::Matrix3d axes =
          Eigen::AngleAxisd(tilt_rad * any(random), axis.normalized()).toRotationMatrix();
      const Eigen::Vector3d place(any(random), any(random), any(random));
      scene.boxes.push_back({{size(random), size(random), size(random)}, 0.15 * place, axes});
      scene.packed.push_back(pack(scene.boxes.back()));
    }
    scene.pairs.push_back({2 * i, 2 * i + 1});
  }
  return scene;
}

// Rounding of some 30 operations on lengths of 0.5 m, over sines down to 1e-3.
constexpr brickbench::testing::Tolerance k_gap = {"gap of the batch, m", 2e-15, 1.4e-16,
                                                  "rounding; last observed over both scenes"};

void compare(const Scene& scene, double margin_m) {
  std::vector<PairSeparation> batch(scene.pairs.size());
  separate_pairs(scene.packed, scene.pairs, margin_m, batch);
  Worst worst;
  int other_axis = 0;
  std::array<int, 15> seen{};
  for (std::size_t k = 0; k < scene.pairs.size(); ++k) {
    const auto first = static_cast<std::size_t>(scene.pairs[k].first);
    const BoxSeparation one = separate(scene.boxes[first], scene.boxes[first + 1], margin_m);
    ++seen[static_cast<std::size_t>(one.axis)];
    if (batch[k].axis != one.axis) {
      ++other_axis;
      continue;
    }
    worst.see(std::abs(batch[k].gap_m - one.gap_m), "pair " + std::to_string(k));
  }
  EXPECT_EQ(other_axis, 0);
  EXPECT_TRUE(worst.within(k_gap));
  if (margin_m > 1.0) {
    EXPECT_GT(*std::max_element(seen.begin() + 6, seen.end()), 0) << "edges";
  }
  for (std::size_t axis = 0; axis < 6; ++axis) EXPECT_GT(seen[axis], 0) << "axis " << axis;
}

TEST(BoxBatch, AgreesWithTheScalarTwinInAnyAttitude) {
  compare(scene_of(31, 3.0, 4001), 1e-3);  // not a multiple of any number of lanes
  compare(scene_of(32, 3.0, 4002), 1e9);   // no pair leaves early
}

TEST(BoxBatch, AgreesWithTheScalarTwinNearTheGrid) { compare(scene_of(33, 0.01, 4003), 1e-3); }

TEST(BoxBatch, ASinglePairAndNone) {
  const Scene scene = scene_of(34, 1.0, 1);
  std::vector<PairSeparation> batch(1);
  separate_pairs(scene.packed, scene.pairs, 1e9, batch);
  EXPECT_EQ(batch[0].axis, separate(scene.boxes[0], scene.boxes[1], 1e9).axis);
  separate_pairs(scene.packed, {}, 1e9, {});
}

}  // namespace
}  // namespace ourengine
