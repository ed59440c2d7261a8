#include <utility>

#include "adapters/catalog.hpp"
#include "adapters/seam/shape.hpp"
#include "tests/faults/seeded_faults.hpp"

namespace brickbench::testing {
namespace {

class FaultySimulation final : public Simulation, ContactView {
 public:
  FaultySimulation(std::unique_ptr<Simulation> inner, const World& world, const SeededFault& fault,
                   double step_s, bool audit)
      : inner_(std::move(inner)), world_(world), fault_(fault), step_s_(step_s), audit_(audit) {
    previous_.resize(world.bodies.size());
    wrenches_.resize(world.bodies.size());
    inner_->read(previous_);
  }

  void apply(std::span<const Wrench> wrenches) override {
    wrenches_.assign(wrenches.begin(), wrenches.end());
    std::vector<Wrench> wrong = wrenches_;
    if (fault_.load != nullptr) fault_.load(wrong, previous_, step_);
    inner_->apply(wrong);
  }

  Expected<void> step() override {
    inner_->read(previous_);
    if (const ContactView* view = inner_->contact_view()) view->contacts(previous_contacts_);
    ++step_;
    if (auto ok = inner_->step(); !ok || fault_.step == nullptr) return ok;
    std::vector<State> states(previous_.size());
    inner_->read(states);
    SpoiledStep spoiled{world_, previous_, states, wrenches_, step_s_, memory_};
    if (!fault_.step(spoiled)) return {};
    return inner_->state_view()->set_state(states);
  }

  void read(std::span<State> states) const override {
    inner_->read(states);
    if (fault_.read == nullptr || step_ == 0) return;
    Readout readout = {states, previous_, world_, step_, step_s_};
    fault_.read(readout);
  }

  const ContactView* contact_view() const override {
    return inner_->contact_view() == nullptr ? nullptr : this;
  }
  const AuditView* audit_view() const override { return audit_ ? inner_->audit_view() : nullptr; }

 private:
  void contacts(std::vector<Contact>& contacts) const override {
    inner_->contact_view()->contacts(contacts);
    if (fault_.contacts != nullptr) fault_.contacts(contacts, previous_contacts_, step_s_);
  }

  std::unique_ptr<Simulation> inner_;
  World world_;
  const SeededFault& fault_;
  double step_s_;
  bool audit_;
  int step_ = 0;
  std::vector<State> previous_;
  std::vector<Wrench> wrenches_;
  std::vector<Contact> previous_contacts_;
  int memory_ = 0;
};

Expected<std::unique_ptr<Simulation>> build_faulty(const SeededFault& fault, bool audit,
                                                   const World& world, const Settings& settings) {
  World wrong_world = world;
  Settings wrong_settings = settings;
  if (fault.world != nullptr) fault.world(wrong_world);
  if (fault.settings != nullptr) fault.settings(wrong_settings);
  auto inner = build(correct_adapter(), wrong_world, wrong_settings);
  if (!inner) return inner;
  return std::make_unique<FaultySimulation>(std::move(*inner), world, fault, settings.step_s,
                                            audit);
}

}  // namespace

World demanding_world() {
  World world;
  world.law = {.friction = 0.5, .restitution = 0.5};
  State above;
  above.position_m.z() = 2.0;
  world.bodies = {ground_plane(), solid_body("ball", SphereShape{0.5}, 1.0, above)};
  return world;
}

Adapter correct_adapter() {
  for (Adapter& adapter : adapters()) {
    if (!scheme_of(adapter, {}) || !adapter.asked) continue;
    if (build(adapter, demanding_world(), {}).has_value()) return adapter;
  }
  return {};
}

Adapter faulty_adapter(std::size_t index, bool audit) {
  const SeededFault& fault = seeded_faults()[index];
  Adapter adapter = correct_adapter();
  adapter.name = fault.name;
  adapter.build = [&fault, audit](const World& world, const Settings& settings) {
    return build_faulty(fault, audit, world, settings);
  };
  return adapter;
}

}  // namespace brickbench::testing
