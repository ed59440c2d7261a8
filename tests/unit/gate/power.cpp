// Measures the gate itself: how often a suite is red when nothing changed, and how often when a
// known fault was seeded. gate_power PLAN ENGINE TRIALS PAIRS prints one Markdown row per fault.
//
// Each trial has starts of its own. False alarms are counted between two trials of the same engine,
// each used once, whose starts are independent: nothing is identical, and only the statistics
// decide. Only the ensembles are run and judged: hashes and bounds would show any change. Halved
// are the library's own iterations: measure the variant that has them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
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

double binomial_cdf(std::size_t k, std::size_t n, double p) {
  double sum = 0.0;
  for (std::size_t i = 0; i <= k; ++i) {
    const auto x = static_cast<double>(i);
    const auto count = static_cast<double>(n);
    sum += std::exp(std::lgamma(count + 1.0) - std::lgamma(x + 1.0) - std::lgamma(count - x + 1.0) +
                    x * std::log(p) + (count - x) * std::log1p(-p));
  }
  return sum;
}

// Clopper and Pearson, Biometrika 26 (1934): the p at which at most k of n have probability `tail`.
double upper_limit(std::size_t k, std::size_t n, double tail) {
  if (k >= n) return 1.0;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (binomial_cdf(k, n, middle) > tail ? low : high) = middle;
  }
  return high;
}

struct Count {
  std::size_t red = 0;
  std::size_t trials = 0;
  std::map<std::string, std::size_t> named;  // as the worst offender of a trial

  void add(const std::vector<Comparison>& comparisons) {
    ++trials;
    if (comparisons.empty() || !is_red(comparisons.front())) return;  // worst first
    ++red;
    ++named[comparisons.front().experiment + ": " + comparisons.front().obtained.metric];
  }
  std::string most_named() const {
    const auto most =
        std::ranges::max_element(named, {}, [](const auto& entry) { return entry.second; });
    return most == named.end() ? "-" : fmt::format("{} ({})", most->first, most->second);
  }
};

double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// One-sided 95 % limits: false alarms from above, power from below.
void print(const std::string& engine, const std::string& fault, const Count& count, double cpu,
           bool is_fault) {
  const double limit = is_fault ? 1.0 - upper_limit(count.trials - count.red, count.trials, 0.05)
                                : upper_limit(count.red, count.trials, 0.05);
  fmt::print("| {} | {} | {} of {} | {} {:.1f} % | {} | {:.2f} |\n", engine, fault, count.red,
             count.trials, is_fault ? ">=" : "<=", 100.0 * limit, count.most_named(),
             cpu / static_cast<double>(count.trials));
  std::cout << std::flush;
}

void measure(const Bench& bench, const std::string& engine, std::uint64_t trials,
             std::uint64_t pairs) {
  const auto indices = std::make_index_sequence<k_scenarios>();
  const ComparePlan how{.sequential = {.looks = 3}};
  Count calm;
  double start = cpu_s();
  std::vector<Suite> sound;
  for (std::uint64_t n = 0; n < pairs; ++n) {
    Suite one = bench.run(scenarios(), 2 * n, 1.0);
    Suite other = bench.run(scenarios(), 2 * n + 1, 1.0);
    calm.add(compare(one, other, how, true));
    if (sound.size() < trials) sound.push_back(std::move(one));
    if (sound.size() < trials) sound.push_back(std::move(other));
  }
  print(engine, "nothing (independent starts)", calm, cpu_s() - start, false);
  while (sound.size() < trials) {
    sound.push_back(bench.run(scenarios(), sound.size(), 1.0));
  }
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
    Count count;
    start = cpu_s();
    for (std::uint64_t t = 0; t < trials; ++t) {
      // The starts of the reference are those of the trial: common random numbers.
      const Suite faulty = bench.run(fault.scenarios, t, fault.iterations);
      count.add(compare(sound[t], faulty, how, true));
    }
    print(engine, fault.name, count, cpu_s() - start, true);
  }
}

int run(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "gate_power PLAN ENGINE TRIALS PAIRS\n";
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
    if (kind_for(experiment.seeds.size()) != Kind::distribution) {
      std::erase_if(bench.cells, [&](const Cell& c) { return c.experiment == experiment.name; });
      continue;
    }
    bench.seeds.emplace_back(experiment.name, experiment.seeds.size());
  }
  measure(bench, argv[2], std::strtoull(argv[3], nullptr, 10), std::strtoull(argv[4], nullptr, 10));
  return 0;
}

}  // namespace
}  // namespace brickbench::gate

int main(int argc, char** argv) { return brickbench::gate::run(argc, argv); }
