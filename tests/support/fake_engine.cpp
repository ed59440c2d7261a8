#include "tests/support/fake_engine.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace brickbench {

Adapter template_adapter();

namespace testing {
namespace {

constexpr double k_leak_per_step = 1e-6;
constexpr double k_long_step = 1.0 + 1e-6;
constexpr double k_shift_m = 1e-15;

// The one thing that this defect is about: memory that outlives a simulation.
double next_shift_m() {
  static std::atomic<int> built{0};
  return k_shift_m * built.fetch_add(1);
}

}  // namespace

const std::vector<Defect>& all_defects() {
  static const std::vector<Defect> defects = {
      Defect::half_gravity,   Defect::spin_in_body_frame,    Defect::nan_at_step_7,
      Defect::swapped_bodies, Defect::throws_at_step_5,      Defect::refuses,
      Defect::leaks_momentum, Defect::doubles_energy,        Defect::keeps_wrenches,
      Defect::rounds_time,    Defect::forgets_order_of_runs, Defect::lies_in_audit};
  return defects;
}

const char* to_string(Defect defect) {
  switch (defect) {
    case Defect::none:
      return "none";
    case Defect::half_gravity:
      return "half_gravity";
    case Defect::spin_in_body_frame:
      return "spin_in_body_frame";
    case Defect::nan_at_step_7:
      return "nan_at_step_7";
    case Defect::swapped_bodies:
      return "swapped_bodies";
    case Defect::throws_at_step_5:
      return "throws_at_step_5";
    case Defect::refuses:
      return "refuses";
    case Defect::leaks_momentum:
      return "leaks_momentum";
    case Defect::doubles_energy:
      return "doubles_energy";
    case Defect::keeps_wrenches:
      return "keeps_wrenches";
    case Defect::rounds_time:
      return "rounds_time";
    case Defect::forgets_order_of_runs:
      return "forgets_order_of_runs";
    case Defect::lies_in_audit:
      return "lies_in_audit";
  }
  return "unknown";
}

Faulty::Faulty(std::unique_ptr<Simulation> inner, const World& world, std::vector<Defect> defects)
    : inner_(std::move(inner)),
      world_(world),
      defects_(std::move(defects)),
      wrenches_(world.bodies.size()) {
  for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
    if (!world_.bodies[i].fixed) moving_.push_back(i);
  }
  if (has(Defect::forgets_order_of_runs)) shift_m_ = next_shift_m();
}

bool Faulty::has(Defect defect) const { return std::ranges::count(defects_, defect) > 0; }

void Faulty::apply(std::span<const Wrench> wrenches) {
  std::ranges::copy(wrenches, wrenches_.begin());
}

Expected<void> Faulty::step() {
  ++steps_;
  if (steps_ == 5 && has(Defect::throws_at_step_5)) throw std::runtime_error("a seeded fault");
  std::vector<Wrench> wrenches = wrenches_;
  if (has(Defect::half_gravity)) {
    for (const std::size_t i : moving_) {
      wrenches[i].force_n -= 0.5 * world_.bodies[i].mass_kg * world_.gravity_mps2;
    }
  }
  inner_->apply(wrenches);
  if (!has(Defect::keeps_wrenches)) std::ranges::fill(wrenches_, Wrench{});
  return inner_->step();
}

void Faulty::read(std::span<State> states) const {
  inner_->read(states);
  const bool stepped = steps_ > 0;
  for (const std::size_t i : moving_) {
    State& s = states[i];
    s.position_m.x() += shift_m_;
    if (has(Defect::leaks_momentum)) {
      const double left = std::pow(1.0 - k_leak_per_step, steps_);
      s.velocity_mps *= left;
      s.angular_velocity_radps *= left;
    }
    if (has(Defect::doubles_energy) && stepped) {
      s.velocity_mps *= std::sqrt(2.0);
      s.angular_velocity_radps *= std::sqrt(2.0);
    }
    if (has(Defect::spin_in_body_frame)) {
      s.angular_velocity_radps = s.orientation.conjugate() * s.angular_velocity_radps;
    }
  }
  if (has(Defect::swapped_bodies) && moving_.size() > 1) {
    std::swap(states[moving_[0]], states[moving_[1]]);
  }
  if (has(Defect::nan_at_step_7) && steps_ >= 7 && !moving_.empty()) {
    states[moving_[0]].position_m.x() = std::numeric_limits<double>::quiet_NaN();
  }
}

const AuditView* Faulty::audit_view() const {
  return inner_->audit_view() == nullptr ? nullptr : this;
}

Audit Faulty::audit() const {
  Audit audit = inner_->audit_view()->audit();
  if (has(Defect::lies_in_audit)) {
    for (BodyAudit& body : audit.bodies) body.mass_kg *= 1.01;
  }
  return audit;
}

ContactLaw Faulty::pair_law(std::size_t a, std::size_t b) const {
  return inner_->audit_view()->pair_law(a, b);
}

Expected<std::unique_ptr<Simulation>> build_faulty(const Adapter& adapter, const World& world,
                                                   Settings settings, std::vector<Defect> defects) {
  if (std::ranges::count(defects, Defect::refuses) > 0) {
    return fail(Fault::unsupported, "this fake refuses every world");
  }
  if (std::ranges::count(defects, Defect::rounds_time) > 0) settings.step_s *= k_long_step;
  auto inner = build(adapter, world, std::move(settings));
  if (!inner) return inner;
  return std::make_unique<Faulty>(std::move(*inner), world, std::move(defects));
}

Adapter correct_fake() { return template_adapter(); }

namespace {

using BuildFunction = Expected<std::unique_ptr<Simulation>> (*)(const World&, const Settings&);

template <Defect defect>
Expected<std::unique_ptr<Simulation>> build_fake(const World& world, const Settings& settings) {
  return build_faulty(correct_fake(), world, settings, {defect});
}

template <Defect... defects>
BuildFunction find_build(Defect wanted) {
  BuildFunction found = nullptr;
  ((wanted == defects ? void(found = build_fake<defects>) : void()), ...);
  return found;
}

}  // namespace

Adapter fake_adapter(Defect defect) {
  Adapter adapter = correct_fake();
  adapter.name = std::string("fake_") + to_string(defect);
  adapter.build = find_build<Defect::none, Defect::half_gravity, Defect::spin_in_body_frame,
                             Defect::nan_at_step_7, Defect::swapped_bodies,
                             Defect::throws_at_step_5, Defect::refuses, Defect::leaks_momentum,
                             Defect::doubles_energy, Defect::keeps_wrenches, Defect::rounds_time,
                             Defect::forgets_order_of_runs, Defect::lies_in_audit>(defect);
  return adapter;
}

}  // namespace testing
}  // namespace brickbench
