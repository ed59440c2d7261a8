// What the scenes have in common: parameters that many of them offer, and the bodies they put down.
//
// Order of the bodies in every scene: the ground first, if there is one, then the bricks, then the
// projectile, if there is one.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

constexpr double k_standard_gravity_mps2 = 9.81;

Parameter number_parameter(std::string name, std::string unit, double default_value, double minimum,
                           double maximum, std::string meaning);
Parameter count_parameter(std::string name, int default_value, int minimum, int maximum,
                          std::string meaning);
Parameter flag_parameter(std::string name, bool default_value, std::string meaning);
// The first choice is the default.
Parameter choice_parameter(std::string name, std::vector<std::string> choices, std::string meaning);

// PREFIX_length_m, PREFIX_thickness_m, PREFIX_height_m: full edges along the body's x, y and z.
std::vector<Parameter> size_parameters(const std::string& prefix, const Eigen::Vector3d& edges_m);
// PREFIX_x_UNIT, PREFIX_y_UNIT, PREFIX_z_UNIT, each in -bound .. bound, default `value`.
std::vector<Parameter> vector_parameters(const std::string& prefix, const std::string& suffix,
                                         const std::string& unit, const Eigen::Vector3d& value,
                                         double bound, const std::string& meaning);
Parameter density_parameter();
// friction and restitution of every pair of bodies.
std::vector<Parameter> contact_parameters(double friction, double restitution);

std::vector<Parameter> joined(std::initializer_list<std::vector<Parameter>> groups);

// Readers of the groups above.
Eigen::Vector3d size_m(const ParameterValues& values, const std::string& prefix);
Eigen::Vector3d vector(const ParameterValues& values, const std::string& prefix,
                       const std::string& suffix);
ContactLaw contact_law(const ParameterValues& values);
int count(const ParameterValues& values, std::string_view name);
bool flag(const ParameterValues& values, std::string_view name);

// A solid box with the given full edges (m).
Body brick(std::string name, const Eigen::Vector3d& edges_m, double density_kgpm3,
           const State& initial = {});
State at(const Eigen::Vector3d& position_m);

// Adds the body to the world and to Scene::bricks.
void add_brick(Scene& scene, Body body);

}  // namespace brickbench
