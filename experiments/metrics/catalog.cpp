#include "experiments/metrics/entries.hpp"

namespace brickbench {

std::vector<MetricInfo> metrics() {
  return {
      energy_metric(),       //
      momentum_metric(),     //
      penetration_metric(),  //
      displaced_metric(),    //
      outcomes_metric(),     //
      projectile_metric(),   //
      contacts_metric(),     //
      validity_metric(),     //
  };
}

}  // namespace brickbench
