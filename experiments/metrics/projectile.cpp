// What became of the projectile: docs/metrics.md, section projectile.
#include <optional>

#include "experiments/metrics/entries.hpp"
#include "experiments/metrics/mechanics.hpp"
#include "experiments/metrics/outputs.hpp"

namespace brickbench {
namespace {

const std::vector<OutputInfo>& outputs() {
  static const std::vector<OutputInfo> list = {
      {"projectile_run_out_m", "m", Better::neither,
       "distance from the start along its first horizontal direction, at the end",
       "what converged engines agree on within 1 %; less means the wall took too much"},
      {"projectile_speed_mps", "m/s", Better::neither, "speed of its centre of mass at the end",
       "never above the start without outer work; 0 once it lies still"},
      {"projectile_kinetic_energy_j", "J", Better::neither, "kinetic energy left, spin included",
       "never above what it started with plus what it fell"}};
  return list;
}

const std::vector<OutputInfo>& curves() {
  static const std::vector<OutputInfo> list = {
      {"projectile_distance_m", "m", Better::neither, "projectile_run_out_m now",
       "a straight line until the hit"},
      {"projectile_height_m", "m", Better::neither, "z of its centre of mass",
       "a parabola until the hit"},
      {"projectile_velocity_mps", "m/s", Better::neither, "projectile_speed_mps now",
       "one drop per impact, then a slope of friction times gravity"}};
  return list;
}

class Projectile : public Metric {
 public:
  explicit Projectile(const Scene& scene) : guard_(scene.world) {
    if (scene.projectiles.empty()) return;
    index_ = scene.projectiles.front();
    body_ = scene.world.bodies[*index_];
    direction_ = body_.initial.velocity_mps;
    direction_.z() = 0.0;
    moving_ = direction_.norm() > 0.0;
    if (moving_) direction_.normalize();
  }

  void observe(const Sample& sample) override {
    if (!index_ || !guard_.admits(sample)) return;
    now_ = sample.states[*index_];
    if (!start_m_) start_m_ = now_.position_m;
  }

  void report(std::vector<Measurement>& out) const override {
    if (silent(out, outputs())) return;
    emit(out, outputs(),
         {run_out_m(), {now_.velocity_mps.norm()}, {kinetic_energy_j(body_, now_)}});
  }

  void trace(std::vector<Measurement>& out) const override {
    if (silent(out, curves())) return;
    emit(out, curves(), {run_out_m(), {now_.position_m.z()}, {now_.velocity_mps.norm()}});
  }

 private:
  Value run_out_m() const {
    if (!moving_) return not_applicable("the projectile starts without horizontal velocity");
    return {direction_.dot(now_.position_m - *start_m_)};
  }

  bool silent(std::vector<Measurement>& out, const std::vector<OutputInfo>& list) const {
    if (!index_) {
      emit_none(out, list, not_applicable("the scene has no projectile").note);
    } else if (!guard_.intact()) {
      emit_none(out, list, guard_.note());
    } else if (!start_m_) {
      emit_none(out, list, not_applicable("no state was seen").note);
    } else {
      return false;
    }
    return true;
  }

  std::optional<std::size_t> index_;
  Body body_;
  Eigen::Vector3d direction_ = Eigen::Vector3d::Zero();
  bool moving_ = false;
  StateGuard guard_;
  std::optional<Eigen::Vector3d> start_m_;
  State now_;
};

}  // namespace

MetricInfo projectile_metric() {
  return {.name = "projectile",
          .meaning = "The first projectile: how far, how fast, with what energy left.",
          .outputs = outputs(),
          .curves = curves(),
          .make = [](const Scene& scene, double) -> std::unique_ptr<Metric> {
            return std::make_unique<Projectile>(scene);
          }};
}

}  // namespace brickbench
