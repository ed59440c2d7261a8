// Scenario: a named family of scenes with named, ranged parameters in SI units.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "adapters/seam/world.hpp"

namespace brickbench {

// A number (integers and booleans too: 0 or 1) or one of the words that the parameter allows.
using ParameterValue = std::variant<double, std::string>;
using ParameterValues = std::map<std::string, ParameterValue, std::less<>>;

enum class ParameterKind { number, integer, boolean, choice };

struct Parameter {
  std::string name;  // snake_case with SI suffix
  std::string unit;  // "1" for pure numbers, counts and words
  ParameterKind kind = ParameterKind::number;
  ParameterValue default_value;
  double minimum = 0.0;  // inclusive; unused for choices
  double maximum = 0.0;
  std::vector<std::string> choices;
  std::string meaning;  // one line
};

// A blow at a given time: spread evenly over the one step that contains `time_s`, so that its
// impulse does not depend on the step.
struct Blow {
  std::size_t body = 0;
  double time_s = 0.0;
  Eigen::Vector3d impulse_ns = Eigen::Vector3d::Zero();           // at the centre of mass
  Eigen::Vector3d angular_impulse_nms = Eigen::Vector3d::Zero();  // about it, world frame
};

// A force and a torque, both in the world frame, that last. Each step gets their mean over it, so
// that their impulse does not depend on the step.
struct Push {
  std::size_t body = 0;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();    // at the point below
  Eigen::Vector3d torque_nm = Eigen::Vector3d::Zero();  // on top of that of the force
  // Of the body, in its frame, from the centre of mass. The lever arm during a step is that of its
  // start: first order in the step where the body turns, exact at the centre.
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  // The share of force and torque that acts, straight between these times (ascending; equal ones
  // make a jump), none before the first and after the last.
  std::vector<double> times_s;
  std::vector<double> shares;
};

// A scene ready to be run: the world, what acts on it from outside, and who is who.
struct Scene {
  World world;
  std::vector<Blow> blows;
  std::vector<Push> pushes;
  std::vector<std::size_t> bricks;       // whose displacement is counted
  std::vector<std::size_t> projectiles;  // none, one or more
  double length_scale_m = 0.1;           // the smallest edge of a brick: gaps and
                                         // displacements are judged against it
};

struct Scenario {
  std::string name;
  std::string meaning;      // one or two sentences: what is in it and why one looks at it
  double duration_s = 1.0;  // what a plan gets if it does not say
  std::vector<Parameter> parameters;
  // `values` holds a value in range for every parameter: build() below has checked. Refuses
  // combinations that make no scene (Fault::invalid).
  std::function<Expected<Scene>(const ParameterValues& values)> make;
  std::string file = {};  // that says the scene; empty: compiled
  std::string text = {};  // of the file
  std::string hash = {};  // XXH3-128 of the text, 32 hexadecimal digits
};

// Access for the make functions; the parameter exists and has that kind.
double number(const ParameterValues& values, std::string_view name);
const std::string& word(const ParameterValues& values, std::string_view name);

// Fault::invalid with the nearest known name for an unknown parameter, a wrong type, a value out of
// range; otherwise the values with every default filled in.
Expected<ParameterValues> complete(const Scenario& scenario, const ParameterValues& given);

// complete(), make, validate(World).
Expected<Scene> build(const Scenario& scenario, const ParameterValues& given);

// experiments/scenarios/catalog.cpp: one visible line per entry.
std::vector<Scenario> scenarios();

}  // namespace brickbench
