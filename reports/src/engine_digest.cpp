#include "reports/src/engine_digest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "adapters/seam/unit.hpp"
#include "reports/src/flags.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_engines_named = 4;

struct LawNumber {
  std::string_view share_metric;  // judged; for overlap and passage empty
  std::string_view value_metric;  // told
  Law law;
};
constexpr std::array<LawNumber, 3> k_law_numbers = {
    LawNumber{"energy_created_relative", "energy_created_j", Law::energy},
    LawNumber{"linear_momentum_error_relative", "linear_momentum_error_ns", Law::momentum},
    LawNumber{"", "penetration_max_m", Law::overlap}};

// The numbers of one cell that laws are judged by.
struct CellNumbers {
  const Row* first = nullptr;
  std::map<std::string, const Row*> numbers;
};

std::optional<double> cell_number(const CellNumbers& cell, std::string_view metric) {
  const auto found = cell.numbers.find(std::string(metric));
  return found == cell.numbers.end() ? std::nullopt : found->second->value;
}

void note(EngineDigest& engine, Law law, double share, double value, const Row& row,
          const std::string& unit) {
  auto breach = std::ranges::find(engine.breaches, law, &Breach::law);
  if (breach == engine.breaches.end()) {
    engine.breaches.push_back({.law = law, .share = -1.0});
    breach = std::prev(engine.breaches.end());
  }
  ++breach->cells;
  if (share <= breach->share) return;
  breach->share = share;
  breach->value = value;
  breach->unit = unit;
  breach->where = row.experiment;
}

void greatest(std::optional<double>& worst, std::optional<double> value) {
  if (value && (!worst || *value > *worst)) worst = value;
}

void judge_laws(EngineDigest& engine, const CellNumbers& cell,
                const std::map<std::string, double>& smallest_edge_m) {
  const Row& row = *cell.first;
  const auto edge = smallest_edge_m.find(row.cell);
  for (const LawNumber& number : k_law_numbers) {
    const auto value = cell_number(cell, number.value_metric);
    const bool is_overlap = number.law == Law::overlap;
    std::optional<double> share = cell_number(cell, number.share_metric);
    if (is_overlap && value && edge != smallest_edge_m.end()) share = *value / edge->second;
    if (!share || *share <= (is_overlap ? k_overlap_share : k_law_share)) continue;
    const auto told = cell.numbers.find(std::string(number.value_metric));
    note(engine, number.law, *share, value.value_or(std::nan("")), row,
         value ? told->second->unit : "");
  }
  const auto words = flag_words(row.validity);
  if (std::ranges::count(words, "tunnelled") > 0) note(engine, Law::passage, 1.0, 0.0, row, "");
  greatest(engine.energy_share, cell_number(cell, "energy_created_relative"));
  greatest(engine.overlap_m, cell_number(cell, "penetration_max_m"));
}

std::string_view law_words(Law law) {
  switch (law) {
    case Law::energy:
      return "Energy out of nothing";
    case Law::momentum:
      return "Momentum without a force";
    case Law::overlap:
      return "Bodies inside each other";
    case Law::passage:
      return "Bodies through each other";
  }
  return "";
}

std::string_view short_word(Law law) {
  switch (law) {
    case Law::energy:
      return "energy";
    case Law::momentum:
      return "momentum";
    case Law::overlap:
      return "overlap";
    case Law::passage:
      return "passage";
  }
  return "";
}

std::string length_text(double value_m) { return fmt::format("{:.3g} mm", 1e3 * value_m); }

std::string breach_text(const EngineDigest& engine, const Breach& breach) {
  const std::string cells =
      engine.ran > 1 ? fmt::format(", {} of {} cells", breach.cells, engine.ran) : "";
  switch (breach.law) {
    case Law::energy:
    case Law::momentum:
      if (std::isnan(breach.value)) {
        return fmt::format("{} {:.2g} %{}", engine.label, 100.0 * breach.share, cells);
      }
      return fmt::format("{} {:.3g}{} ({:.2g} %{})", engine.label, breach.value,
                         unit_suffix(breach.unit), 100.0 * breach.share, cells);
    case Law::overlap:
      return fmt::format("{} {}{}", engine.label, length_text(breach.value),
                         cells.empty() ? "" : fmt::format(" ({})", cells.substr(2)));
    case Law::passage:
      return fmt::format("{}{}", engine.label,
                         cells.empty() ? "" : fmt::format(" ({})", cells.substr(2)));
  }
  return "";
}

}  // namespace

