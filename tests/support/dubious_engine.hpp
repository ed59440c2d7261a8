// Engines whose runs go to their end and are not to be believed, or explode on the way: for
// whatever judges validity.
#pragma once

#include <string>

#include "tests/unit/run/fakes.hpp"

namespace brickbench::testing {

inline constexpr int k_dubious_from = 4;  // first step that raises the flag, or explodes
inline constexpr int k_dubious_to = 6;    // last step that raises the flag

// Falls freely, and admits `flag` of the steps 4 to 6.
template <Flag flag>
class AdmittingSimulation final : public FakeSimulation<Mishap::none>, DiagnosticView {
 public:
  using FakeSimulation::FakeSimulation;
  Expected<void> step() override {
    ++steps_;
    told_ = {{"residual", "1", steps_ >= k_dubious_from ? 0.5 : 0.0}};
    return FakeSimulation::step();
  }
  const DiagnosticView* diagnostic_view() const override { return this; }

 private:
  std::span<const Diagnostic> diagnostics() const override { return told_; }
  Flags flags() const override {
    return steps_ >= k_dubious_from && steps_ <= k_dubious_to ? Flags(flag) : Flags();
  }
  Flags tellable() const override { return Flags(flag); }

  int steps_ = 0;
  std::vector<Diagnostic> told_;
};

// Falls freely; in step 4 the last body is where and as fast as no world has made it.
class ExplodingSimulation final : public FakeSimulation<Mishap::none> {
 public:
  using FakeSimulation::FakeSimulation;
  Expected<void> step() override {
    ++steps_;
    return FakeSimulation::step();
  }
  void read(std::span<State> states) const override {
    FakeSimulation::read(states);
    if (steps_ >= k_dubious_from) states.back().velocity_mps.z() += 2e3;
  }

 private:
  int steps_ = 0;
};

template <typename Simulated>
Adapter dubious_adapter(std::string name) {
  Adapter adapter = fake_adapter<Mishap::none>(std::move(name));
  adapter.build = [](const World& world,
                     const Settings& settings) -> Expected<std::unique_ptr<Simulation>> {
    return std::make_unique<Simulated>(world, settings);
  };
  return adapter;
}

// The tiny world of the fakes: "good", one engine that admits each flag of an engine, named after
// it, and "exploder".
inline Catalogues dubious_catalogues() {
  Catalogues catalogues = fake_catalogues();
  catalogues.adapters = {
      fake_adapter<Mishap::none>("good"),
      dubious_adapter<AdmittingSimulation<Flag::unsolved>>("unsolved"),
      dubious_adapter<AdmittingSimulation<Flag::clamped>>("clamped"),
      dubious_adapter<AdmittingSimulation<Flag::overlap_left>>("overlap_left"),
      dubious_adapter<AdmittingSimulation<Flag::contacts_dropped>>("contacts_dropped"),
      dubious_adapter<ExplodingSimulation>("exploder")};
  catalogues.known_engines.clear();
  for (const Adapter& adapter : catalogues.adapters) {
    catalogues.known_engines.push_back(adapter.name);
  }
  for (const MetricInfo& metric : metrics()) {
    if (metric.name == "validity" || metric.name == "contacts") {
      catalogues.metrics.push_back(metric);
    }
  }
  return catalogues;
}

}  // namespace brickbench::testing
