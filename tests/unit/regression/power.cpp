// Measures the gate itself: how often a suite is red when nothing changed, and how often when a
// known fault was seeded. Both print Markdown rows.
//
// gate_power faults PLAN ENGINE TRIALS SEED: one row per fault. Each trial has starts of its own,
// numbered from SEED on; reference and candidate of a trial have the same starts, as in a check.
// Halved are the iterations that the engine has without being asked, or its sub-steps; engines
// without such a knob have no such row.
//
// gate_power alarms PLAN ENGINE STARTS TRIALS SEED: one row. STARTS runs of each ensemble are
// recorded; each trial draws from them, without replacement, the starts of a reference and others
// of a candidate, and looks at them in growing samples as a check does. Nothing is identical: only
// the statistics decide.
//
// Only the ensembles are run and judged: hashes and bounds would show any change.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "adapters/catalog.hpp"
#include "experiments/regression/check.hpp"
#include "experiments/regression/observe.hpp"
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

// What `share` of an engine's work sets: nothing if the knob is no measure of work, or if the
// variant does not take it.
std::optional<double> with_share_of_work(const Knob& knob, const EngineVariant& engine,
                                         double share) {
  if (knob.name.find("iterations") != std::string::npos) {
    return std::max(1.0, std::floor(share * knob.engine_default));
  }
  if (knob.name == "substep_s" && engine.variant == "fast") return knob.engine_default / share;
  return std::nullopt;
}

struct Bench {
  Catalogues catalogues;
  Plan plan;
  std::vector<Cell> cells;
  std::vector<std::pair<std::string, std::size_t>> seeds;

  void expand_ensembles() {
    cells = expand(plan, catalogues).value();
    seeds.clear();
    for (const Experiment& experiment : plan.experiments) {
      seeds.emplace_back(experiment.name, experiment.seeds.size());
    }
  }

