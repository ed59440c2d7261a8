#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

// Each is defined in the file of its name.
Scenario brick_wall();
Scenario standing_wall();
Scenario tower();
Scenario kapla_tower();
Scenario free_brick();
Scenario brick_drop();
Scenario two_bricks();
Scenario incline();
Scenario assembly();
Scenario explosion();

std::vector<Scenario> scenarios() {
  return {brick_wall(), standing_wall(), tower(),   kapla_tower(), free_brick(),
          brick_drop(), two_bricks(),    incline(), assembly(),    explosion()};
}

}  // namespace brickbench
