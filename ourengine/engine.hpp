// The public face of the library: bodies in, motions out, one step at a time.
//
// Two methods behind one interface. `exact` solves Coulomb's law and Newton's restitution to a
// residual in every step (dynamics/dynamics.hpp). `fast` is soft contact in small steps, in single
// precision inside a step (fast/fast_dynamics.hpp).
//
// World frame, SI, z up by default; quaternions turn body to world. Deterministic: the same bodies,
// options and calls give the same bits, whatever the number of threads.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "ourengine/model/body_model.hpp"

namespace ourengine {

enum class Method { exact, fast };

struct EngineOptions {
  Method method = Method::exact;
  double step_s = 1.0 / 240.0;  // > 0
  Eigen::Vector3d gravity_mps2 = {0.0, 0.0, -9.81};
  int threads = 1;  // >= 1, the caller's included
};

// One contact point of the last step.
struct EngineContact {
  int body_a = 0;  // indices of bodies
  int body_b = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     // unit, from a towards b
  double gap_m = 0.0;                                    // < 0: overlap, at the step's start
  Eigen::Vector3d impulse_ns = Eigen::Vector3d::Zero();  // on b, over the step
};

// What the last step was worth.
struct EngineReport {
  int contacts = 0;
  bool solved = true;           // the contact law was met within the method's tolerance
  double overlap_left_m = 0.0;  // new overlap at the step's end that the method could not prevent
};

class Engine {
 public:
  // bodies, motions: (bodies) both. Laws hold between the surfaces of bodies. A fixed body keeps
  // its pose and has no velocity. Refuses, naming body and reason, where sizes differ, a mass, an
  // inertia or the step is not positive, a number is not finite, a quaternion is not of length 1,
  // a surface has no law, or a plane is not fixed.
  static tl::expected<Engine, std::string> make(std::vector<BodyModel> bodies,
                                                std::vector<Motion> motions, SurfaceLaws laws,
                                                EngineOptions options = {});
  ~Engine();
  Engine(Engine&&) noexcept;
  Engine& operator=(Engine&&) noexcept;

  // (bodies) force (N) at and torque (N m) about the centre of mass, during the next step only.
  void apply(std::span<const Load> loads);
  // Advances by options().step_s.
  EngineReport step();

  // (bodies) after the last step.
  std::span<const Motion> motions() const;
  std::span<const BodyModel> bodies() const;
  std::vector<EngineContact> contacts() const;
  const EngineOptions& options() const { return options_; }

  // (bodies) replaces all motions and forgets contact history: the future depends on these alone.
  void set_motions(std::span<const Motion> motions);

 private:
  class Implementation;
  template <typename Method>
  class Adapted;
  Engine(EngineOptions options, std::unique_ptr<Implementation> implementation);

  EngineOptions options_;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace ourengine
