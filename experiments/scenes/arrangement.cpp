#include "experiments/scenes/arrangement.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <numbers>

namespace brickbench {
namespace {

const InputValue& part_of(const InputValue& table, const char* what, const char* key) {
  const InputValue* value = table.find(key);
  if (value == nullptr) reject(table.at, fmt::format("{} needs the key '{}'", what, key));
  return *value;
}

Eigen::Quaterniond turn_about(int axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::Unit(axis)));
}

int axis_of(const InputValue& table, int otherwise) {
  const InputValue* value = table.find("axis");
  if (value == nullptr) return otherwise;
  const std::string& word = filled_text(*value, "axis");
  if (word.size() == 1 && word >= "x" && word <= "z") return word.front() - 'x';
  reject(value->at, fmt::format("axis = \"{}\" must be \"x\", \"y\" or \"z\"", word));
}

}  // namespace

Arrangement::Arrangement(const InputValue& entry, Copies& copies, Scope& scope) {
  const InputValue* grid = entry.find("grid");
  const InputValue* stack = entry.find("stack");
  const InputValue* ring = entry.find("ring");
  const int given = (grid != nullptr) + (stack != nullptr) + (ring != nullptr);
  if (given > 1) reject(entry.at, "a body has one of grid, stack and ring, not several");
  first_ = scope.names.size();
  if (grid != nullptr) read_grid(*grid, copies, scope);
  if (stack != nullptr) read_stack(*stack, copies, scope);
  if (ring != nullptr) read_ring(*ring, copies, scope);
}

void Arrangement::read_grid(const InputValue& table, Copies& copies, Scope& scope) {
  kind_ = Kind::grid;
  expect(table, "grid", ValueKind::table);
  reject_unknown(table, "grid", {"count", "pitch_m", "centred"});
  const InputValue& count = part_of(table, "grid", "count");
  count_.emplace(count, "count", scope);
  pitch_.emplace(part_of(table, "grid", "pitch_m"), "pitch_m", scope);
  if (const InputValue* centred = table.find("centred")) {
    centred_ = expect(*centred, "centred", ValueKind::boolean).number != 0.0;
  }
  // x fastest, as a wall is laid.
  for (const int axis : {2, 1, 0}) {
    const InputValue& item = count.items[static_cast<std::size_t>(axis)];
    copies.add({std::string("i") + "xyz"[axis], Quantity(item, "count", scope), item.at}, scope);
  }
}

void Arrangement::read_stack(const InputValue& table, Copies& copies, Scope& scope) {
  kind_ = Kind::stack;
  at_ = table.at;
  expect(table, "stack", ValueKind::table);
  reject_unknown(table, "stack", {"count", "gap_m", "shift_m", "turn_rad"});
  const InputValue& count = part_of(table, "stack", "count");
  copies.add({"k", Quantity(count, "count", scope), count.at}, scope);
  gap_ = quantity_of(table, "gap_m", scope);
  pitch_ = vector_of(table, "shift_m", scope);
  turn_ = quantity_of(table, "turn_rad", scope);
}

void Arrangement::read_ring(const InputValue& table, Copies& copies, Scope& scope) {
  kind_ = Kind::ring;
  expect(table, "ring", ValueKind::table);
  reject_unknown(table, "ring", {"count", "radius_m", "axis", "start_rad", "turn_rad"});
  const InputValue& count = part_of(table, "ring", "count");
  ring_count_.emplace(count, "count", scope);
  copies.add({"k", Quantity(count, "count", scope), count.at}, scope);
  radius_.emplace(part_of(table, "ring", "radius_m"), "radius_m", scope);
  axis_ = axis_of(table, 2);
  start_ = quantity_of(table, "start_rad", scope);
  turn_ = quantity_of(table, "turn_rad", scope);
}

Eigen::Vector3d Arrangement::indices(const Scope& scope) const {
  return {scope.values[first_ + 2], scope.values[first_ + 1], scope.values[first_]};
}

void Arrangement::place(const Scope& scope, double reach_m, State& pose) {
  switch (kind_) {
    case Kind::none:
      return;
    case Kind::grid: {
      Eigen::Vector3d steps = indices(scope);
      if (centred_) steps -= 0.5 * (count_->in(scope)-Eigen::Vector3d::Ones());
      pose.position_m += pitch_->in(scope).cwiseProduct(steps);
      return;
    }
    case Kind::stack: {
      const double k = scope.values[first_];
      if (k > 0.0 && k != last_ + 1.0) reject(at_, "a stack leaves no copy out of its middle");
      last_ = k;
      if (k > 0.0) {
        const double gap_m = gap_ ? gap_->in(scope) : 0.0;
        pose.position_m.z() = top_m_ + gap_m + reach_m;
        if (pitch_) pose.position_m += k * pitch_->in(scope);
        if (turn_) pose.orientation = turn_about(2, k * turn_->in(scope)) * pose.orientation;
      }
      top_m_ = pose.position_m.z() + reach_m;
      return;
    }
    case Kind::ring: {
      const double step_rad =
          turn_ ? turn_->in(scope) : 2.0 * std::numbers::pi / ring_count_->in(scope);
      const double start_rad = start_ ? start_->in(scope) : 0.0;
      const Eigen::Quaterniond turn =
          turn_about(axis_, start_rad + scope.values[first_] * step_rad);
      const Eigen::Vector3d out = Eigen::Vector3d::Unit(axis_ == 0 ? 1 : 0);
      pose.position_m += turn * (radius_->in(scope)*out);
      pose.orientation = turn * pose.orientation;
      return;
    }
  }
}

}  // namespace brickbench
