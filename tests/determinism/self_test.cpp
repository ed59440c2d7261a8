// The fingerprint notices what it must: a different run, and memory between runs.
#include <gtest/gtest.h>

#include "tests/determinism/fingerprint.hpp"
#include "tests/support/fake_engine.hpp"

namespace brickbench::testing {
namespace {

std::uint64_t flight_fingerprint(Defect defect) {
  World world;
  world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 2000.0));
  world.bodies[0].initial.angular_velocity_radps = {1, 2, 3};
  const Adapter adapter = fake_adapter(defect);
  std::string what;
  return fingerprint(adapter, adapter.variants.front().name, world, what);
}

TEST(DeterminismSelf, RepeatsARightEngine) {
  EXPECT_NE(flight_fingerprint(Defect::none), 0u);
  EXPECT_EQ(flight_fingerprint(Defect::none), flight_fingerprint(Defect::none));
}

TEST(DeterminismSelf, NoticesMemoryBetweenRuns) {
  EXPECT_NE(flight_fingerprint(Defect::forgets_order_of_runs),
            flight_fingerprint(Defect::forgets_order_of_runs));
}

TEST(DeterminismSelf, NoticesADifferentRun) {
  EXPECT_NE(flight_fingerprint(Defect::none), flight_fingerprint(Defect::leaks_momentum));
}

TEST(DeterminismSelf, TheWallIsAWorld) { EXPECT_TRUE(validate(hit_wall(0.5)).has_value()); }

}  // namespace
}  // namespace brickbench::testing
