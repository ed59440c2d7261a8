// Truths of impacts and of friction against balances that their formulas do not use.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "experiments/exact/cases/builders.hpp"
#include "tests/exact/random_parameters.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::exact {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using Eigen::Vector3d;

constexpr Tolerance k_balance = {"momentum, energy and restitution of impact truths", 2e-13,
                                 2.3e-14, "rounding of a dozen operations"};
constexpr Tolerance k_thin = {"rod of vanishing thickness", 2e-5, 3.2e-6,
                              "first order in the thickness, 1e-6 of the length"};

struct Instance {
  ExactCase exact_case;
  ParameterValues values;
  ExactRun run;
  double truth(std::string_view name) const {
    for (std::size_t i = 0; i < exact_case.observables.size(); ++i) {
      if (exact_case.observables[i].name == name) return run.truths[i].value;
    }
    return std::nan("");
  }
  double operator[](std::string_view name) const { return value_of(values, name); }
};

Instance random_instance(std::string_view id, std::mt19937_64& generator) {
  Instance instance;
  instance.exact_case = testing::find_case(id);
  instance.values =
      complete(instance.exact_case, testing::random_parameters(instance.exact_case, generator))
          .value();
  instance.run = build(instance.exact_case, instance.values).value();
  return instance;
}

TEST(ImpactTruth, CentralCollisionsKeepMomentumAndRestitution) {
  Worst worst;
  std::mt19937_64 generator(7);
  for (int i = 0; i < 50; ++i) {
    const Instance s = random_instance("impact.central_spheres", generator);
    const double v = s["speed_mps"];
    const double w1 = s.truth("velocity_1_mps"), w2 = s.truth("velocity_2_mps");
    const double m1 = s["mass_1_kg"], m2 = s["mass_2_kg"];
    worst.see((m1 * w1 + m2 * w2 - m1 * v + 0.4 * m2 * v) / (m1 * v), "momentum");
    worst.see((w2 - w1 - s["restitution"] * 1.4 * v) / v, "restitution");
    const Instance b = random_instance("impact.central_boxes", generator);
    const double u = b["speed_mps"];
    worst.see((2.0 * b.truth("velocity_1_mps") + 3.0 * b.truth("velocity_2_mps") - 2.0 * u) / u,
              "momentum of boxes");
    worst.see((b.truth("velocity_2_mps") - b.truth("velocity_1_mps") - b["restitution"] * u) / u,
              "restitution of boxes");
  }
  EXPECT_TRUE(worst.within(k_balance));
}

TEST(ImpactTruth, ObliqueCollisionChangesTheNormalVelocityAlone) {
  Worst worst;
  std::mt19937_64 generator(8);
  for (int i = 0; i < 50; ++i) {
    const Instance s = random_instance("impact.oblique_spheres", generator);
    const double v = s["speed_mps"];
    const Vector3d w1(s.truth("velocity_1x_mps"), s.truth("velocity_1y_mps"), 0.0);
    const Vector3d w2(s.truth("velocity_2x_mps"), s.truth("velocity_2y_mps"), 0.0);
    // The centres stand 0.5 m apart with the given offset at the moment of the impact.
    const double angle = std::asin(s["offset_m"] / 0.5);
    const Vector3d n(std::cos(angle), std::sin(angle), 0.0);
    const Vector3d across(-n.y(), n.x(), 0.0);
    worst.see((w1 + 2.0 * w2 - Vector3d(v, 0.0, 0.0)).norm() / v, "momentum");
    worst.see((n.dot(w2 - w1) - s["restitution"] * v * n.x()) / v, "restitution");
    worst.see((across.dot(w1) - v * across.x()) / v, "tangential");
  }
  EXPECT_TRUE(worst.within(k_balance));
}

