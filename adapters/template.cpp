// template: free flight of rigid bodies, the smallest adapter that is right in what it does.
//
// Choices:
//  * Semi-implicit Euler for the motion of the centre of mass. The angular velocity in the body
//  frame
//    follows Euler's equations by explicit Euler; the orientation turns by the exponential map.
//  * There is no contact: a step after which a moving body comes closer to another body than their
//    bounding spheres allow is refused with Fault::unsupported, never run through.
//
// To make an adapter of your own: copy this file and template.cmake, rename template_adapter(), put
// your engine's calls where FreeFlight computes, and declare the views that your engine offers.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "adapters/seam/knob_table.hpp"
#include "adapters/seam/shape.hpp"

namespace brickbench {
namespace {

// What the engine keeps of its settings.
struct Options {
  double clearance_m = 0.0;
};

constexpr std::array k_knobs = {
    KnobRow<Options>{"clearance_m", "m", 0.0, 0.0, 0.0, 1e3, false,
                     "the step is refused where bounding spheres come closer than this",
                     &Held<&Options::clearance_m>::set, &Held<&Options::clearance_m>::read},
};

// rotation by the vector `angle_rad` (axis times angle)
Eigen::Quaterniond exponential(const Eigen::Vector3d& angle_rad) {
  const double angle = angle_rad.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, angle_rad / angle));
}

class FreeFlight final : public Simulation, AuditView {
 public:
  FreeFlight(const World& world, double step_s, const Options& options)
      : world_(world),
        step_s_(step_s),
        options_(options),
        states_(world.bodies.size()),
        wrenches_(world.bodies.size()) {
    std::ranges::transform(world_.bodies, states_.begin(), &Body::initial);
  }

  void apply(std::span<const Wrench> wrenches) override {
    std::ranges::copy(wrenches, wrenches_.begin());
  }

  Expected<void> step() override {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (!world_.bodies[i].fixed) advance(i);
    }
    std::ranges::fill(wrenches_, Wrench{});
    return refuse_contact();
  }

  void read(std::span<State> states) const override { std::ranges::copy(states_, states.begin()); }

  const AuditView* audit_view() const override { return this; }

  Audit audit() const override {
    Audit audit;
    audit.gravity_mps2 = world_.gravity_mps2;
    for (const Body& body : world_.bodies) {
      BodyAudit facts;
      facts.fixed = body.fixed;
      facts.shape = body.shape;
      if (!body.fixed) {
        facts.mass_kg = body.mass_kg;
        facts.inertia_kgm2 = body.inertia_kgm2;
      }
      audit.bodies.push_back(facts);
    }
    audit.settings = read_knobs(k_knobs, options_);
    audit.settings.push_back(number_fact("step_s", "s", step_s_));
    return audit;
  }
  ContactLaw pair_law(std::size_t a, std::size_t b) const override {
    return contact_law(world_, a, b);
  }

 private:
  void advance(std::size_t i) {
    const Body& body = world_.bodies[i];
    State& s = states_[i];
    s.velocity_mps += step_s_ * (world_.gravity_mps2 + wrenches_[i].force_n / body.mass_kg);
    s.position_m += step_s_ * s.velocity_mps;
    const Eigen::Quaterniond to_body = s.orientation.conjugate();
    Eigen::Vector3d spin = to_body * s.angular_velocity_radps;
    const Eigen::Vector3d momentum = body.inertia_kgm2.cwiseProduct(spin);
    const Eigen::Vector3d torque = to_body * wrenches_[i].torque_nm - spin.cross(momentum);
    spin += step_s_ * torque.cwiseQuotient(body.inertia_kgm2);
    s.orientation = (s.orientation * exponential(step_s_ * spin)).normalized();
    s.angular_velocity_radps = s.orientation * spin;
  }

  double gap_m(std::size_t moving, std::size_t other) const {
    const Body& obstacle = world_.bodies[other];
    const Eigen::Vector3d apart = states_[moving].position_m - states_[other].position_m;
    const double distance_m = is_half_space(obstacle.shape)
                                  ? apart.dot(states_[other].orientation * Eigen::Vector3d::UnitZ())
                                  : apart.norm() - bounding_radius_m(obstacle.shape);
    return distance_m - bounding_radius_m(world_.bodies[moving].shape);
  }

  Expected<void> refuse_contact() const {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (world_.bodies[i].fixed) continue;
      for (std::size_t k = 0; k < states_.size(); ++k) {
        if (i == k || gap_m(i, k) > options_.clearance_m) continue;
        return fail(Fault::unsupported,
                    fmt::format("bodies '{}' and '{}' may touch, and this engine has no contact",
                                world_.bodies[i].name, world_.bodies[k].name));
      }
    }
    return {};
  }

  World world_;
  double step_s_;
  Options options_;
  std::vector<State> states_;
  std::vector<Wrench> wrenches_;
};

Expected<std::unique_ptr<Simulation>> build_template(const World& world, const Settings& settings) {
  Options options;
  set_knobs(k_knobs, settings, options);
  return std::make_unique<FreeFlight>(world, settings.step_s, options);
}

std::vector<AuditFact> asked_of_template(const World& world, const Settings& settings) {
  return asked_knobs(k_knobs, world, settings);
}

// Exactly what FreeFlight::advance() does.
std::optional<Scheme> template_scheme(const Settings&) {
  Scheme scheme;
  scheme.source = "adapters/template.cpp, FreeFlight::advance()";
  scheme.position = PositionRule::new_velocity;
  scheme.gyroscopic = GyroscopicRule::explicit_body;
  scheme.attitude = AttitudeRule::exponential;
  return scheme;
}

}  // namespace

Adapter template_adapter() {
  return {.name = "template",
          .version = "1",
          .variants = {{"free_flight", "no contact: refuses the step in which bodies may touch",
                        "f64", tuned_values(k_knobs)}},
          .knobs = to_knobs(k_knobs),
          .build = build_template,
          .scheme = template_scheme,
          .asked = asked_of_template};
}

}  // namespace brickbench