  // The suite's numbers from the starts of this trial, 1000 of which are set apart for each.
  Suite run(const std::vector<Scenario>& scenarios_in, std::uint64_t trial, double work) const {
    Catalogues with = catalogues;
    with.scenarios = scenarios_in;
    std::vector<Cell> batch = cells;
    for (Cell& cell : batch) {
      cell.seed += 1000 * trial;
      for (const Knob& knob : find_adapter(catalogues, cell.engine.engine)->knobs) {
        const auto value = with_share_of_work(knob, cell.engine, work);
        if (work != 1.0 && value) cell.knobs[knob.name] = *value;
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

bool can_work_less(const Bench& bench) {
  return std::ranges::any_of(bench.cells, [&](const Cell& cell) {
    return std::ranges::any_of(
        find_adapter(bench.catalogues, cell.engine.engine)->knobs,
        [&](const Knob& knob) { return with_share_of_work(knob, cell.engine, 0.5).has_value(); });
  });
}

void measure_faults(const Bench& bench, const std::string& engine, std::uint64_t trials,
                    std::uint64_t seed) {
  const auto indices = std::make_index_sequence<k_scenarios>();
  const ComparePlan how;
  std::vector<Suite> sound;
  while (sound.size() < trials) sound.push_back(bench.run(scenarios(), seed + sound.size(), 1.0));
  struct Seeded {
    const char* name;
    std::vector<Scenario> scenarios;
    double work;
  };
  std::vector<Seeded> faults = {{"friction -5 %", wrap<Fault::friction>(indices), 1.0},
                                {"gravity +1 %", wrap<Fault::gravity>(indices), 1.0},
                                {"restitution +0.05", wrap<Fault::restitution>(indices), 1.0}};
  if (can_work_less(bench)) faults.push_back({"iterations or sub-steps halved", scenarios(), 0.5});
  for (const Seeded& fault : faults) {
    Count count;
    const double start = cpu_s();
    for (std::uint64_t t = 0; t < trials; ++t) {
      // The starts of the reference are those of the trial: common random numbers.
      const Suite faulty = bench.run(fault.scenarios, seed + t, fault.work);
      count.add(compare(sound[t], faulty, how, true));
    }
    print(engine, fault.name, count, cpu_s() - start, true);
  }
}

// The recorded runs `from`, `from` + 1 ... of `order`, as many of each ensemble as `taken` says.
Suite drawn(const Suite& pool, const std::vector<std::size_t>& order, std::size_t from,
            const std::map<std::string, std::size_t>& taken) {
  Suite suite = pool;
  for (Suite::Experiment& experiment : suite.experiments) {
    for (Record& record : experiment.records) {
      const std::size_t count =
          taken.at(experiment.name + '|' + record.engine + '|' + record.axes + '|');
      std::vector<double> values;
      std::vector<std::uint64_t> seeds;
      for (std::size_t i = 0; i < count && i < record.values.size(); ++i) {
        values.push_back(record.values[order[from + i]]);
        seeds.push_back(i + 1);
      }
      record.values = std::move(values);
      record.seeds = std::move(seeds);
    }
  }
  return suite;
}

// As check(): looks at growing samples until every number is decided.
std::vector<Comparison> check_drawn(const Suite& pool, const std::vector<std::size_t>& order,
                                    const std::map<std::string, std::size_t>& full) {
  const ComparePlan how;
  std::vector<std::size_t> looks = how.looks;
  looks.push_back(SIZE_MAX);
  std::size_t most = 0;
  for (const auto& [group, count] : full) most = std::max(most, count);
  const Suite reference = drawn(pool, order, 0, full);
  std::map<std::string, std::size_t> taken;
  for (const auto& [group, count] : full) taken[group] = std::min(count, looks[0]);
  for (std::size_t look = 0;; ++look) {
    auto comparisons = compare(reference, drawn(pool, order, most, taken), how, true);
    const auto open = undecided(comparisons);
    if (open.empty() || look + 1 == looks.size()) return comparisons;
    for (const std::string& group : open) {
      taken[group] = std::min(full.at(group), looks[look + 1]);
    }
  }
}

// Ensembles that an engine refuses have no numbers: check() compares their outcome alone.
void drop_refused(Suite& pool) {
  for (Suite::Experiment& experiment : pool.experiments) {
    std::erase_if(experiment.records, [](const Record& record) {
      return record.outcome == "refused" && record.values.empty();
    });
  }
}

// Whether every start of every ensemble yielded every number.
bool is_whole(const Suite& pool, std::size_t starts) {
  for (const Suite::Experiment& experiment : pool.experiments) {
    for (const Record& record : experiment.records) {
      if (record.outcome == "ok" && record.values.size() == starts) continue;
      std::cerr << experiment.name << ' ' << record.key() << ": " << record.values.size() << " of "
                << starts << " starts, " << record.outcome << '\n';
      return false;
    }
  }
  return true;
}

int measure_alarms(Bench bench, const std::string& label, std::size_t starts, std::uint64_t trials,
                   std::uint64_t seed) {
  std::map<std::string, std::size_t> ensemble_size;
  for (Experiment& experiment : bench.plan.experiments) {
    ensemble_size[experiment.name] = experiment.seeds.size();
    experiment.seeds.resize(starts);
    std::iota(experiment.seeds.begin(), experiment.seeds.end(), 1000 * seed + 1);
  }
  bench.expand_ensembles();
  double start = cpu_s();
  const RunResult result = run_cells(bench.cells, bench.catalogues, {"", ""});
  Suite pool = observe(result.rows, bench.seeds, {});
  drop_refused(pool);
  if (!is_whole(pool, starts)) return 3;
  std::map<std::string, std::size_t> full;
  std::size_t numbers = 0;
  std::size_t most = 0;
  for (const Suite::Experiment& experiment : pool.experiments) {
    numbers += experiment.records.size();
    most = std::max(most, ensemble_size.at(experiment.name));
    for (const Record& record : experiment.records) {
      full[experiment.name + '|' + record.engine + '|' + record.axes + '|'] =
          ensemble_size.at(experiment.name);
    }
  }
  if (2 * most > starts) {
    std::cerr << "a trial needs " << 2 * most << " starts\n";
    return 2;
  }
  const double pool_cpu_s = cpu_s() - start;
  start = cpu_s();
  std::mt19937_64 random(seed);
  std::vector<std::size_t> order(starts);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Count calm;
  for (std::uint64_t t = 0; t < trials; ++t) {
    for (std::size_t i = 0; i < 2 * most; ++i) {
      std::swap(order[i], order[i + random() % (starts - i)]);
    }
    calm.add(check_drawn(pool, order, full));
  }
  fmt::print("| {} | {} | {} | {} of {} | <= {:.2f} % | {} | {:.0f} + {:.0f} |\n", label, numbers,
             starts, calm.red, calm.trials, 100.0 * upper_limit(calm.red, calm.trials, 0.05),
             calm.most_named(), pool_cpu_s, cpu_s() - start);
  return 0;
}

int run(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if ((mode != "faults" || argc != 6) && (mode != "alarms" || argc != 7)) {
    std::cerr << "gate_power faults PLAN ENGINE TRIALS SEED\n"
                 "gate_power alarms PLAN ENGINE STARTS TRIALS SEED\n";
    return 2;
  }
  Bench bench{{scenarios(), metrics(), adapters(), {}}, {}, {}, {}};
  for (const Adapter& adapter : bench.catalogues.adapters) {
    bench.catalogues.known_engines.push_back(adapter.name);
  }
  const std::string engine = argv[3];
  Overrides chosen;
  if (engine != "suite") chosen.engines = {engine};
  const auto plan = read_plan(argv[2], bench.catalogues, chosen);
  if (!plan) {
    std::cerr << plan.error().text() << '\n';
    return 2;
  }
  bench.plan = *plan;
  std::erase_if(bench.plan.experiments, [](const Experiment& experiment) {
    return kind_for(experiment.seeds.size()) != Kind::distribution;
  });
  bench.expand_ensembles();
  const auto number = [&](int i) { return std::strtoull(argv[i], nullptr, 10); };
  const std::string label =
      engine == "suite" ? "all of " + std::filesystem::path(argv[2]).stem().string() : engine;
  if (mode == "alarms") return measure_alarms(bench, label, number(4), number(5), number(6));
  measure_faults(bench, engine, number(4), number(5));
  return 0;
}

}  // namespace
}  // namespace brickbench::gate

int main(int argc, char** argv) { return brickbench::gate::run(argc, argv); }
