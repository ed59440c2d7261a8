// How deep bodies sink into each other: docs/metrics.md, section penetration.
#include <fmt/core.h>

#include "experiments/metrics/compensated_sum.hpp"
#include "experiments/metrics/deepest_overlap.hpp"
#include "experiments/metrics/entries.hpp"
#include "experiments/metrics/log_histogram.hpp"
#include "experiments/metrics/outputs.hpp"

namespace brickbench {
namespace {

// Depths below a picometre are rounding and count as none in the 99th percentile.
constexpr double k_smallest_depth_m = 1e-12;
constexpr double k_largest_depth_m = 1e4;

const std::vector<OutputInfo>& outputs() {
  static const std::vector<OutputInfo> list = {
      {"penetration_max_m", "m", Better::lower, "deepest overlap of any two bodies at any step",
       "at most the approach speed times the step (an impact is seen one step late); 0 with "
       "continuous collision detection"},
      {"penetration_mean_m", "m", Better::lower, "mean over the steps of the deepest overlap",
       "below 1e-3 of a brick's smallest edge, or the engine's stated margin"},
      {"penetration_p99_m", "m", Better::lower,
       "99th percentile over the steps of the deepest overlap, within 0.5 %",
       "near the mean: a large gap between the two means rare deep impacts"},
      {"penetration_final_m", "m", Better::lower, "deepest overlap at the end",
       "at most the engine's margin: rubble at rest that keeps overlapping is a position error"},
  };
  return list;
}

const std::vector<OutputInfo>& curves() {
  static const std::vector<OutputInfo> list = {
      {"penetration_m", "m", Better::lower, "deepest overlap of any two bodies now",
       "peaks at impacts, then back to the engine's margin"}};
  return list;
}

class Penetration : public Metric {
 public:
  explicit Penetration(const World& world) : world_(world), search_(world), guard_(world) {}

  void observe(const Sample& sample) override {
    if (!guard_.admits(sample)) return;
    now_ = search_.find(sample.states);
    now_s_ = sample.time_s;
    if (sample.step == 0) return;
    if (now_.depth_m > worst_.depth_m) {
      worst_ = now_;
      worst_s_ = now_s_;
    }
    sum_m_ += now_.depth_m;
    depths_.add(now_.depth_m);
  }

  void report(std::vector<Measurement>& out) const override {
    if (!guard_.intact()) return emit_none(out, outputs(), guard_.note());
    if (depths_.count() == 0) {
      return emit_none(out, outputs(), not_applicable("no step was done").note);
    }
    const double p99_m = depths_.quantile(0.99);
    emit(out, outputs(),
         {{worst_.depth_m, where(worst_, worst_s_)},
          {sum_m_.value() / static_cast<double>(depths_.count())},
          {p99_m > worst_.depth_m ? worst_.depth_m : p99_m},
          {now_.depth_m, where(now_, now_s_)}});
  }

  void trace(std::vector<Measurement>& out) const override {
    if (!guard_.intact()) return emit_none(out, curves(), guard_.note());
    emit(out, curves(), {{now_.depth_m}});
  }

 private:
  std::string where(const Overlap& overlap, double time_s) const {
    if (overlap.depth_m <= 0.0) return "nothing overlaps";
    return fmt::format("bodies '{}' and '{}' {}", world_.bodies[overlap.body_a].name,
                       world_.bodies[overlap.body_b].name, at_time(time_s));
  }

  World world_;
  DeepestOverlap search_;
  StateGuard guard_;
  LogHistogram depths_{k_smallest_depth_m, k_largest_depth_m};
  CompensatedSum sum_m_;
  Overlap now_;
  Overlap worst_;
  double now_s_ = 0.0;
  double worst_s_ = 0.0;
};

}  // namespace

MetricInfo penetration_metric() {
  return {.name = "penetration",
          .meaning =
              "The deepest overlap of any two bodies, from their recorded poses alone. The initial "
              "state is the scene's and does not count.",
          .outputs = outputs(),
          .curves = curves(),
          .make = [](const Scene& scene, double) -> std::unique_ptr<Metric> {
            return std::make_unique<Penetration>(scene.world);
          }};
}

}  // namespace brickbench
