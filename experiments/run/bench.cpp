#include "experiments/run/bench.hpp"

#include <algorithm>
#include <map>

namespace brickbench {
namespace {

// What one cell cost in each round; empty where it did not run to its end.
struct Costs {
  std::vector<std::optional<double>> per_simulated_s;
  std::vector<double> step_cpu_s;
};

bool same_scene(const Cell& a, const Cell& b) {
  return a.scenario == b.scenario && a.parameters == b.parameters && a.duration_s == b.duration_s &&
         a.seed == b.seed;
}

std::vector<BenchEntry> entries_of(const std::vector<Cell>& cells, const Selector& base,
                                   const Catalogues& catalogues) {
  const std::vector<EngineVariant> bases = select(base, catalogues);
  std::vector<BenchEntry> entries;
  std::vector<const Cell*> groups;
  std::vector<bool> has_base;
  for (const Cell& cell : cells) {
    BenchEntry entry;
    entry.cell = cell;
    entry.outcome = "ok";
    const auto found =
        std::ranges::find_if(groups, [&](const Cell* first) { return same_scene(*first, cell); });
    entry.group = static_cast<std::size_t>(found - groups.begin());
    if (found == groups.end()) {
      groups.push_back(&cell);
      has_base.push_back(false);
    }
    entry.is_base = cell.excluded_why.empty() && !has_base[entry.group] &&
                    std::ranges::find(bases, cell.engine) != bases.end();
    if (entry.is_base) has_base[entry.group] = true;
    entries.push_back(std::move(entry));
  }
  return entries;
}

CellOutcome outcome_of(const Cell& cell, const CellResult& done) {
  return {cell,         done.timing.cell,        done.outcome,
          done.reason,  done.timing.cell_wall_s, done.unrecorded,
          done.validity};
}

std::string hash_of(const std::vector<Row>& rows) {
  return rows.empty() ? std::string() : rows.front().state_hash;
}

void note_round(BenchEntry& entry, Costs& costs, const CellResult& done, bool first) {
  entry.id = done.timing.cell;
  if (entry.validity.empty()) entry.validity = done.validity;
  if (done.outcome != "ok") {
    if (entry.outcome == "ok") {
      entry.outcome = done.outcome;
      entry.reason = done.reason;
    }
    costs.per_simulated_s.emplace_back();
  } else {
    ++entry.rounds;
    costs.per_simulated_s.emplace_back(done.timing.steps_total_cpu_s / entry.cell.duration_s);
    costs.step_cpu_s.push_back(done.timing.step_median_cpu_s);
  }
  if (first)
    entry.rows = done.rows;
  else if (hash_of(done.rows) != hash_of(entry.rows))
    entry.repeatable = false;
}

std::optional<Spread> ratio_of(const Costs& costs, const Costs& base) {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < costs.per_simulated_s.size(); ++r) {
    const auto& own = costs.per_simulated_s[r];
    const auto& other = base.per_simulated_s[r];
    if (own && other && *other > 0.0) ratios.push_back(*own / *other);
  }
  if (ratios.empty()) return std::nullopt;
  return spread_of(std::move(ratios));
}

void summarize_costs(std::vector<BenchEntry>& entries, const std::vector<Costs>& costs) {
  std::map<std::size_t, std::size_t> base_of;  // group to entry
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].is_base) base_of[entries[i].group] = i;
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    std::vector<double> ran;
    for (const auto& cost : costs[i].per_simulated_s) {
      if (cost) ran.push_back(*cost);
    }
    if (ran.empty()) continue;
    entries[i].cost = spread_of(std::move(ran));
    entries[i].step_cpu_s = spread_of(costs[i].step_cpu_s);
    const auto base = base_of.find(entries[i].group);
    if (base == base_of.end() || !entries[i].validity.empty() ||
        !entries[base->second].validity.empty()) {
      continue;
    }
    entries[i].ratio = ratio_of(costs[i], costs[base->second]);
  }
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

BenchResult bench_cells(const std::vector<Cell>& cells, const Selector& base, std::size_t rounds,
                        const Catalogues& catalogues, const Origin& origin,
                        const RunCallbacks& callbacks) {
  BenchResult result;
  result.base = base;
  result.rounds = rounds;
  result.entries = entries_of(cells, base, catalogues);
  std::vector<Costs> costs(cells.size());
  std::size_t groups = 0;
  for (const BenchEntry& entry : result.entries) groups = std::max(groups, entry.group + 1);
  const std::size_t runs = cells.size() * rounds;
  for (std::size_t group = 0; group < groups; ++group) {
    for (std::size_t round = 0; round < rounds; ++round) {
      for (std::size_t i = 0; i < cells.size(); ++i) {
        BenchEntry& entry = result.entries[i];
        if (entry.group != group) continue;
        if (callbacks.cell_begins) callbacks.cell_begins(entry.cell, runs);
        CellResult done = run_cell(entry.cell, catalogues, origin, callbacks.after_step);
        note_round(entry, costs[i], done, round == 0);
        result.runs.cells.push_back(outcome_of(entry.cell, done));
        result.runs.timings.push_back(done.timing);
        note_method(result.runs, std::move(done.method));
        if (callbacks.cell_ends) callbacks.cell_ends(result.runs.cells.back(), runs);
        if (round != 0) continue;
        std::ranges::move(done.rows, std::back_inserter(result.runs.rows));
        std::ranges::move(done.series, std::back_inserter(result.runs.series));
      }
    }
  }
  summarize_costs(result.entries, costs);
  return result;
}

}  // namespace brickbench
