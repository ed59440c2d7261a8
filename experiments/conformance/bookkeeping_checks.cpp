// Rules about what an engine says of itself, and about what it refuses.
#include <fmt/core.h>

#include <cmath>

#include "adapters/seam/shape.hpp"
#include "experiments/conformance/check.hpp"

namespace brickbench::conformance {
namespace {

// Bodies of all shapes far apart, with laws of pairs of their own; `friction` scales all of them.
World many_laws(double friction) {
  World world;
  world.gravity_mps2 = {0.5, -0.25, -9.0};
  world.law.friction = friction * 0.5;
  for (int i = 0; i < 4; ++i) {
    State state;
    state.position_m = {10.0 * i, 0, 5.0};
    const Shape shape =
        i % 2 == 0 ? Shape{BoxShape{{0.1 + 0.1 * i, 0.2, 0.3}}} : Shape{SphereShape{0.1 + 0.1 * i}};
    world.bodies.push_back(i == 1 ? fixed_body("fixed", shape, state)
                                  : solid_body("moving", shape, 500.0 * (i + 1), state));
    world.bodies.back().surface = i % 3;
  }
  world.bodies[2].inertia_kgm2 = {1.0, 1.5, 2.0};
  world.exceptions = {{0, 1, {friction * 0.2, 0.0}}, {2, 0, {friction * 0.9, 0.0}}};
  return world;
}

std::string text(const Eigen::Vector3d& v) { return fmt::format("({}, {}, {})", v[0], v[1], v[2]); }

constexpr Tolerance k_audit = {"audit", 2e-15, 1.48e-16,
                               "relative; an engine may keep reciprocals, or m^2 of two factors"};

Verdict audit_check(const Subject& subject) {
  return guarded([&] {
    World world = many_laws(1.0);
    if (const auto probe = subject.build(world, k_step_s);
        !probe && probe.error().fault == Fault::unsupported) {
      world = many_laws(0.0);
    }
    const auto simulation = must_build(subject, world, k_step_s, false);
    const AuditView* view = simulation->audit_view();
    if (view == nullptr) return Verdict{Outcome::no_view, "no audit view"};
    const Audit audit = view->audit();
    if (audit.bodies.size() != world.bodies.size()) return failed("number of bodies");
    if (audit.settings.empty()) return failed("no settings");
    Worst worst;
    worst.see((audit.gravity_mps2 - world.gravity_mps2).norm(), text(audit.gravity_mps2));
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Body& body = world.bodies[i];
      const BodyAudit& facts = audit.bodies[i];
      const std::string where = fmt::format("body {}: ", i);
      if (facts.fixed != body.fixed) return failed(where + "fixed or not");
      if (facts.can_sleep) return failed(where + "can fall asleep");
      worst.see(facts.linear_damping_hz, where + "linear damping");
      worst.see(facts.angular_damping_hz, where + "angular damping");
      worst.see(size_difference_m(facts.shape, body.shape), where + "shape");
      const double mass_kg = body.fixed ? 0.0 : body.mass_kg;
      const Eigen::Vector3d inertia_kgm2 =
          body.fixed ? Eigen::Vector3d(0, 0, 0) : body.inertia_kgm2;
      worst.see((facts.mass_kg - mass_kg) / (body.fixed ? 1.0 : mass_kg), where + "mass");
      worst.see(
          (facts.inertia_kgm2 - inertia_kgm2).norm() / (body.fixed ? 1.0 : inertia_kgm2.norm()),
          where + "inertia " + text(facts.inertia_kgm2));
      for (std::size_t k = 0; k < i; ++k) {
        const ContactLaw wanted = contact_law(world, k, i);
        const ContactLaw law = view->pair_law(i, k);
        worst.see(law.friction - wanted.friction, fmt::format("friction of {} and {}", k, i));
        worst.see(law.restitution - wanted.restitution, fmt::format("restitution {} {}", k, i));
      }
    }
    return within(worst, k_audit);
  });
}

Verdict receipts_check(const Subject& subject) {
  const Adapter& adapter = subject.adapter;
  if (adapter.name.empty() || adapter.version.empty()) return failed("no name or no version");
  for (const Knob& knob : adapter.knobs) {
    if (knob.unit.empty() || knob.meaning.empty()) return failed("knob without unit or meaning");
  }
  for (const Variant& variant : adapter.variants) {
    if (variant.meaning.empty()) return failed("variant without meaning");
    if (variant.precision != "f64" && variant.precision != "f32") return failed("precision");
  }
  return passed();
}

Verdict expect_fault(const Expected<std::unique_ptr<Simulation>>& built, Fault fault,
                     const char* what) {
  if (built) return failed(fmt::format("{} was built", what));
  if (built.error().fault != fault || built.error().reason.empty()) {
    return failed(
        fmt::format("{}: {}, '{}'", what, to_outcome(built.error().fault), built.error().reason));
  }
  return passed();
}

Verdict refusal_check(const Subject& subject) {
  return guarded([&] {
    World fine;
    fine.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.1, 0.1}}, 2000.0));
    World negative = fine;
    negative.bodies[0].mass_kg = -1.0;
    Settings variant;
    variant.variant = "no such variant";
    Settings fits;
    fits.variant = subject.variant;
    Settings knob = fits;
    knob.knobs["no_such_knob"] = 1.0;
    Settings step = fits;
    step.step_s = 0.0;
    Settings threads = fits;
    threads.threads = 3;
    for (const Verdict& verdict :
         {expect_fault(subject.build(negative, k_step_s), Fault::invalid, "a negative mass"),
          expect_fault(build(subject.adapter, fine, variant), Fault::invalid, "a variant"),
          expect_fault(build(subject.adapter, fine, knob), Fault::invalid, "a knob"),
          expect_fault(build(subject.adapter, fine, step), Fault::invalid, "a step of 0")}) {
      if (verdict.outcome != Outcome::passed) return verdict;
    }
    const auto built = build(subject.adapter, fine, threads);
    return built ? passed() : expect_fault(built, Fault::unsupported, "three threads");
  });
}

