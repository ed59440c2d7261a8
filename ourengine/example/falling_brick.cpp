// A brick falls onto another that stands on the ground; prints where both are, ten times a second.
#include <cstdio>
#include <ourengine/engine.hpp>
#include <ourengine/model/mass_properties.hpp>
#include <ourengine/version.hpp>

namespace oe = ourengine;

int main() {
  const oe::BodyModel brick = oe::uniform_box({0.1, 0.05, 0.05}, 2000.0);  // half edges, density
  const std::vector<oe::BodyModel> bodies = {oe::fixed_plane(), brick, brick};
  std::vector<oe::Motion> motions(bodies.size());
  motions[1].position_m = {0.0, 0.0, 0.05};
  motions[2].position_m = {0.02, 0.0, 0.5};

  const oe::SurfaceLaw law = {.friction = 0.5, .restitution = 0.3};
  auto engine = oe::Engine::make(bodies, motions, oe::SurfaceLaws(1, law),
                                 {.method = oe::Method::exact, .step_s = 1.0 / 240.0});
  if (!engine) {
    std::fprintf(stderr, "no engine: %s\n", engine.error().c_str());
    return 2;
  }

  std::printf("ourengine %s\n  time_s   lower_z_m   upper_z_m  contacts\n", oe::k_version);
  for (int step = 1; step <= 240; ++step) {
    const oe::EngineReport report = engine->step();
    if (!report.solved) {
      std::fprintf(stderr, "step %d: the contact law was not met\n", step);
      return 1;
    }
    if (step % 24 != 0) continue;
    const auto now = engine->motions();
    std::printf("%8.2f  %10.6f  %10.6f  %8d\n", step * engine->options().step_s,
                now[1].position_m.z(), now[2].position_m.z(), report.contacts);
  }
  return 0;
}