TEST(ImpactTruth, GroundImpactsMeetRestitutionAtTheCornerAndTheEnergyOfTheImpulse) {
  Worst worst;
  std::mt19937_64 generator(9);
  for (const char* id : {"impact.corner", "impact.rod"}) {
    for (int i = 0; i < 50; ++i) {
      const Instance s = random_instance(id, generator);
      const Body& body = s.run.world.bodies[1];
      std::vector<PointContact> contacts;
      const std::vector<State> states = {s.run.world.bodies[0].initial, body.initial};
      s.run.geometry(states, contacts);
      const Vector3d lever = contacts[0].position_m - body.initial.position_m;
      State after = body.initial;
      after.velocity_mps = {0.0, 0.0, s.truth("velocity_z_mps")};
      // Angular momentum about the corner is kept, which determines the spin about z as well.
      const Vector3d impulse = body.mass_kg * (after.velocity_mps - body.initial.velocity_mps);
      const Eigen::Matrix3d r = body.initial.orientation.toRotationMatrix();
      const Eigen::Matrix3d inertia = r * body.inertia_kgm2.asDiagonal() * r.transpose();
      after.angular_velocity_radps = inertia.inverse() * lever.cross(impulse);
      const double v = s["speed_mps"];
      const Vector3d point = after.velocity_mps + after.angular_velocity_radps.cross(lever);
      worst.see((point.z() - s["restitution"] * v) / v, std::string(id) + " restitution");
      const double size = after.angular_velocity_radps.norm();
      worst.see((s.truth("spin_x_radps") - after.angular_velocity_radps.x()) / size, "spin x");
      worst.see((s.truth("spin_y_radps") - after.angular_velocity_radps.y()) / size, "spin y");
      // Work of the impulse: mean of the corner's velocities before and after (Kelvin).
      const double before = 0.5 * body.mass_kg * v * v;
      const double work = 0.5 * impulse.z() * (point.z() - v);
      worst.see((s.truth("energy_j") - before - work) / before, std::string(id) + " energy");
    }
  }
  EXPECT_TRUE(worst.within(k_balance));
}

TEST(ImpactTruth, ThinRodFollowsTheTextbookFormula) {
  Worst worst;
  for (const double angle : {0.2, 0.7, 1.2}) {
    const ParameterValues given = {{"angle_rad", angle}, {"half_thickness_m", 1e-6}};
    const ExactCase rod = testing::find_case("impact.rod");
    const ParameterValues values = complete(rod, given).value();
    // Thinner than a run can step: the truth alone is asked for.
    const Instance s = {rod, values, rod.make(values)};
    const double v = s["speed_mps"];
    const double impulse =
        (1.0 + s["restitution"]) * v / (1.0 + 3.0 * std::pow(std::cos(angle), 2));
    worst.see((s.truth("velocity_z_mps") + v - impulse) / v, "velocity");
    const double spin = 6.0 * impulse * std::cos(angle);  // length 1, mass 1
    worst.see((std::abs(s.truth("spin_y_radps")) - spin) / spin, "spin");
  }
  EXPECT_TRUE(worst.within(k_thin));
}

TEST(ImpactTruth, OffCentreHitKeepsMomentaAndRestitution) {
  Worst worst;
  std::mt19937_64 generator(10);
  for (int i = 0; i < 50; ++i) {
    const Instance s = random_instance("impact.off_centre", generator);
    const double v = s["speed_mps"], lever = s["lever_m"];
    const double v1 = s.truth("velocity_1_mps"), v2 = s.truth("velocity_2_mps");
    const double w1 = s.truth("spin_1_radps");
    worst.see((4.0 * v1 + 1.0 * v2 - v) / v, "momentum");
    const double inertia = s.run.world.bodies[0].inertia_kgm2.z();
    worst.see((inertia * w1 - lever * v2 + lever * v) / (lever * v), "angular momentum");
    // Velocity of the struck point along x: v1 - w1 * y.
    worst.see((v1 - w1 * lever - v2 - s["restitution"] * v) / v, "restitution");
  }
  EXPECT_TRUE(worst.within(k_balance));
}