// Each knob beyond each end of its range, and between whole numbers: refused by every way to build.
Verdict knob_ranges_check(const Subject& subject) {
  return guarded([&] {
    World world;
    world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.1, 0.1}}, 2000.0));
    for (const Knob& knob : subject.adapter.knobs) {
      std::vector<double> beyond = {std::nextafter(knob.min, -HUGE_VAL),
                                    std::nextafter(knob.max, HUGE_VAL), HUGE_VAL, std::nan("")};
      if (knob.whole) beyond.push_back(std::nextafter(knob.min, HUGE_VAL));
      if (knob.min > knob.max || knob.engine_default < knob.min || knob.engine_default > knob.max) {
        return failed(knob.name + ": the default is out of range");
      }
      for (const double value : beyond) {
        Settings settings;
        settings.variant = subject.variant;
        settings.knobs[knob.name] = value;
        const auto built = build(subject.adapter, world, settings);
        const std::string what = fmt::format("{} = {}", knob.name, value);
        const Verdict verdict = expect_fault(built, Fault::invalid, what.c_str());
        if (verdict.outcome != Outcome::passed) return verdict;
        if (!built.error().reason.starts_with("knob " + knob.name)) {
          return failed(what + ": " + built.error().reason);
        }
      }
    }
    return passed();
  });
}

// A force that no double can carry: the engine may say so or return what is not finite, but neither
// throw nor pretend that all is well.
Verdict overflow_check(const Subject& subject) {
  return guarded([&] {
    World world;
    world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.1, 0.1}}, 2000.0));
    const auto simulation = must_build(subject, world, k_step_s, false);
    const std::vector<Wrench> wrenches = {{Eigen::Vector3d::Constant(HUGE_VAL), {0, 0, 0}}};
    simulation->apply(wrenches);
    const auto stepped = simulation->step();
    if (!stepped) return stepped.error().reason.empty() ? failed("no reason") : passed();
    return is_finite(read(*simulation, world)[0]) ? failed("an infinite force left no trace")
                                                  : passed();
  });
}

Verdict empty_world_check(const Subject& subject) {
  return guarded([&] {
    World only_fixed;
    only_fixed.bodies.push_back(ground_plane());
    for (const World& world : {World{}, only_fixed}) {
      const auto built = subject.build(world, k_step_s);
      if (!built && built.error().reason.empty()) return failed("refused without a reason");
      if (built) {
        if (auto stepped = (*built)->step(); !stepped) return failed(stepped.error().reason);
      }
    }
    return passed();
  });
}

}  // namespace

std::vector<Check> bookkeeping_checks() {
  return {
      {"receipts", "name, version, precision, knobs with unit and meaning", receipts_check},
      {"audit", "the live engine holds the facts of the World", audit_check},
      {"refusals", "what is impossible is refused with a reason", refusal_check},
      {"knob_ranges", "a knob out of its range is refused", knob_ranges_check},
      {"overflow", "an infinite force is not hidden", overflow_check},
      {"empty_world", "a world without moving bodies does no harm", empty_world_check},
  };
}

}  // namespace brickbench::conformance
