// The entries of the catalogue, one file each.
#pragma once

#include "experiments/metrics/metric.hpp"

namespace brickbench {

MetricInfo energy_metric();
MetricInfo momentum_metric();
MetricInfo penetration_metric();
MetricInfo displaced_metric();
MetricInfo outcomes_metric();
MetricInfo projectile_metric();
MetricInfo contacts_metric();
MetricInfo validity_metric();

}  // namespace brickbench
