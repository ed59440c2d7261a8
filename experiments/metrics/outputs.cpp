#include "experiments/metrics/outputs.hpp"

#include <fmt/core.h>

#include <cassert>
#include <cmath>
#include <limits>

namespace brickbench {
namespace {

constexpr double k_no_number = std::numeric_limits<double>::quiet_NaN();
// Engines in single precision hold a quaternion's length to 1e-6; 1 % is no rotation any more.
constexpr double k_quaternion_slack = 0.01;

bool is_state(const State& state) {
  return is_finite(state) && std::abs(state.orientation.norm() - 1.0) <= k_quaternion_slack;
}

// Squared lengths in here are within the slack, whatever the rounding.
constexpr double k_surely_long_enough = (1.0 - 0.9 * k_quaternion_slack);
constexpr double k_surely_short_enough = (1.0 + 0.9 * k_quaternion_slack);

// Whether is_state() is true for certain, in one pass without a branch per number: zero times a
// number that is not finite is NaN, and so is every sum with it.
bool is_surely_state(const State& state) {
  const auto zero = [](const Eigen::Vector3d& v) { return 0.0 * (v.x() + v.y() + v.z()); };
  const double length2 = state.orientation.squaredNorm();
  const double sum = zero(state.position_m) + zero(state.velocity_mps) +
                     zero(state.angular_velocity_radps) + length2;
  return sum > k_surely_long_enough && sum < k_surely_short_enough;
}

}  // namespace

void emit(std::vector<Measurement>& out, const std::vector<OutputInfo>& outputs,
          std::initializer_list<Value> values) {
  assert(outputs.size() == values.size());
  auto output = outputs.begin();
  for (const Value& value : values) {
    out.push_back({output->name, output->unit, value.value, value.note});
    ++output;
  }
}

void emit_none(std::vector<Measurement>& out, const std::vector<OutputInfo>& outputs,
               const std::string& note) {
  for (const OutputInfo& output : outputs) {
    out.push_back({output.name, output.unit, k_no_number, note});
  }
}

Value not_applicable(const std::string& reason) {
  return {k_no_number, std::string(k_not_applicable) + reason};
}

std::string at_time(double time_s) { return fmt::format("at {:.6g} s", time_s); }

StateGuard::StateGuard(const World& world) {
  for (const Body& body : world.bodies) names_.push_back(body.name);
}

bool StateGuard::admits(const Sample& sample) {
  if (!intact()) return false;
  for (std::size_t i = 0; i < sample.states.size(); ++i) {
    if (is_surely_state(sample.states[i]) || is_state(sample.states[i])) continue;
    note_ = fmt::format("{}body '{}' {}", k_not_finite, names_[i], at_time(sample.time_s));
    return false;
  }
  return true;
}

bool is_silent(const std::vector<std::size_t>& bricks, const StateGuard& guard,
               std::vector<Measurement>& out, const std::vector<OutputInfo>& outputs) {
  if (bricks.empty()) {
    emit_none(out, outputs, not_applicable("the scene has no bricks").note);
  } else if (!guard.intact()) {
    emit_none(out, outputs, guard.note());
  } else {
    return false;
  }
  return true;
}

}  // namespace brickbench
