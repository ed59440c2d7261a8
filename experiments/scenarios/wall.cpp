#include "experiments/scenarios/wall.hpp"

#include <fmt/core.h>

#include <utility>

#include "experiments/scenarios/parts.hpp"

namespace brickbench {
namespace {

// Distance between the centres of neighbours in a course.
double module_m(const WallPlan& plan) { return plan.brick_m.x() + plan.head_joint_gap_m; }

struct Slot {
  double x_m;
  double length_m;
};

// `bricks` full bricks in a row, the row centred on x = 0.
std::vector<Slot> full_row(const WallPlan& plan, int bricks) {
  std::vector<Slot> slots;
  for (int i = 0; i < bricks; ++i) {
    slots.push_back({module_m(plan) * (i - 0.5 * (bricks - 1)), plan.brick_m.x()});
  }
  return slots;
}

// columns - 1 full bricks between two halves. The outer faces lie half a joint outside those of a
// full course, so every head joint is equally wide.
std::vector<Slot> closed_row(const WallPlan& plan) {
  const double half_length_m = 0.5 * plan.brick_m.x();
  const double end_x_m = 0.5 * (plan.columns * module_m(plan) - half_length_m);
  std::vector<Slot> slots = {{-end_x_m, half_length_m}};
  for (const Slot& slot : full_row(plan, plan.columns - 1)) slots.push_back(slot);
  slots.push_back({end_x_m, half_length_m});
  return slots;
}

std::vector<Slot> course_slots(const WallPlan& plan, int course) {
  if (plan.bond == Bond::stack) return full_row(plan, plan.columns);
  if (!plan.half_bricks) return full_row(plan, plan.columns - course);
  return course % 2 == 0 ? full_row(plan, plan.columns) : closed_row(plan);
}

Expected<void> check(const WallPlan& plan) {
  if (plan.bond != Bond::running) return {};
  if (!plan.half_bricks && plan.courses > plan.columns) {
    return fail(Fault::invalid,
                fmt::format("a racked-back wall of {} columns ends after {} courses; {} were asked",
                            plan.columns, plan.columns, plan.courses));
  }
  if (plan.courses > 1 && plan.head_joint_gap_m >= 0.5 * plan.brick_m.x()) {
    return fail(Fault::invalid,
                fmt::format("head_joint_gap_m = {} m must be below half a brick, {} m: bricks in "
                            "running bond would not bridge it",
                            plan.head_joint_gap_m, 0.5 * plan.brick_m.x()));
  }
  return {};
}

}  // namespace

std::vector<Parameter> wall_parameters(int courses, int columns) {
  return joined(
      {{count_parameter("courses", courses, 1, 200, "layers of bricks"),
        count_parameter("columns", columns, 1, 200, "full bricks in the lowest course")},
       size_parameters("brick", {0.2, 0.1, 0.1}),
       {density_parameter(),
        choice_parameter("bond", {"running", "stack"},
                         "running: odd courses shifted by half a brick; stack: none shifted"),
        flag_parameter("half_bricks", true,
                       "running bond: half bricks close odd courses; 0: ends racked back"),
        number_parameter("head_joint_gap_m", "m", 0.001, 0.0, 1.0,
                         "gap between neighbours of a course; bed joints are closed")}});
}

WallPlan wall_plan(const ParameterValues& values) {
  return {.courses = count(values, "courses"),
          .columns = count(values, "columns"),
          .brick_m = size_m(values, "brick"),
          .density_kgpm3 = number(values, "density_kgpm3"),
          .bond = word(values, "bond") == "stack" ? Bond::stack : Bond::running,
          .half_bricks = flag(values, "half_bricks"),
          .head_joint_gap_m = number(values, "head_joint_gap_m")};
}

Expected<std::vector<Body>> wall_bricks(const WallPlan& plan) {
  if (const auto possible = check(plan); !possible) return tl::unexpected(possible.error());
  std::vector<Body> bricks;
  for (int course = 0; course < plan.courses; ++course) {
    const double z_m = plan.brick_m.z() * (course + 0.5);
    int index = 0;
    for (const Slot& slot : course_slots(plan, course)) {
      bricks.push_back(brick(fmt::format("brick_c{}_n{}", course, index++),
                             {slot.length_m, plan.brick_m.y(), plan.brick_m.z()},
                             plan.density_kgpm3, at({slot.x_m, 0.0, z_m})));
    }
  }
  return bricks;
}

double wall_height_m(const WallPlan& plan) { return plan.courses * plan.brick_m.z(); }

double wall_half_length_m(const WallPlan& plan) { return 0.5 * plan.columns * module_m(plan); }

}  // namespace brickbench
