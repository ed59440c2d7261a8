#include "adapters/seam/guard.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <new>

namespace brickbench {
namespace {

// Calls into the engine; what it throws becomes a value.
template <typename Call>
auto caught(const Call& call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return fail(Fault::out_of_memory, "the engine ran out of memory");
  } catch (const std::exception& error) {
    return fail(Fault::crashed, fmt::format("the engine threw: {}", error.what()));
  } catch (...) {
    return fail(Fault::crashed, "the engine threw");
  }
}

class Guarded final : public Simulation, StateView {
 public:
  Guarded(const Adapter& adapter, const World& world, const Settings& settings)
      : build_(adapter.build), settings_(settings), world_(world), states_(world.bodies.size()) {}

  // Builds the engine, or builds it anew, from the initial states of `world`.
  Expected<void> start(const World& world) {
    auto made = caught([&] { return build_(world, settings_); });
    if (!made) return tl::unexpected(made.error());
    return adopt(std::move(*made));
  }

  void apply(std::span<const Wrench> wrenches) override {
    applied_ = caught([&]() -> Expected<void> {
      engine_->apply(wrenches);
      return {};
    });
  }

  Expected<void> step() override {
    if (!applied_) return applied_;
    auto done = caught([&]() -> Expected<void> {
      if (auto stepped = engine_->step(); !stepped) return stepped;
      engine_->read(states_);
      return {};
    });
    return done ? finite(states_) : done;
  }

  void read(std::span<State> states) const override { std::ranges::copy(states_, states.begin()); }

  const ContactView* contact_view() const override { return engine_->contact_view(); }
  const AuditView* audit_view() const override { return engine_->audit_view(); }
  const DiagnosticView* diagnostic_view() const override { return engine_->diagnostic_view(); }
  const CostView* cost_view() const override { return engine_->cost_view(); }
  StateView* state_view() override { return this; }

  Expected<void> set_state(std::span<const State> states) override {
    World next = world_;
    for (std::size_t i = 0; i < next.bodies.size(); ++i) {
      if (!next.bodies[i].fixed) next.bodies[i].initial = states[i];
    }
    if (auto valid = validate(next); !valid) return valid;
    applied_ = {};
    StateView* own = engine_->state_view();
    if (own == nullptr) return start(next);
    std::ranges::transform(next.bodies, states_.begin(), &Body::initial);
    return caught([&]() -> Expected<void> {
      if (auto set = own->set_state(states_); !set) return set;
      engine_->read(states_);
      return {};
    });
  }

 private:
  Expected<void> adopt(std::unique_ptr<Simulation> made) {
    auto seen = caught([&]() -> Expected<void> {
      made->read(states_);
      return {};
    });
    if (!seen) return seen;
    engine_ = std::move(made);
    return finite(states_);
  }

  Expected<void> finite(std::span<const State> states) const {
    const auto bad = std::ranges::find_if_not(states, &is_finite);
    if (bad == states.end()) return {};
    const auto body = static_cast<std::size_t>(bad - states.begin());
    return fail(Fault::diverged,
                fmt::format("the state of body '{}' is not finite", world_.bodies[body].name));
  }

  decltype(Adapter::build) build_;
  Settings settings_;
  World world_;
  std::unique_ptr<Simulation> engine_;
  Expected<void> applied_;
  std::vector<State> states_;  // (bodies), as the engine shows them now
};

}  // namespace

Expected<std::unique_ptr<Simulation>> build_guarded(const Adapter& adapter, const World& world,
                                                    const Settings& settings) {
  auto simulation = std::make_unique<Guarded>(adapter, world, settings);
  if (auto built = simulation->start(world); !built) return tl::unexpected(built.error());
  return simulation;
}

}  // namespace brickbench
