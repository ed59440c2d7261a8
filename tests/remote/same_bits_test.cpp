// A linked engine and the same engine over the protocol: the same states, contacts, diagnostics,
// flags and audits, to the last bit, whatever is asked.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "adapters/catalog.hpp"
#include "adapters/remote/link.hpp"
#include "adapters/remote/remote_adapter.hpp"

namespace brickbench {
namespace {

using remote::Command;

constexpr double k_step_s = 1.0 / 500.0;

Command served(const Adapter& adapter) {
  return {
      .words = {BRICKBENCH_REMOTE_PROGRAM, "serve", adapter.name}, .folder = {}, .environment = {}};
}

State at(double x, double y, double z) {
  State state;
  state.position_m = {x, y, z};
  return state;
}

struct NamedWorld {
  std::string name;
  World world;
};

// Flight, a stack that is hit on a floor, and balls that bounce on a plane, by laws of pairs.
std::vector<NamedWorld> worlds() {
  World flight;
  flight.gravity_mps2 = {0.1, -0.2, -9.81};
  flight.bodies = {
      solid_body("a \"brick\" called é", BoxShape{{0.3, 0.2, 0.1}}, 700.0, at(0, 0, 9)),
      solid_body("b", BoxShape{{0.1, 0.2, 0.1}}, 1.0 / 3.0, at(7, 0, 1.0 / 3.0))};
  flight.bodies[0].initial.angular_velocity_radps = {1, -2, 3};
  World stack;
  stack.law.friction = 0.5;
  stack.bodies.push_back(fixed_body("floor", BoxShape{{5, 5, 1}}, at(0, 0, -1)));
  for (int i = 0; i < 3; ++i) {
    stack.bodies.push_back(
        solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 2000.0, at(0.01 * i, 0, 0.05 + 0.1 * i)));
  }
  stack.bodies.push_back(
      solid_body("thrown", BoxShape{{0.05, 0.05, 0.05}}, 4000.0, at(0, -0.3, 0.2)));
  stack.bodies.back().initial.velocity_mps = {0, 6, 0};
  World balls;
  balls.bodies.push_back(ground_plane());
  for (int i = 0; i < 3; ++i) {
    balls.bodies.push_back(
        solid_body("ball", SphereShape{0.1}, 900.0, at(0.15 * i, 0, 0.3 + 0.1 * i)));
    balls.bodies.back().surface = i;
  }
  balls.exceptions = {{0, 1, {0.0, 0.5}}, {2, 1, {0.0, 0.9}}};
  World slippery = stack;
  slippery.law = {};
  return {{"flight", flight}, {"stack", stack}, {"slippery stack", slippery}, {"balls", balls}};
}

// All that a simulation shows now, as bytes.
std::string shown(const Simulation& simulation, std::size_t bodies) {
  remote::StepRecord record;
  record.states.resize(bodies);
  simulation.read(record.states);
  if (const DiagnosticView* view = simulation.diagnostic_view()) {
    record.flags = view->flags();
    record.tellable = view->tellable();
    record.diagnostics.assign(view->diagnostics().begin(), view->diagnostics().end());
  }
  std::string bytes = remote::to_bytes(std::array{record});
  if (const ContactView* view = simulation.contact_view()) {
    std::vector<Contact> contacts;
    view->contacts(contacts);
    bytes += fmt::format("{} contacts", contacts.size()) + remote::to_bytes(contacts);
  }
  return bytes;
}

std::string audited(const Simulation& simulation, std::size_t bodies) {
  const AuditView* view = simulation.audit_view();
  if (view == nullptr) return "none";
  std::string text = remote::to_json(view->audit());
  for (std::size_t b = 0; b < bodies; ++b) {
    const ContactLaw law = view->pair_law(0, b);
    text += fmt::format(" {} {}", law.friction, law.restitution);
  }
  return text;
}

std::vector<Wrench> blow(std::size_t bodies, std::size_t body) {
  std::vector<Wrench> wrenches(bodies);
  wrenches[body] = {{300.0, -0.0, 500.0 / 3.0}, {0.1, 1.0 / 7.0, 0.0}};
  return wrenches;
}

std::vector<State> pushed(const Simulation& simulation, std::size_t bodies) {
  std::vector<State> states(bodies);
  simulation.read(states);
  states.back().velocity_mps += Eigen::Vector3d(0.1, 0.2, 0.3);
  return states;
}

std::string reason_of(const auto& result) { return result ? "" : result.error().reason; }

// Knobs and variants, as they travel.
std::string knobs_text(const Adapter& adapter) {
  return remote::to_json(remote::Hello{"", "", {}, adapter.variants, adapter.knobs});
}

// Runs both side by side; 0 steps where the engine refuses the world, with the same words.
int compare(const Adapter& linked, const Adapter& over, const World& world,
            const Settings& settings) {
  const std::size_t bodies = world.bodies.size();
  const auto here = build(linked, world, settings);
  const auto there = build(over, world, settings);
  EXPECT_EQ(here.has_value(), there.has_value());
  if (!here || !there) {
    EXPECT_EQ(reason_of(here), reason_of(there));
    return 0;
  }
  EXPECT_EQ(audited(**here, bodies), audited(**there, bodies));
  int compared = 0;
  for (int step = 0; step < 80; ++step) {
    const std::vector<Wrench> wrenches =
        step == 5 || step == 60 ? blow(bodies, bodies - 1) : std::vector<Wrench>(bodies);
    for (Simulation* one : {here->get(), there->get()}) one->apply(wrenches);
    const auto a = (*here)->step(), b = (*there)->step();
    EXPECT_EQ(a.has_value(), b.has_value());
    if (!a || !b) {
      EXPECT_EQ(reason_of(a), reason_of(b));
      return compared;
    }
    EXPECT_EQ(shown(**here, bodies), shown(**there, bodies)) << "step " << step;
    if (::testing::Test::HasFailure()) return compared;
    ++compared;
    if (step != 40) continue;
    const auto states = pushed(**here, bodies);
    EXPECT_TRUE((*here)->state_view()->set_state(states));
    EXPECT_TRUE((*there)->state_view()->set_state(states));
    EXPECT_EQ(shown(**here, bodies), shown(**there, bodies)) << "after set-state";
  }
  return compared;
}

TEST(SameBits, OfEveryEngineAndVariantInSeveralWorlds) {
  for (const Adapter& adapter : adapters()) {
    const auto over = remote::remote_adapter(adapter.name, served(adapter));
    ASSERT_TRUE(over) << over.error().reason;
    EXPECT_EQ(over->version, adapter.version);
    EXPECT_EQ(knobs_text(*over), knobs_text(adapter));
    for (const Variant& variant : adapter.variants) {
      int compared = 0;
      for (const NamedWorld& one : worlds()) {
        SCOPED_TRACE(adapter.name + "/" + variant.name + ", " + one.name);
        compared += compare(adapter, *over, one.world,
                            {.step_s = k_step_s, .variant = variant.name, .knobs = {}});
        ASSERT_FALSE(::testing::Test::HasFailure());
      }
      EXPECT_GE(compared, 80) << adapter.name << "/" << variant.name;
    }
  }
}

// Asked for 1, 2, 3, 5 ... steps at once, with a blow in the first of some.
TEST(SameBits, OfManyStepsAtATime) {
  for (const Adapter& adapter : adapters()) {
    for (const NamedWorld& one : worlds()) {
      SCOPED_TRACE(adapter.name + ", " + one.name);
      const World& world = one.world;
      const std::size_t bodies = world.bodies.size();
      const Settings settings = settled(adapter, {.step_s = k_step_s, .variant = {}, .knobs = {}});
      const auto here = build(adapter, world, settings);
      auto link = remote::Link::open(served(adapter));
      ASSERT_TRUE(link) << link.error().reason;
      const auto there = link->build(world, settings);
      ASSERT_EQ(here.has_value(), there.has_value());
      if (!here) continue;
      std::vector<remote::StepRecord> records;
      for (const std::uint64_t count : {1, 2, 3, 5, 8, 13}) {
        const auto wrenches = count == 3 ? blow(bodies, bodies - 1) : std::vector<Wrench>{};
        const auto stepped = link->step(count, wrenches, records);
        for (std::uint64_t k = 0; k < count; ++k) {
          (*here)->apply(k == 0 && !wrenches.empty() ? wrenches : std::vector<Wrench>(bodies));
          const auto ok = (*here)->step();
          if (!ok) {
            ASSERT_FALSE(stepped);
            break;
          }
          if (!stepped) continue;
          std::vector<State> states(bodies);
          (*here)->read(states);
          EXPECT_EQ(hash_states(states), hash_states(records.at(k).states)) << count << " " << k;
        }
        if (!stepped) break;
        EXPECT_EQ(records.size(), count);
      }
    }
  }
}

}  // namespace
}  // namespace brickbench
