// Measures the gate itself: how often a suite is red when nothing changed, and how often when a
// known fault was seeded. gate_power PLAN ENGINE TRIALS prints one line per fault.
//
// Each trial has starts of its own. False alarms are counted between trials of the same engine,
// whose starts are independent: nothing is identical, and only the statistics decide.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <utility>

#include "adapters/catalog.hpp"
#include "experiments/gate/compare.hpp"
#include "experiments/gate/observe.hpp"
#include "experiments/run/run_plan.hpp"

namespace brickbench::gate {
namespace {

enum class Fault { none, friction, gravity, restitution };

void seed_fault(World& world, Fault fault) {
  if (fault == Fault::friction) {
    world.law.friction *= 0.95;
    for (PairLaw& pair : world.exceptions) pair.law.friction *= 0.95;
  }
  if (fault == Fault::gravity) world.gravity_mps2 *= 1.01;
  if (fault == Fault::restitution) {
    world.law.restitution += 0.05;
    for (PairLaw& pair : world.exceptions) pair.law.restitution += 0.05;
  }
}

template <std::size_t Index, Fault fault>
Expected<Scene> make_faulty(const ParameterValues& values) {
  auto scene = scenarios().at(Index).make(values);
  if (scene) seed_fault(scene->world, fault);
  return scene;
}

constexpr std::size_t k_scenarios = 32;  // at most

template <Fault fault, std::size_t... Index>
std::vector<Scenario> wrap(std::index_sequence<Index...>) {
  std::vector<Scenario> all = scenarios();
  const std::array<decltype(Scenario::make), sizeof...(Index)> makers = {
      make_faulty<Index, fault>...};
  for (std::size_t i = 0; i < all.size(); ++i) all[i].make = makers.at(i);
  return all;
}

struct Bench {
  Catalogues catalogues;
  Plan plan;
  std::vector<Cell> cells;
  std::vector<std::pair<std::string, std::size_t>> seeds;

  // The suite's numbers from the starts of this trial.
  Suite run(const std::vector<Scenario>& scenarios_in, std::uint64_t trial,
            double iterations) const {
    Catalogues with = catalogues;
    with.scenarios = scenarios_in;
    std::vector<Cell> batch = cells;
    for (Cell& cell : batch) {
      if (cell.seed != 0) cell.seed += 1000 * trial;
      for (const Knob& knob : find_adapter(catalogues, cell.engine.engine)->knobs) {
        if (iterations != 1.0 && knob.name.find("iterations") != std::string::npos) {
          cell.knobs[knob.name] = std::max(1.0, std::floor(iterations * knob.engine_default));
        }
      }
    }
    const RunResult result = run_cells(batch, with, {"", ""});
    Suite suite = observe(result.rows, seeds, {});
    for (auto& experiment : suite.experiments) {
      for (Record& record : experiment.records) {
        for (auto& seed : record.seeds) seed %= 1000;
      }
    }
    return suite;
  }
};

Suite ensembles_of(Suite suite) {
  for (auto& experiment : suite.experiments) {
    std::erase_if(experiment.records, [](const Record& r) { return r.kind != Kind::distribution; });
  }
  return suite;
}

void print(const std::string& what, const std::vector<std::vector<Comparison>>& trials) {
  std::size_t red = 0, numbers = 0, red_numbers = 0;
  std::map<std::string, std::size_t> named;
  for (const auto& trial : trials) {
    bool any = false;
    for (const Comparison& c : trial) {
      ++numbers;
      if (!is_red(c)) continue;
      any = true;
      ++red_numbers;
      ++named[c.experiment + ' ' + (c.obtained.metric.empty() ? "hash" : c.obtained.metric)];
    }
    red += any;
  }
  fmt::print("{:<28} red in {} of {} trials; {} of {} numbers;", what, red, trials.size(),
             red_numbers, numbers);
  std::vector<std::pair<std::size_t, std::string>> order;
  for (const auto& [name, count] : named) order.emplace_back(count, name);
  std::ranges::sort(order, std::greater<>());
  for (std::size_t i = 0; i < std::min<std::size_t>(3, order.size()); ++i) {
    fmt::print(" {} {}x;", order[i].second, order[i].first);
  }
  fmt::print("\n");
  std::cout << std::flush;
}

void measure(const Bench& bench, std::uint64_t trials) {
  const auto indices = std::make_index_sequence<k_scenarios>();
  const ComparePlan how{.sequential = {.looks = 3}};
  std::vector<Suite> sound;
  for (std::uint64_t t = 0; t < trials; ++t) sound.push_back(bench.run(scenarios(), t, 1.0));
  std::vector<std::vector<Comparison>> calm;
  for (std::size_t a = 0; a < sound.size(); ++a) {
    for (std::size_t b = a + 1; b < sound.size(); ++b) {
      calm.push_back(compare(ensembles_of(sound[a]), ensembles_of(sound[b]), how, true));
    }
  }
  print("nothing changed, ensembles", calm);
  struct Seeded {
    const char* name;
    std::vector<Scenario> scenarios;
    double iterations;
  };
  const std::vector<Seeded> faults = {{"friction -5 %", wrap<Fault::friction>(indices), 1.0},
                                      {"gravity +1 %", wrap<Fault::gravity>(indices), 1.0},
                                      {"restitution +0.05", wrap<Fault::restitution>(indices), 1.0},
                                      {"solver iterations halved", scenarios(), 0.5}};
  for (const Seeded& fault : faults) {
    std::vector<std::vector<Comparison>> whole, ensembles;
    for (std::uint64_t t = 0; t < trials; ++t) {
      const Suite obtained = bench.run(fault.scenarios, t, fault.iterations);
      whole.push_back(compare(sound[t], obtained, how, true));
      ensembles.push_back(compare(ensembles_of(sound[t]), ensembles_of(obtained), how, true));
    }
    print(fault.name, whole);
    print(std::string(fault.name) + ", ensembles", ensembles);
  }
}

int run(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "gate_power PLAN ENGINE TRIALS\n";
    return 2;
  }
  Bench bench{{scenarios(), metrics(), adapters(), {}}, {}, {}, {}};
  for (const Adapter& adapter : bench.catalogues.adapters) {
    bench.catalogues.known_engines.push_back(adapter.name);
  }
  const auto plan =
      read_plan(argv[1], bench.catalogues, {.set = {}, .engines = {argv[2]}, .only = {}});
  if (!plan) {
    std::cerr << plan.error().text() << '\n';
    return 2;
  }
  bench.plan = *plan;
  bench.cells = expand(*plan, bench.catalogues).value();
  for (const Experiment& experiment : plan->experiments) {
    bench.seeds.emplace_back(experiment.name, experiment.seeds.size());
  }
  measure(bench, std::strtoull(argv[3], nullptr, 10));
  return 0;
}

}  // namespace
}  // namespace brickbench::gate

int main(int argc, char** argv) { return brickbench::gate::run(argc, argv); }
