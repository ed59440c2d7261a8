// A World as a MuJoCo model: the MJCF text, its compilation in memory, the sizes of its buffers.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <stdexcept>

#include "adapters/seam/adapter.hpp"

namespace brickbench::mujoco {

// What MuJoCo said through mju_error or mju_warning.
struct EngineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct FreeModel {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct FreeData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPtr = std::unique_ptr<mjModel, FreeModel>;
using DataPtr = std::unique_ptr<mjData, FreeData>;

// How contacts are softened, and how many fit.
struct ContactSettings {
  double time_constant_s = 0.02;  // "solref", first number
  double damping_ratio = 1.0;     // "solref", second number
  double contacts_per_body = 12.0;
};

// From now on MuJoCo's errors and warnings are thrown as EngineError instead of ending the process
// or writing MUJOCO_LOG.TXT into the current directory. The handlers are MuJoCo's own global
// variables; setting them again is harmless.
void throw_errors_and_warnings();

// The model of the world with MuJoCo's default options. The geom of body i is named "g<i>" (MuJoCo
// sorts fixed geoms first); a moving body has a free joint, fixed geoms belong to body 0. Friction
// per pair is exact: by the geoms' coefficients where "the larger of the two counts" can express
// the world's law, else by an explicit <pair> for each pair. Fault::unsupported where the law of a
// pair cannot be expressed (restitution; friction below MuJoCo's own least value), with the reason.
Expected<ModelPtr> compile(const World& world, const ContactSettings& contact);

// Contacts that the buffers of a model with so many moving bodies must hold.
double contact_room(const ContactSettings& contact, double moving_bodies);

// Sets nconmax, njmax and nstack of the model for its options (cone, noslip), and allocates.
// Fault::unsupported with the numbers where MuJoCo's buffer (2 GiB at most) cannot hold them.
Expected<DataPtr> allocate(mjModel& model, const ContactSettings& contact);

// The friction coefficient that MuJoCo would use between two geoms.
double pair_friction(const mjModel& model, int geom_a, int geom_b);

}  // namespace brickbench::mujoco
