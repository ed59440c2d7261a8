#include "experiments/regression/observe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace brickbench::gate {
namespace {

std::string axes_of(const Row& row) {
  return "step_s=" + shortest(row.step_s) + (row.axes.empty() ? "" : ';' + row.axes);
}

// What an engine counts within itself is no behaviour, and the flags stand with every record.
bool is_talk(const Row& row) { return row.metric.starts_with("diag_") || row.group == "validity"; }

Record record_of(const Row& row, Kind kind, const Machine& machine) {
  Record record;
  record.engine = row.engine + '/' + row.variant;
  record.axes = axes_of(row);
  record.kind = kind;
  if (kind != Kind::hash) {
    record.metric = row.metric;
    record.unit = row.unit;
    record.better = row.better;
  }
  record.engine_version = row.engine_version;
  record.precision = row.precision;
  record.platform = machine.architecture + ", " + machine.compiler + ", " + machine.flags;
  return record;
}

void add(Record& record, const Row& row) {
  if (!record.seeds.empty() && record.seeds.back() == row.seed) return;  // a hash, once per cell
  const bool ok = row.outcome == "ok" && (record.kind == Kind::hash || row.value.has_value());
  // Infinity has no place among numbers that are subtracted: it is an outcome.
  const bool infinite = ok && record.kind != Kind::hash && !std::isfinite(*row.value);
  const std::string outcome = infinite ? "infinite" : ok ? "ok" : row.outcome;
  if (record.outcome == "ok" && outcome != "ok") {
    record.outcome = outcome;
    record.values.clear();
    record.hashes.clear();
  }
  if (record.validity->empty()) record.validity = row.validity;
  record.seeds.push_back(row.seed);
  if (record.outcome != "ok") return;
  if (record.kind == Kind::hash) {
    record.hashes.push_back(row.state_hash);
  } else {
    record.values.push_back(*row.value);
  }
}

void justify(Record& record) {
  if (record.values.empty()) return;
  const double mean = std::accumulate(record.values.begin(), record.values.end(), 0.0) /
                      static_cast<double>(record.values.size());
  double largest = 0.0;
  for (const double value : record.values) {
    record.residual = std::max(record.residual, std::abs(value - record.values[0]));
    largest = std::max(largest, std::abs(value));
  }
  if (record.kind == Kind::bound) {
    record.bound = std::max(k_bound_multiple * record.residual, k_bound_share * largest);
    record.why = fmt::format(
        "bound = max({} x residual, {} x |value|); residual = largest change over {} starts that "
        "differ by rounding-sized amounts",
        k_bound_multiple, k_bound_share, record.values.size());
  } else if (record.kind == Kind::distribution) {
    record.margin = k_margin_share * std::abs(mean);
    record.why = fmt::format("margin = {} x |mean| of {} perturbed starts", k_margin_share,
                             record.values.size());
  }
}

}  // namespace

Kind kind_for(std::size_t seeds) {
  if (seeds >= k_ensemble_seeds) return Kind::distribution;
  return seeds == 1 ? Kind::hash : Kind::bound;
}

Suite observe(const std::vector<Row>& rows,
              const std::vector<std::pair<std::string, std::size_t>>& seed_counts,
              const Machine& machine) {
  Suite suite;
  for (const auto& [name, seeds] : seed_counts) {
    const Kind kind = kind_for(seeds);
    std::map<std::string, Record> records;
    for (const Row& row : rows) {
      if (row.experiment != name || row.outcome == "excluded" || is_talk(row)) continue;
      const Record fresh = record_of(row, kind, machine);
      add(records.try_emplace(fresh.key(), fresh).first->second, row);
    }
    Suite::Experiment experiment{name, {}};
    for (auto& [key, record] : records) {
      if (record.kind == Kind::hash) {
        record.why = "all states, bit for bit, of one start";
      } else {
        justify(record);
      }
      experiment.records.push_back(std::move(record));
    }
    suite.experiments.push_back(std::move(experiment));
  }
  return suite;
}

}  // namespace brickbench::gate
