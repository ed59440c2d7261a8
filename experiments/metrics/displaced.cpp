// How many bricks were moved, and how far: docs/metrics.md, section displaced.
#include <algorithm>
#include <cmath>

#include "experiments/metrics/entries.hpp"
#include "experiments/metrics/moved.hpp"
#include "experiments/metrics/outputs.hpp"

namespace brickbench {
namespace {

const std::vector<OutputInfo>& outputs() {
  static const std::vector<OutputInfo> list = {
      {"bricks_displaced", "1", Better::neither,
       "bricks with a point further from its start than half the smallest edge, at the end",
       "0 for a standing wall; after a hit, what converged engines agree on (within a few bricks)"},
      {"brick_displacement_max_m", "m", Better::neither,
       "largest distance of a brick's centre from its start",
       "below 1 mm for a standing wall: more is creep or collapse"},
      {"brick_displacement_mean_m", "m", Better::neither,
       "mean distance of the bricks' centres from their start",
       "below the largest; near it the whole wall drifts or sinks"},
      {"brick_speed_rms_mps", "m/s", Better::neither,
       "root mean square speed of the bricks at the end",
       "towards 0 once all lies still; a floor that does not fall is jitter"},
  };
  return list;
}

const std::vector<OutputInfo>& curves() {
  static const std::vector<OutputInfo> list = {
      {"displaced_count", "1", Better::neither, "bricks_displaced now", "rises and levels off"},
      {"displaced_max_m", "m", Better::neither, "brick_displacement_max_m now",
       "flat while nothing hits the wall"},
      {"displaced_speed_rms_mps", "m/s", Better::neither, "brick_speed_rms_mps now",
       "falls to 0 as the rubble comes to rest"}};
  return list;
}

class Displaced : public Metric {
 public:
  explicit Displaced(const Scene& scene)
      : bricks_(scene.bricks), threshold_m_(0.5 * scene.length_scale_m), guard_(scene.world) {
    for (const std::size_t i : bricks_) shapes_.push_back(scene.world.bodies[i].shape);
  }

  void observe(const Sample& sample) override {
    if (!guard_.admits(sample)) return;
    if (start_.empty()) {
      for (const std::size_t i : bricks_) start_.push_back(sample.states[i]);
    }
    now_ = {};
    double sum_m = 0.0;
    double sum_m2ps2 = 0.0;
    for (std::size_t n = 0; n < bricks_.size(); ++n) {
      const State& state = sample.states[bricks_[n]];
      const double center_m = (state.position_m - start_[n].position_m).norm();
      if (moved_m(shapes_[n], start_[n], state) > threshold_m_) now_.count += 1.0;
      now_.largest_m = std::max(now_.largest_m, center_m);
      sum_m += center_m;
      sum_m2ps2 += state.velocity_mps.squaredNorm();
    }
    const double bricks = static_cast<double>(bricks_.size());
    now_.mean_m = sum_m / bricks;
    now_.rms_speed_mps = std::sqrt(sum_m2ps2 / bricks);
  }

  void report(std::vector<Measurement>& out) const override {
    if (is_silent(bricks_, guard_, out, outputs())) return;
    emit(out, outputs(), {{now_.count}, {now_.largest_m}, {now_.mean_m}, {now_.rms_speed_mps}});
  }

  void trace(std::vector<Measurement>& out) const override {
    if (is_silent(bricks_, guard_, out, curves())) return;
    emit(out, curves(), {{now_.count}, {now_.largest_m}, {now_.rms_speed_mps}});
  }

 private:
  struct Now {
    double count = 0.0;
    double largest_m = 0.0;
    double mean_m = 0.0;
    double rms_speed_mps = 0.0;
  };

  std::vector<std::size_t> bricks_;
  double threshold_m_;
  StateGuard guard_;
  std::vector<Shape> shapes_;  // (bricks)
  std::vector<State> start_;   // (bricks)
  Now now_;
};

}  // namespace

MetricInfo displaced_metric() {
  return {.name = "displaced",
          .meaning = "Where the bricks are at the end, against where they stood.",
          .outputs = outputs(),
          .curves = curves(),
          .make = [](const Scene& scene, double) -> std::unique_ptr<Metric> {
            return std::make_unique<Displaced>(scene);
          }};
}

}  // namespace brickbench
