#include "experiments/hunt/oracles.hpp"

namespace brickbench::hunt {

const std::vector<OracleInfo>& oracles() {
  static const std::vector<OracleInfo> list = {
      {"energy", "contacts create no energy", energy_breach},
      {"impact", "the impulses of a step give nothing at the velocity after them (Carnot)",
       impact_breach},
      {"momentum", "bodies among themselves keep their momentum", momentum_breach},
      {"spin", "bodies among themselves keep their angular momentum", spin_breach},
      {"overlap", "no body enters another deeper than the way of a step", overlap_breach},
      {"passage", "no body passes through another", passage_breach},
      {"friction", "what slides is held back by the whole friction: nothing creeps",
       friction_breach},
      {"cone", "friction never exceeds its coefficient times the pressure", cone_breach},
      {"push", "fixed bodies push only where they touch, inside the cone of friction", push_breach},
      {"kinematics", "bodies move as their velocities say", kinematics_breach},
      {"image", "a mirrored, turned or shifted scene moves alike", nullptr},
      {"scheme", "an exact case ends as the stated scheme must", nullptr},
      {"repetition", "the same run gives the same bits", nullptr},
      {"process", "the engine returns", nullptr}};
  return list;
}

}  // namespace brickbench::hunt
