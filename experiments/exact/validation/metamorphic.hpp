// Metamorphic checks: a scene and its image under a symmetry of mechanics must move alike. No truth
// is needed, so every scene qualifies, the wall included.
#pragma once

#include <string>
#include <vector>

#include "adapters/seam/adapter.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench::exact {

// An image of the world together with the way back. Lengths, times and masses of the image are
// those of the scene times length, time and mass; `turn` and `shift_m` move it, `mirror` reflects
// y.
struct Symmetry {
  std::string name;
  double length = 1.0;
  double time = 1.0;
  double mass = 1.0;
  bool mirror = false;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();  // after scaling and turning
};

// Mirrored at the plane y = 0; turned by 90 degrees and by 0.7 rad about z; shifted by (8, -4, 0)
// m, which doubles add without rounding for scenes on a coarse grid; lengths x 4 with times x 2,
// which leaves gravity as it is; masses x 1000; and times x 2 alone, which divides gravity by 4.
std::vector<Symmetry> symmetries();

// The image of the world, of the scene with its blows, and a state of the image taken back.
World image(const World& world, const Symmetry& symmetry);
Scene image(const Scene& scene, const Symmetry& symmetry);
State taken_back(const State& state, const Symmetry& symmetry);

struct GrowthSample {
  double time_s = 0.0;
  double difference_m = 0.0;  // largest distance of any body from its image taken back
};

struct MetamorphicResult {
  std::string symmetry;
  std::string outcome = "ok";
  std::string reason;
  std::vector<GrowthSample> growth;  // about 16 samples, evenly in time
  double rate_per_s = 0.0;           // d ln(difference)/dt over the samples above rounding; 0: none
};

// Runs the scene and its image side by side for `steps` steps.
MetamorphicResult compare_image(const Adapter& adapter, const Settings& settings,
                                const Scene& scene, const Symmetry& symmetry, std::size_t steps);

}  // namespace brickbench::exact
