// What only ODE needs: its messages are heard, not printed.
#include "tests/unit/adapters/cases.hpp"

namespace brickbench {
Adapter ode_adapter();

namespace testing {
namespace {

// dWorldStep says "LCP internal error" in the first step of this wall: redundant contacts.
TEST(Ode, CountsSolverMessagesAndPrintsNone) {
  World world;
  world.law = {0.5, 0.0};
  world.bodies = {floor_box()};
  for (int course = 0; course < 3; ++course) {
    for (int column = 0; column < 3; ++column) {
      world.bodies.push_back(brick(at(0.2 * column + 0.1 * (course % 2), 0, 0.05 + 0.1 * course)));
    }
  }
  Settings settings;
  settings.variant = "dantzig";
  settings.step_s = 1.0 / 240;
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const auto simulation = make(ode_adapter(), world, settings);
  run(*simulation, 1);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  const auto diagnostics = simulation->diagnostic_view()->diagnostics();
  ASSERT_EQ(diagnostics[0].name, "solver_messages");
  EXPECT_GE(diagnostics[0].value, 1.0);
  EXPECT_EQ(diagnostics[1].value, diagnostics[0].value);
}

}  // namespace
}  // namespace testing
}  // namespace brickbench
