// ExactCase: a scene whose truth can be derived. The case owns its parameters; world, loads,
// measurement and truths are all built from them, so none can disagree with another.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "adapters/seam/world.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/scenarios/scenario.hpp"
#include "experiments/step/stepper.hpp"

namespace brickbench::exact {

// What touches what decides how closely a discrete truth must be met.
enum class Contacts { none, one, several };

// Features that an engine needs for the case beyond boxes and gravity.
struct Needs {
  Contacts contacts = Contacts::none;
  bool spheres = false;
  bool friction = false;
  bool restitution = false;
  bool contact_forces = false;  // an observable reads Simulation::contact_view()
  bool applied_forces = false;
};

// One number that the case measures.
struct Observable {
  std::string name;  // snake_case with SI suffix
  std::string unit;
  std::string meaning;  // one line
};

// What is known of one observable: its value for the continuous problem, and the size that errors
// are divided by (a natural scale of the quantity, never zero).
struct Truth {
  double value = 0.0;
  double scale = 1.0;
};

// Called for step 0 (initial state) and after each step with the running values (observables), at
// first NaN. Keeps what it needs in its own captured state: every run works on a copy.
using Measure = std::function<void(const Sample& sample, std::span<double> values)>;
// The exact states (bodies) at a time, where the motion has a closed form.
using Trajectory = std::function<void(double time_s, std::span<State> states)>;

// Where two bodies touch, seen by the discrete map of a scheme. A group of points that share the
// load evenly by symmetry (the corners of a flat face) is one such contact with several points.
struct PointContact {
  std::size_t body_a = 0;
  std::size_t body_b = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from a towards b
  double gap_m = 0.0;
  int points = 1;
  bool boxes = false;    // both bodies are boxes
  bool central = false;  // the group exerts no torque: position_m has no lever
};
// The contacts near closing for given states (bodies).
using ContactGeometry =
    std::function<void(std::span<const State> states, std::vector<PointContact>& contacts)>;

struct ExactRun {
  World world;
  double step_s = 0.001;
  std::size_t steps = 0;
  Load load;  // may be empty
  Measure measure;
  std::vector<Truth> truths;  // one per observable
  Trajectory trajectory;      // may be empty
  // Empty: contact-free, or no discrete truth is claimed (see discrete_truth).
  ContactGeometry geometry;
};

// The critical value of one parameter, at which the outcome of the scene changes.
struct Threshold {
  std::string parameter;
  // The exact critical value for the other parameters as given.
  double (*critical)(const ParameterValues&) = nullptr;
  // Whether the observables say that it happened; it happens for values above the critical one if
  // `above`, else below.
  bool (*happened)(std::span<const double> values) = nullptr;
  bool above = true;
  double low_factor = 0.5;  // the search bracket, as factors of the critical value
  double high_factor = 2.0;
};

struct ExactCase {
  std::string id;  // family.name
  std::string title;
  std::string source;   // author, title, equation
  std::string claim;    // one or two sentences: what must be true and why
  std::string formula;  // one line of plain text
  Needs needs;
  std::vector<Parameter> parameters;  // includes step_s and duration_s
  std::vector<Observable> observables;
  // `values` holds every parameter, in range.
  ExactRun (*make)(const ParameterValues& values) = nullptr;
  // The scene's own time (s) at these values (duration_s aside): the default duration is
  // proportional to it, so that what the case measures happens within the run. nullptr: the
  // default is the same everywhere.
  double (*own_time_s)(const ParameterValues& values) = nullptr;
  // The domain within the ranges: why the claim says nothing at these values (all of them), as half
  // a sentence, or empty where it holds. nullptr: it holds over the whole of the ranges.
  std::string (*outside)(const ParameterValues& values) = nullptr;
  std::optional<Threshold> threshold;
  // What an engine of a given model class is known to do otherwise; empty if every one should
  // comply.
  std::string expected_violation;
  // Names the law of impact that the observables (and the truths) show; nullptr where there is no
  // choice of law.
  std::string (*classify)(std::span<const double> values, const ExactRun& run) = nullptr;
};

// The values of all parameters, defaults filled in; the duration follows the own time of the case.
// Fault::invalid for an unknown name, a value out of range or not finite.
Expected<ParameterValues> complete(const ExactCase& exact_case, const ParameterValues& given = {});

// Numbers of a completed set; the name exists.
double value_of(const ParameterValues& values, std::string_view name);

// complete() and make. Fault::invalid as complete(), outside the domain, or if the world is not
// valid.
Expected<ExactRun> build(const ExactCase& exact_case, const ParameterValues& given = {});

// A number parameter.
Parameter real(std::string name, std::string unit, double default_value, double minimum,
               double maximum, std::string meaning);
// The two parameters that every case has.
std::vector<Parameter> with_time(std::vector<Parameter> own, double step_s, double duration_s);

// Feeds the measure with a sequence of states and returns the observables.
class Recorder {
 public:
  Recorder(const ExactRun& run, std::size_t observables);
  void see(const Sample& sample) { measure_(sample, values_); }
  const std::vector<double>& values() const { return values_; }

 private:
  Measure measure_;
  std::vector<double> values_;
};

// experiments/exact/cases/catalog.cpp: one line per case.
std::vector<ExactCase> exact_cases();

}  // namespace brickbench::exact