TEST(ImpactTruth, ChainsAndCradleKeepTheirInvariants) {
  Worst worst;
  std::mt19937_64 generator(11);
  for (int i = 0; i < 20; ++i) {
    // Two balls, elastic: the heavy one turned round by the plane first.
    const Instance s = random_instance("impact.small_on_big", generator);
    const double v = s["speed_mps"], heavy = s["heavy_mass_kg"];
    const double light_after = s.truth("velocity_light_mps");
    const double heavy_after = s.truth("velocity_heavy_mps");
    worst.see((heavy * heavy_after + light_after - (heavy - 1.0) * v) / (heavy * v), "momentum");
    worst.see(
        (heavy * heavy_after * heavy_after + light_after * light_after) / ((heavy + 1.0) * v * v) -
            1.0,
        "energy");
    worst.see((light_after - v * (3.0 * heavy - 1.0) / (heavy + 1.0)) / v, "closed form");
  }
  EXPECT_TRUE(worst.within(k_balance));
}

TEST(FrictionTruth, StopDistanceIsTheWorkOfFriction) {
  Worst worst;
  std::mt19937_64 generator(12);
  for (int i = 0; i < 20; ++i) {
    const Instance s = random_instance("friction.diagonal_slide", generator);
    const double v = s["speed_mps"];
    worst.see(s["friction"] * k_gravity_mps2 * s.truth("distance_m") / (0.5 * v * v) - 1.0, "work");
    worst.see(s.truth("stop_s") * v / 2.0 / s.truth("distance_m") - 1.0, "mean speed");
    const Instance turn = random_instance("friction.spin_stop", generator);
    const double w = turn["spin_radps"];
    worst.see(turn.truth("stop_s") * w / 2.0 / turn.truth("angle_rad") - 1.0, "mean spin");
    // Torque mu m g r on a square plate of half edge a: I = 2 m a^2/3, r = sqrt(2) a, a = 0.5.
    const double brake = turn["friction"] * k_gravity_mps2 * 3.0 / (std::sqrt(2.0) * 0.5);
    worst.see(turn.truth("stop_s") * brake / w - 1.0, "brake");
  }
  EXPECT_TRUE(worst.within(k_balance));
}

TEST(FrictionTruth, RollingKeepsAngularMomentumAboutTheContact) {
  Worst worst;
  std::mt19937_64 generator(13);
  for (int i = 0; i < 20; ++i) {
    const Instance s = random_instance("rolling.slide_to_roll", generator);
    const double v = s["speed_mps"], r = 0.125;
    worst.see((s.truth("speed_mps") + 0.4 * r * s.truth("spin_radps")) / v - 1.0, "L");
    for (const char* id : {"rolling.roll_down", "rolling.slip_down"}) {
      const Instance d = random_instance(id, generator);
      const double t = d["duration_s"];
      const double drive = k_gravity_mps2 * std::sin(d["angle_rad"]) * t;
      worst.see((d.truth("speed_mps") + 0.4 * r * d.truth("spin_radps")) / drive - 1.0, id);
      const double slip = d.truth("speed_mps") - r * d.truth("spin_radps");
      worst.see(std::min(0.0, slip / drive), "slip forward");
    }
  }
  EXPECT_TRUE(worst.within(k_balance));
}

TEST(FrictionTruth, PulledBricksMeetNewtonsLawTogetherAndApart) {
  Worst worst;
  std::mt19937_64 generator(14);
  for (const char* id : {"friction.pull_together", "friction.pull_apart"}) {
    const Instance s = random_instance(id, generator);
    const double t = s["duration_s"];
    const double sum = 4.0 * s.truth("speed_lower_mps") + 2.0 * s.truth("speed_upper_mps");
    worst.see(sum / (s["force_n"] * t) - 1.0, id);
    const double grip = s["friction"] * k_gravity_mps2 * t;
    worst.see(std::max(0.0, s.truth("speed_upper_mps") / grip - 1.0), "Coulomb's bound");
  }
  EXPECT_TRUE(worst.within(k_balance));
}

}  // namespace
}  // namespace brickbench::exact
