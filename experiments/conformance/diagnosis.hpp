// Diagnosis: what a wrong adapter most likely does wrong, in plain words. Each symptom is a model
// of a mistake that fits what the engine shows, where the right model does not.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/conformance/check.hpp"

namespace brickbench::conformance {

// "angular velocities look body-framed; asked is the world frame".
using Symptoms = std::vector<std::string>;

// Of all kinds below, in this order, and of none after symptoms of motion; none of a right engine.
// An engine that refuses a probe is not asked further in its kind, and one that throws or fails in
// a step says so.
Symptoms diagnose(const Subject& subject);

Symptoms motion_symptoms(const Subject& subject);   // frames, order, step, gravity
Symptoms push_symptoms(const Subject& subject);     // forces, torques, mass, inertia
Symptoms contact_symptoms(const Subject& subject);  // laws, sizes, contacts
Symptoms setting_symptoms(const Subject& subject);  // knobs and variants

// ---- what they are made of ----

// A model of a mistake, and what it yields where the right model yields `right`.
template <typename Value>
struct Model {
  std::string words;
  Value value;
};

// The words of the model that is nearest to `seen`, if the right one is further than `tolerance`
// and this one is not; all relative to the size of `right`. Empty where the right one fits, and
// `otherwise` where none does.
template <typename Value, typename Distance>
std::string nearest_model(const Value& seen, const Value& right,
                          const std::vector<Model<Value>>& models, double tolerance,
                          const Distance& distance, const std::string& otherwise) {
  if (distance(seen, right) <= tolerance) return {};
  const Model<Value>* nearest = nullptr;
  for (const Model<Value>& model : models) {
    if (distance(seen, model.value) > tolerance) continue;
    if (nearest == nullptr || distance(seen, model.value) < distance(seen, nearest->value)) {
      nearest = &model;
    }
  }
  return nearest == nullptr ? otherwise : nearest->words;
}

// A box with three different moments of inertia, turned away from all axes, at rest.
Body turned_box(const Eigen::Vector3d& position_m);
// The moments of inertia about the world's axes.
Eigen::Matrix3d world_inertia_of(const Body& body, const Eigen::Quaterniond& orientation);

}  // namespace brickbench::conformance
