#include "reports/src/verdict.hpp"

#include <fmt/format.h>

#include <map>
#include <set>

#include "reports/src/losses.hpp"
#include "reports/src/validation.hpp"

namespace brickbench {
namespace {

std::string with_unit(double value, const std::string& unit) {
  return unit == "1" ? short_number(value) : short_number(value) + ' ' + unit;
}

void add_losses(const ReportSource& source, const std::vector<Block>& blocks,
                std::vector<std::string>& out) {
  const std::vector<std::string> own = own_engines(source.provenance);
  if (own.empty() || source.rows.empty()) return;
  const LossTable table = losses(blocks, own);
  if (table.compared == 0) {
    out.push_back("No number compares our own engine with another here.");
    return;
  }
  std::string line = fmt::format("Our own engine is beaten in {} of {} comparisons.",
                                 table.rows.size(), table.compared);
  if (!table.rows.empty()) {
    const Loss& worst = table.rows.front();
    line += fmt::format(" The widest: {} in {}, {} with {} against {} with {}.", worst.number,
                        worst.scene, worst.ours, short_number(worst.ours_value), worst.best,
                        short_number(worst.best_value));
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

void add_ranks(const std::vector<Block>& blocks, std::vector<std::string>& out) {
  std::vector<std::string> order;
  std::map<std::string, std::string> lines;
  for (const Block& block : blocks) {
    const Number* number = telling(block);
    if (number == nullptr) continue;
    const auto n = static_cast<std::size_t>(number - block.numbers.data());
    std::size_t have = 0;
    for (const auto& scores : block.scores) have += scores[n].median.has_value() ? 1 : 0;
    const std::string scene = scene_label(block);
    if (!lines.contains(scene)) order.push_back(scene);
    std::string& line = lines[scene];
    line +=
        fmt::format("{}{}: best {} ({}), worst {} ({}), of {} that have it",
                    line.empty() ? "" : "; ", number->name, block.contenders[*number->best].label(),
                    with_unit(*block.scores[*number->best][n].median, number->unit),
                    block.contenders[*number->worst].label(),
                    with_unit(*block.scores[*number->worst][n].median, number->unit), have);
  }
  for (const std::string& scene : order) out.push_back(scene + ". " + lines[scene] + '.');
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

void add_validation(const ReportSource& source, std::vector<std::string>& out) {
  if (source.validation.is_null()) return;
  const ValidationCount count = count_validation(source.validation);
  out.push_back(fmt::format(
      "Exact cases: {} of {} cells follow their engine's scheme within the bound, {} do not, {} "
      "failed, {} have no discrete prediction, {} were refused.",
      count.within, count.all, count.beyond, count.failed, count.open, count.refused));
}

}  // namespace

std::vector<std::string> verdict(const ReportSource& source, const std::vector<Block>& blocks) {
  std::vector<std::string> out;
  add_losses(source, blocks, out);
  add_ranks(blocks, out);
  add_unfinished(source, out);
  add_validation(source, out);
  return out;
}

}  // namespace brickbench
