#include "ourengine/engine.hpp"

#include <cmath>
#include <utility>

#include "ourengine/contact/solvers.hpp"
#include "ourengine/exact/dynamics.hpp"
#include "ourengine/fast/fast_dynamics.hpp"

namespace ourengine {
namespace {

// Quaternions written with six digits are still of length 1.
constexpr double k_unit_tolerance = 1e-6;

bool is_positive(double value) { return std::isfinite(value) && value > 0.0; }

std::string geometry_error(const BoxGeometry& box, const BodyModel&) {
  return box.half_m.allFinite() && box.half_m.minCoeff() > 0.0 ? "" : "half edges are not positive";
}
std::string geometry_error(const SphereGeometry& sphere, const BodyModel&) {
  return is_positive(sphere.radius_m) ? "" : "radius is not positive";
}
std::string geometry_error(const PlaneGeometry&, const BodyModel& model) {
  return model.fixed ? "" : "a plane must be fixed";
}

std::string body_model_error(const BodyModel& model, int kinds) {
  const std::string shape = std::visit(
      [&](const auto& geometry) { return geometry_error(geometry, model); }, model.geometry);
  if (!shape.empty()) return shape;
  if (model.surface < 0 || model.surface >= kinds) return "its surface has no law";
  if (model.fixed) return "";
  if (!is_positive(model.mass_kg)) return "mass is not positive";
  if (!model.inertia_kgm2.allFinite() || !(model.inertia_kgm2.minCoeff() > 0.0)) {
    return "inertia is not positive";
  }
  return "";
}

std::string motion_error(const Motion& motion) {
  if (!motion.position_m.allFinite()) return "position is not finite";
  if (!motion.velocity_mps.allFinite()) return "velocity is not finite";
  if (!motion.angular_momentum_kgm2ps.allFinite()) return "angular momentum is not finite";
  if (!(std::abs(motion.attitude.norm() - 1.0) <= k_unit_tolerance)) {
    return "attitude is not a quaternion of length 1";
  }
  return "";
}

std::string model_error(std::span<const BodyModel> bodies, std::span<const Motion> motions,
                        const SurfaceLaws& laws, const EngineOptions& options) {
  if (!is_positive(options.step_s)) return "step_s is not positive";
  if (!options.gravity_mps2.allFinite()) return "gravity is not finite";
  if (options.threads < 1) return "threads is below 1";
  if (bodies.size() != motions.size()) return "bodies and motions differ in number";
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    std::string error = body_model_error(bodies[i], laws.kinds());
    if (error.empty()) error = motion_error(motions[i]);
    if (!error.empty()) return "body " + std::to_string(i) + ": " + error;
  }
  return "";
}

// What is fixed has no motion, whatever was given.
std::vector<Motion> at_rest_where_fixed(std::span<const BodyModel> bodies,
                                        std::vector<Motion> motions) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].fixed) continue;
    motions[i].velocity_mps.setZero();
    motions[i].angular_momentum_kgm2ps.setZero();
  }
  return motions;
}

DynamicsOptions dynamics_options(const EngineOptions& given) {
  DynamicsOptions options;
  options.step_s = given.step_s;
  options.gravity_mps2 = given.gravity_mps2;
  options.threads = given.threads;
  options.solver = &solve_exact;
  options.solve.slip_tolerance = 1e-6;
  return options;
}

FastOptions fast_options(const EngineOptions& given) {
  constexpr double k_longest_substep_s = 1.0 / 4800;
  FastOptions options;
  options.step_s = given.step_s;
  options.substeps =
      std::max(1, static_cast<int>(std::ceil(given.step_s / k_longest_substep_s - 1e-9)));
  options.gravity_mps2 = given.gravity_mps2;
  options.threads = given.threads;
  return options;
}

EngineReport summary(const StepReport& report) {
  return {.contacts = report.contacts,
          .solved = report.status == SolveStatus::kSolved && !report.ran_out,
          .overlap_left_m = report.overlap_left_m};
}
EngineReport summary(const FastReport& report) {
  return {.contacts = report.contacts,
          .solved = !report.ran_out,
          .overlap_left_m = report.overlap_left_m};
}

}  // namespace

class Engine::Implementation {
 public:
  virtual ~Implementation() = default;
  virtual void apply(std::span<const Load> loads) = 0;
  virtual EngineReport step() = 0;
  virtual std::span<const Motion> motions() const = 0;
  virtual std::span<const BodyModel> bodies() const = 0;
  virtual std::vector<EngineContact> contacts() const = 0;
  virtual void set_motions(std::span<const Motion> motions) = 0;
};

template <typename Stepper>
class Engine::Adapted final : public Implementation {
 public:
  template <typename Options>
  Adapted(std::vector<BodyModel> bodies, std::vector<Motion> motions, SurfaceLaws laws,
          const Options& options)
      : stepper_(std::move(bodies), std::move(motions), std::move(laws), options) {}

  void apply(std::span<const Load> loads) override { stepper_.apply(loads); }
  EngineReport step() override { return summary(stepper_.step()); }
  std::span<const Motion> motions() const override { return stepper_.motions(); }
  std::span<const BodyModel> bodies() const override { return stepper_.bodies(); }
  std::vector<EngineContact> contacts() const override {
    std::vector<EngineContact> contacts;
    for (const auto& point : stepper_.contacts()) {
      contacts.push_back({point.body_a, point.body_b, point.position_m, point.normal, point.gap_m,
                          point.impulse_ns});
    }
    return contacts;
  }
  void set_motions(std::span<const Motion> motions) override { stepper_.set_motions(motions); }

 private:
  Stepper stepper_;
};

Engine::Engine(EngineOptions options, std::unique_ptr<Implementation> implementation)
    : options_(std::move(options)), implementation_(std::move(implementation)) {}
Engine::~Engine() = default;
Engine::Engine(Engine&&) noexcept = default;
Engine& Engine::operator=(Engine&&) noexcept = default;

tl::expected<Engine, std::string> Engine::make(std::vector<BodyModel> bodies,
                                               std::vector<Motion> motions, SurfaceLaws laws,
                                               EngineOptions options) {
  if (std::string error = model_error(bodies, motions, laws, options); !error.empty()) {
    return tl::unexpected(std::move(error));
  }
  motions = at_rest_where_fixed(bodies, std::move(motions));
  std::unique_ptr<Implementation> implementation;
  switch (options.method) {
    case Method::exact:
      implementation = std::make_unique<Adapted<Dynamics>>(
          std::move(bodies), std::move(motions), std::move(laws), dynamics_options(options));
      break;
    case Method::fast:
      implementation = std::make_unique<Adapted<FastDynamics>>(
          std::move(bodies), std::move(motions), std::move(laws), fast_options(options));
      break;
  }
  return Engine(options, std::move(implementation));
}

void Engine::apply(std::span<const Load> loads) { implementation_->apply(loads); }
EngineReport Engine::step() { return implementation_->step(); }
std::span<const Motion> Engine::motions() const { return implementation_->motions(); }
std::span<const BodyModel> Engine::bodies() const { return implementation_->bodies(); }
std::vector<EngineContact> Engine::contacts() const { return implementation_->contacts(); }
void Engine::set_motions(std::span<const Motion> motions) { implementation_->set_motions(motions); }

}  // namespace ourengine
