#include "experiments/scenarios/parts.hpp"

#include <utility>

namespace brickbench {

Parameter number_parameter(std::string name, std::string unit, double default_value, double minimum,
                           double maximum, std::string meaning) {
  return {.name = std::move(name),
          .unit = std::move(unit),
          .kind = ParameterKind::number,
          .default_value = default_value,
          .minimum = minimum,
          .maximum = maximum,
          .choices = {},
          .meaning = std::move(meaning)};
}

Parameter count_parameter(std::string name, int default_value, int minimum, int maximum,
                          std::string meaning) {
  Parameter parameter =
      number_parameter(std::move(name), "1", default_value, minimum, maximum, std::move(meaning));
  parameter.kind = ParameterKind::integer;
  return parameter;
}

Parameter flag_parameter(std::string name, bool default_value, std::string meaning) {
  Parameter parameter = number_parameter(std::move(name), "1", default_value ? 1.0 : 0.0, 0.0, 1.0,
                                         std::move(meaning));
  parameter.kind = ParameterKind::boolean;
  return parameter;
}

Parameter choice_parameter(std::string name, std::vector<std::string> choices,
                           std::string meaning) {
  std::string first = choices.front();
  return {.name = std::move(name),
          .unit = "1",
          .kind = ParameterKind::choice,
          .default_value = std::move(first),
          .minimum = 0.0,
          .maximum = 0.0,
          .choices = std::move(choices),
          .meaning = std::move(meaning)};
}

std::vector<Parameter> size_parameters(const std::string& prefix, const Eigen::Vector3d& edges_m) {
  constexpr double k_smallest_m = 0.001;
  constexpr double k_largest_m = 10.0;
  return {number_parameter(prefix + "_length_m", "m", edges_m.x(), k_smallest_m, k_largest_m,
                           "full edge along the body's x axis"),
          number_parameter(prefix + "_thickness_m", "m", edges_m.y(), k_smallest_m, k_largest_m,
                           "full edge along the body's y axis"),
          number_parameter(prefix + "_height_m", "m", edges_m.z(), k_smallest_m, k_largest_m,
                           "full edge along the body's z axis")};
}

std::vector<Parameter> vector_parameters(const std::string& prefix, const std::string& suffix,
                                         const std::string& unit, const Eigen::Vector3d& value,
                                         double bound, const std::string& meaning) {
  std::vector<Parameter> parameters;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string letter(1, "xyz"[axis]);
    parameters.push_back(number_parameter(prefix + "_" + letter + "_" + suffix, unit, value[axis],
                                          -bound, bound, meaning + ", world " + letter + " axis"));
  }
  return parameters;
}

Parameter density_parameter() {
  return number_parameter("density_kgpm3", "kg/m3", 2000.0, 1.0, 30000.0, "density of the bricks");
}

std::vector<Parameter> contact_parameters(double friction, double restitution) {
  return {number_parameter("friction", "1", friction, 0.0, 10.0,
                           "Coulomb coefficient of every pair of bodies"),
          number_parameter("restitution", "1", restitution, 0.0, 1.0,
                           "Newton's coefficient of every pair of bodies")};
}

std::vector<Parameter> joined(std::initializer_list<std::vector<Parameter>> groups) {
  std::vector<Parameter> all;
  for (const auto& group : groups) all.insert(all.end(), group.begin(), group.end());
  return all;
}

Eigen::Vector3d size_m(const ParameterValues& values, const std::string& prefix) {
  return {number(values, prefix + "_length_m"), number(values, prefix + "_thickness_m"),
          number(values, prefix + "_height_m")};
}

Eigen::Vector3d vector(const ParameterValues& values, const std::string& prefix,
                       const std::string& suffix) {
  return {number(values, prefix + "_x_" + suffix), number(values, prefix + "_y_" + suffix),
          number(values, prefix + "_z_" + suffix)};
}

ContactLaw contact_law(const ParameterValues& values) {
  return {.friction = number(values, "friction"), .restitution = number(values, "restitution")};
}

int count(const ParameterValues& values, std::string_view name) {
  return static_cast<int>(number(values, name));
}

bool flag(const ParameterValues& values, std::string_view name) {
  return number(values, name) != 0.0;
}

Body brick(std::string name, const Eigen::Vector3d& edges_m, double density_kgpm3,
           const State& initial) {
  return solid_body(std::move(name), BoxShape{0.5 * edges_m}, density_kgpm3, initial);
}

State at(const Eigen::Vector3d& position_m) {
  State state;
  state.position_m = position_m;
  return state;
}

void add_brick(Scene& scene, Body body) {
  scene.bricks.push_back(scene.world.bodies.size());
  scene.world.bodies.push_back(std::move(body));
}

}  // namespace brickbench