std::optional<double> EngineDigest::cost() const {
  if (simulated_s <= 0.0) return std::nullopt;
  return cpu_s / simulated_s;
}

std::vector<EngineDigest> engine_digests(std::span<const Row> rows, std::span<const Timing> timings,
                                         const std::map<std::string, double>& smallest_edge_m) {
  std::vector<std::string> order;
  std::map<std::string, CellNumbers> cells;
  for (const Row& row : rows) {
    CellNumbers& cell = cells[row.cell];
    if (cell.first == nullptr) {
      cell.first = &row;
      order.push_back(row.cell);
    }
    cell.numbers.emplace(row.metric, &row);
  }
  std::vector<EngineDigest> engines;
  const auto engine_of = [&](const std::string& label) -> EngineDigest& {
    const auto found = std::ranges::find(engines, label, &EngineDigest::label);
    if (found != engines.end()) return *found;
    engines.push_back({.label = label});
    return engines.back();
  };
  for (const std::string& id : order) {
    const CellNumbers& cell = cells.at(id);
    const Row& row = *cell.first;
    if (row.outcome == "excluded") continue;
    EngineDigest& engine = engine_of(row.engine + '/' + row.variant);
    ++engine.cells;
    engine.refused += row.outcome == "refused" ? 1U : 0U;
    if (row.state_hash.empty()) continue;
    ++engine.ran;
    engine.flagged += row.validity.empty() ? 0U : 1U;
    judge_laws(engine, cell, smallest_edge_m);
  }
  for (const Timing& timing : timings) {
    const auto cell = cells.find(timing.cell);
    if (timing.outcome != "ok" || !timing.validity.empty() || timing.steps == 0) continue;
    if (cell == cells.end()) continue;
    EngineDigest& engine = engine_of(timing.engine + '/' + timing.variant);
    engine.cpu_s += timing.steps_total_cpu_s;
    engine.simulated_s += static_cast<double>(timing.steps) * timing.step_s;
  }
  std::ranges::stable_sort(engines, {}, [](const EngineDigest& engine) {
    return engine.cost().value_or(std::numeric_limits<double>::infinity());
  });
  return engines;
}

Table engine_table(std::span<const EngineDigest> engines, std::size_t most) {
  Table table;
  table.header = {"engine", "ran", "CPU ms per s", "energy made", "overlap", "broke"};
  for (const EngineDigest& engine : engines.first(std::min(most, engines.size()))) {
    std::string broke;
    for (const Breach& breach : engine.breaches) {
      broke += fmt::format("{}{}", broke.empty() ? "" : ", ", short_word(breach.law));
    }
    const auto cost = engine.cost();
    const auto share = engine.energy_share;
    table.rows.push_back(
        {{engine.label},
         {fmt::format("{} of {}{}", engine.ran, engine.cells,
                      engine.flagged > 0 ? fmt::format(", {} !", engine.flagged) : "")},
         {cost ? fmt::format("{:.3g}", 1e3 * *cost) : "-"},
         {share ? fmt::format("{:.2g} %", 100.0 * *share) : "-"},
         {engine.overlap_m ? length_text(*engine.overlap_m) : "-"},
         {engine.ran == 0 ? "-"
          : broke.empty() ? "nothing"
                          : broke,
          broke.empty() ? Mark::plain : Mark::worst}});
  }
  return table;
}

