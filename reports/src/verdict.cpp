#include "reports/src/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "adapters/seam/unit.hpp"
#include "reports/src/losses.hpp"
#include "reports/src/validation.hpp"

namespace brickbench {
namespace {

std::string with_unit(double value, const std::string& unit) {
  return short_number(value) + unit_suffix(unit);
}

std::string kept_by_flags(const LossTable& table) {
  if (table.flagged == 0) return "";
  return fmt::format("; {} more are not made, because one side's numbers are flagged",
                     table.flagged);
}

void add_losses(const ReportSource& source, const std::vector<Block>& blocks,
                const SceneNames& names, std::vector<std::string>& out) {
  const std::vector<std::string> own = own_engines(source.provenance);
  if (own.empty() || source.rows.empty()) return;
  const LossTable table = losses(blocks, own);
  if (table.compared == 0) {
    out.push_back(fmt::format("No number compares our own engine with another here{}.",
                              kept_by_flags(table)));
    return;
  }
  std::string line = fmt::format("Our own engine is beaten in {} of {} comparisons{}.",
                                 table.rows.size(), table.compared, kept_by_flags(table));
  if (table.rounding > 0) {
    line += fmt::format(" In {} of them by rounding only (at most {} in SI units).", table.rounding,
                        k_rounding);
  }
  if (table.rows.size() > table.rounding) {
    const Loss& worst = table.rows.front();
    line += fmt::format(" The widest: {} in {}, {} with {} against {} with {}.", worst.number,
                        names.brief(worst.scene), worst.ours, short_number(worst.ours_value),
                        worst.best, short_number(worst.best_value));
  }
  out.push_back(line);
}

// The first number of a block that ranks engines and stands for its metric.
const Number* telling(const Block& block) {
  const Number* found = nullptr;
  for (const Number& number : block.numbers) {
    if (!number.best || !number.worst) continue;
    if (found == nullptr ||
        (number.name.ends_with("_relative") && !found->name.ends_with("_relative"))) {
      found = &number;
    }
  }
  return found;
}

// "bee/v" or "bee/v and 2 more".
template <typename Belongs>
std::string who(const Block& block, std::size_t first, const Belongs& belongs) {
  std::size_t more = 0;
  for (std::size_t c = 0; c < block.contenders.size(); ++c) more += belongs(c) ? 1U : 0U;
  const std::string label = block.contenders[first].label();
  return more <= 1 ? label : fmt::format("{} and {} more", label, more - 1);
}

std::size_t with_value(const Block& block, std::size_t n) {
  return static_cast<std::size_t>(std::ranges::count_if(
      block.scores, [n](const auto& scores) { return scores[n].is_valid(); }));
}

void add_unfinished(const ReportSource& source, std::vector<std::string>& out) {
  std::set<std::string> cells;
  std::set<std::string> whole;
  std::map<std::string, std::set<std::string>> others;
  for (const Row& row : source.rows) {
    cells.insert(row.cell);
    if (row.state_hash.empty())
      others[row.outcome].insert(row.cell);
    else
      whole.insert(row.cell);
  }
  if (cells.empty()) return;
  std::string line = fmt::format("{} of {} cells ran to their end", whole.size(), cells.size());
  for (const auto& [outcome, of] : others) line += fmt::format(", {} {}", of.size(), outcome);
  out.push_back(line + '.');
}

// Whose numbers are not to be trusted; they are shown and never ranked.
void add_flagged(const ReportSource& source, std::vector<std::string>& out) {
  std::map<std::string, std::set<std::string>> flagged;
  std::set<std::string> whole;
  std::set<std::string> all;
  for (const Row& row : source.rows) {
    if (row.state_hash.empty()) continue;
    whole.insert(row.cell);
    if (row.validity.empty()) continue;
    all.insert(row.cell);
    flagged[row.engine + '/' + row.variant].insert(row.cell);
  }
  if (all.empty()) return;
  std::string line = fmt::format(
      "{} of {} cells that ran to their end are flagged (!): their numbers are shown and not "
      "ranked, averaged or timed:",
      all.size(), whole.size());
  for (const auto& [engine, of] : flagged) {
    line += fmt::format("{} {} {}", line.ends_with(':') ? "" : ",", of.size(), engine);
  }
  out.push_back(line + '.');
}

void add_validation(const ReportSource& source, std::vector<std::string>& out) {
  if (source.validation.is_null()) return;
  const ValidationCount count = count_validation(source.validation);
  out.push_back(fmt::format(
      "Exact cases: {} of {} cells follow their engine's scheme within the bound, {} do not, {} "
      "failed, {} have no discrete prediction, {} were refused.",
      count.within, count.all, count.beyond, count.failed, count.open, count.refused));
}

}  // namespace

std::vector<std::string> verdict(const ReportSource& source, const std::vector<Block>& blocks,
                                 const SceneNames& names) {
  std::vector<std::string> out;
  add_losses(source, blocks, names, out);
  add_unfinished(source, out);
  add_flagged(source, out);
  add_validation(source, out);
  return out;
}

Table verdict_table(const ReportSource& source, const std::vector<Block>& blocks,
                    const SceneNames& names) {
  const std::vector<std::string> own = own_engines(source.provenance);
  Table table;
  table.header = {"scene", "number", "best", "worst", "our best", "have it"};
  for (const Block& block : blocks) {
    const Number* number = telling(block);
    if (number == nullptr) continue;
    const auto n = static_cast<std::size_t>(number - block.numbers.data());
    const auto value = [&](std::size_t c) {
      return with_unit(*block.scores[c][n].mean, number->unit);
    };
    const auto ours = best_of_own(block, n, own);
    table.rows.push_back(
        {{names.brief(scene_label(block))},
         {number->name},
         {fmt::format("{}: {}",
                      who(block, *number->best, [&](auto c) { return is_best(block, c, n); }),
                      value(*number->best)),
          Mark::best},
         {fmt::format("{}: {}",
                      who(block, *number->worst, [&](auto c) { return is_worst(block, c, n); }),
                      value(*number->worst)),
          Mark::worst},
         {ours ? fmt::format("{}: {}", block.contenders[*ours].label(), value(*ours)) : "-"},
         {fmt::format("{} of {}", with_value(block, n), block.contenders.size())}});
  }
  return table;
}

}  // namespace brickbench
