// What became of the structure as a whole: docs/metrics.md, section outcomes.
#include <algorithm>
#include <cmath>

#include "experiments/metrics/entries.hpp"
#include "experiments/metrics/moved.hpp"
#include "experiments/metrics/outputs.hpp"
#include "experiments/metrics/placed.hpp"

namespace brickbench {
namespace {

constexpr double k_still_share = 0.1;     // of sqrt(g x smallest edge): slower bricks are still
constexpr double k_collapse_share = 0.1;  // of the bricks, displaced: the structure has collapsed

const std::vector<OutputInfo>& outputs() {
  static const std::vector<OutputInfo> list = {
      {"rubble_height_m", "m", Better::neither, "highest point of any brick at the end",
       "the height of the structure while it stands; after a hit, what converged engines agree on"},
      {"bricks_run_out_m", "m", Better::neither,
       "largest horizontal distance of a brick from where any brick stood at the start, at the end",
       "0 for a structure that stands; after a hit, what converged engines agree on"},
      {"settling_time_s", "s", Better::neither,
       "last moment at which the bricks were not still; the end of the run if they never were",
       "0 for a structure that stands; the same in converged engines, and not the end of the run"},
      {"collapse_time_s", "s", Better::neither,
       "moment from which on a tenth of the bricks stayed displaced; the end of the run if never",
       "the end of the run for a structure that stands; else what converged engines agree on"},
  };
  return list;
}

const std::vector<OutputInfo>& curves() {
  static const std::vector<OutputInfo> list = {{"outcome_height_m", "m", Better::neither,
                                                "rubble_height_m now",
                                                "falls when the structure does, then constant"}};
  return list;
}

class Outcomes : public Metric {
 public:
  explicit Outcomes(const Scene& scene)
      : world_(scene.world),
        bricks_(scene.bricks),
        displaced_m_(0.5 * scene.length_scale_m),
        still_mps_(k_still_share *
                   std::sqrt(scene.world.gravity_mps2.norm() * scene.length_scale_m)),
        guard_(scene.world) {}

  void observe(const Sample& sample) override {
    if (bricks_.empty() || !guard_.admits(sample)) return;
    if (start_.empty()) begin(sample);
    now_s_ = sample.time_s;
    watch_bricks(sample);
  }

  void report(std::vector<Measurement>& out) const override {
    if (is_silent(bricks_, guard_, out, outputs())) return;
    const Value collapse = collapsed_ ? Value{collapse_s_} : Value{now_s_, "did not collapse"};
    const Value settling = moves_ ? Value{now_s_, "still moving at the end"} : Value{settling_s_};
    emit(out, outputs(), {{height_m_}, {run_out_m_}, settling, collapse});
  }

  void trace(std::vector<Measurement>& out) const override {
    if (is_silent(bricks_, guard_, out, curves())) return;
    emit(out, curves(), {{height_m_}});
  }

 private:
  void begin(const Sample& sample) {
    for (const std::size_t i : bricks_) start_.push_back(sample.states[i]);
    low_m_ = high_m_ = start_.front().position_m.head<2>();
    for (const State& start : start_) {
      low_m_ = low_m_.cwiseMin(start.position_m.head<2>());
      high_m_ = high_m_.cwiseMax(start.position_m.head<2>());
    }
  }

  void watch_bricks(const Sample& sample) {
    height_m_ = -HUGE_VAL;
    run_out_m_ = 0.0;
    double sum_m2ps2 = 0.0;
    std::size_t displaced = 0;
    for (std::size_t n = 0; n < bricks_.size(); ++n) {
      const State& state = sample.states[bricks_[n]];
      const Placed placed = place(world_.bodies[bricks_[n]].shape, state);
      height_m_ = std::max(height_m_, placed.center_m.z() + reach_m(placed).z());
      const Eigen::Vector2d at_m = state.position_m.head<2>();
      run_out_m_ = std::max(run_out_m_, (at_m - at_m.cwiseMax(low_m_).cwiseMin(high_m_)).norm());
      sum_m2ps2 += state.velocity_mps.squaredNorm();
      displaced += moved_m(world_.bodies[bricks_[n]].shape, start_[n], state) > displaced_m_;
    }
    const double bricks = static_cast<double>(bricks_.size());
    moves_ = std::sqrt(sum_m2ps2 / bricks) > still_mps_;
    if (moves_) settling_s_ = sample.time_s;
    const bool down = static_cast<double>(displaced) >= k_collapse_share * bricks;
    if (down && !collapsed_) collapse_s_ = sample.time_s;
    collapsed_ = down;
  }

  World world_;
  std::vector<std::size_t> bricks_;
  double displaced_m_;
  double still_mps_;
  StateGuard guard_;
  std::vector<State> start_;                         // (bricks)
  Eigen::Vector2d low_m_ = Eigen::Vector2d::Zero();  // of the centres at the start
  Eigen::Vector2d high_m_ = Eigen::Vector2d::Zero();
  double now_s_ = 0.0;
  double height_m_ = 0.0;
  double run_out_m_ = 0.0;
  double settling_s_ = 0.0;
  double collapse_s_ = 0.0;
  bool moves_ = false;
  bool collapsed_ = false;
};

}  // namespace

MetricInfo outcomes_metric() {
  return {.name = "outcomes",
          .meaning = "What became of the structure: rubble, run-out, settling, collapse.",
          .outputs = outputs(),
          .curves = curves(),
          .make = [](const Scene& scene, double) -> std::unique_ptr<Metric> {
            return std::make_unique<Outcomes>(scene);
          }};
}

}  // namespace brickbench