std::vector<std::string> breach_lines(std::span<const EngineDigest> engines) {
  std::vector<std::string> lines;
  for (const Law law : {Law::energy, Law::momentum, Law::overlap, Law::passage}) {
    std::vector<std::pair<double, std::string>> who;
    for (const EngineDigest& engine : engines) {
      const auto breach = std::ranges::find(engine.breaches, law, &Breach::law);
      if (breach == engine.breaches.end()) continue;
      who.emplace_back(breach->share, breach_text(engine, *breach));
    }
    if (who.empty()) continue;
    std::ranges::stable_sort(who, std::greater{}, [](const auto& entry) { return entry.first; });
    std::string line = fmt::format("{}: ", law_words(law));
    for (std::size_t i = 0; i < std::min(who.size(), k_engines_named); ++i) {
      line += (i == 0 ? "" : "; ") + who[i].second;
    }
    if (who.size() > k_engines_named) {
      line += fmt::format("; and {} more", who.size() - k_engines_named);
    }
    lines.push_back(line + '.');
  }
  if (lines.empty() && std::ranges::any_of(engines, [](const auto& e) { return e.ran > 0; })) {
    lines.emplace_back("Nobody broke a law that these numbers show.");
  }
  return lines;
}

std::string fastest_line(std::span<const EngineDigest> engines) {
  const auto timed = [](const EngineDigest& engine) { return engine.cost().has_value(); };
  const auto lawful = [&](const EngineDigest& engine) {
    return timed(engine) && engine.breaches.empty();
  };
  const auto fastest = std::ranges::find_if(engines, timed);
  if (fastest == engines.end()) return "";
  const auto told = [](const EngineDigest& engine) {
    return fmt::format(
        "{} ({:.3g} ms of CPU per simulated s{}{})", engine.label, 1e3 * engine.cost().value(),
        engine.overlap_m ? ", overlap up to " + length_text(*engine.overlap_m) : "",
        engine.ran < engine.cells ? fmt::format(", {} of {} cells", engine.ran, engine.cells) : "");
  };
  const auto honest = std::ranges::find_if(engines, lawful);
  if (honest == fastest) return fmt::format("Fastest, and it broke no law: {}.", told(*fastest));
  if (honest == engines.end()) {
    return fmt::format("Fastest: {}; every engine that was timed broke a law.", told(*fastest));
  }
  return fmt::format("Fastest: {}. Fastest that broke no law: {}.", told(*fastest), told(*honest));
}

std::vector<std::string> ending_lines(std::span<const Row> rows, std::size_t most) {
  struct Ending {
    std::string engine, outcome, first;
    std::size_t cells = 0;
  };
  std::vector<Ending> endings;
  std::set<std::string> seen;
  for (const Row& row : rows) {
    const bool is_flagged = !row.state_hash.empty() && !row.validity.empty();
    if ((!row.state_hash.empty() && !is_flagged) || row.outcome == "excluded") continue;
    if (!seen.insert(row.cell).second) continue;
    const std::string outcome = is_flagged ? "is flagged (!)" : row.outcome;
    const std::string& why = is_flagged ? row.validity : row.reason;
    const std::string label = row.engine + '/' + row.variant;
    auto ending = std::ranges::find_if(endings, [&](const Ending& known) {
      return known.engine == label && known.outcome == outcome;
    });
    if (ending == endings.end()) {
      endings.push_back({label, outcome, fmt::format("{}: {}", row.experiment, why)});
      ending = std::prev(endings.end());
    }
    ++ending->cells;
  }
  // Refusals are answers; what failed comes first.
  std::ranges::stable_partition(endings, [](const Ending& e) { return e.outcome != "refused"; });
  std::vector<std::string> lines;
  for (const Ending& ending : endings) {
    if (lines.size() == most) {
      lines.back() += fmt::format(" ... and {} more kinds of ending", endings.size() - most);
      break;
    }
    lines.push_back(fmt::format("{} {} in {} cell{}, {}{}", ending.engine, ending.outcome,
                                ending.cells, ending.cells == 1 ? "" : "s",
                                ending.cells == 1 ? "" : "the first ", ending.first));
  }
  return lines;
}

}  // namespace brickbench
