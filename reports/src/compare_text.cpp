#include <fmt/format.h>

#include "reports/src/compare.hpp"
#include "reports/src/html_sections.hpp"
#include "reports/src/markup.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_rows_in_documents = 200;

std::string value_text(const std::optional<double>& value) {
  return value ? short_number(*value) : "-";
}

std::string percent(double relative) {
  return relative < 1e-4 ? fmt::format("{:.1e}", relative)
                         : fmt::format("{:.3g} %", 100.0 * relative);
}

std::vector<TableCell> row_of(const Change& change) {
  const bool outcome = change.kind == ChangeKind::outcome;
  const Mark mark = change.worse ? Mark::worst : Mark::plain;
  return {{change.engine},
          {change.scene},
          {change.number},
          {outcome ? change.words : value_text(change.before)},
          {outcome ? "" : value_text(change.after), mark},
          {outcome ? "outcome" : percent(change.relative)},
          {outcome ? "" : percent(change.noise)}};
}

std::string list_text(const std::string& title, const std::vector<std::string>& items,
                      const char* bullet) {
  if (items.empty()) return "";
  std::string out = title + "\n\n";
  for (const std::string& item : items) out += bullet + item + '\n';
  return out + '\n';
}

std::string html_list(const std::vector<std::string>& items) {
  std::string out;
  for (const std::string& item : items) out += fmt::format("<li>{}</li>\n", escape_markup(item));
  return out.empty() ? "" : "<ul>\n" + out + "</ul>\n";
}

}  // namespace

std::string headline(const FolderComparison& comparison) {
  const std::size_t apart = comparison.flagged + comparison.without_number;
  if (comparison.compared + apart == 0) return "The two folders share no cell.";
  const std::string not_compared =
      apart == 0 ? ""
                 : fmt::format("; {} could not be compared ({} flagged, {} without a number)",
                               apart, comparison.flagged, comparison.without_number);
  const std::string share = fmt::format("{} of {} numbers are identical{}", comparison.same,
                                        comparison.compared, not_compared);
  if (comparison.compared == 0 && comparison.beyond_noise == 0) {
    return fmt::format(
        "Nothing could be compared: of {} numbers {} are flagged and {} have no "
        "value.",
        apart, comparison.flagged, comparison.without_number);
  }
  if (comparison.same == comparison.compared && comparison.only_in_a.empty() &&
      comparison.only_in_b.empty()) {
    return fmt::format("No change: {}.", share);
  }
  if (comparison.beyond_noise == 0) return fmt::format("No change beyond noise: {}.", share);
  std::string line =
      fmt::format("{} numbers changed beyond noise; {}.", comparison.beyond_noise, share);
  const Change& first = comparison.changes.front();
  if (first.kind == ChangeKind::outcome) {
    line += fmt::format(" First: {} of {}, {}.", first.number, first.engine, first.words);
  } else {
    line += fmt::format(" The largest: {} of {}, {} -> {} ({}).", first.number, first.engine,
                        value_text(first.before), value_text(first.after), percent(first.relative));
  }
  return line;
}

Table changes_table(const FolderComparison& comparison, std::size_t rows) {
  Table table;
  table.header = {"engine", "scene", "number", "before", "after", "change", "noise"};
  for (const Change& change : comparison.changes) {
    if (change.kind == ChangeKind::within_noise || table.rows.size() == rows) break;
    table.rows.push_back(row_of(change));
  }
  return table;
}

Table timings_table(const FolderComparison& comparison) {
  Table table;
  table.header = {"engine", "experiment", "number", "before", "after", "change", "noise"};
  for (const Change& change : comparison.timings) table.rows.push_back(row_of(change));
  return table;
}

std::string compare_markdown(const FolderComparison& comparison, const std::string& a,
                             const std::string& b) {
  std::string out = fmt::format("# {} -> {}\n\n{}\n\n", a, b, headline(comparison));
  out += list_text("What differs between the two:", comparison.facts, "- ");
  const Table changes = changes_table(comparison, k_rows_in_documents);
  if (!changes.rows.empty()) {
    out += fmt::format("## Beyond noise\n\n{} of {} shown.\n\n{}\n", changes.rows.size(),
                       comparison.beyond_noise, to_markdown(changes));
  }
  const Table timings = timings_table(comparison);
  if (!timings.rows.empty()) {
    out += fmt::format("## CPU time per step, by more than {:.0f} %\n\n{}\n",
                       100.0 * k_timing_noise_relative, to_markdown(timings));
  }
  out += list_text("Times that are not compared:", comparison.untimed, "- ");
  out += list_text("Only in the first:", comparison.only_in_a, "- ");
  out += list_text("Only in the second:", comparison.only_in_b, "- ");
  return out;
}

std::string compare_html(const FolderComparison& comparison, const std::string& a,
                         const std::string& b) {
  const Palette palette;
  std::string out = fmt::format("<header><h1>{} \xE2\x86\x92 {}</h1></header>\n", escape_markup(a),
                                escape_markup(b));
  out += html_section("verdict", "Verdict",
                      "<p><strong>" + escape_markup(headline(comparison)) + "</strong></p>\n");
  out += html_section("facts", "What differs between the two", html_list(comparison.facts));
  const Table changes = changes_table(comparison, k_rows_in_documents);
  if (!changes.rows.empty()) {
    out += html_section(
        "changes", "Beyond noise",
        fmt::format("<p>{} of {} shown.</p>\n", changes.rows.size(), comparison.beyond_noise) +
            html_table(changes, palette));
  }
  const Table timings = timings_table(comparison);
  if (!timings.rows.empty()) {
    out += html_section("timings", "CPU time per step", html_table(timings, palette));
  }
  out += html_section("untimed", "Times that are not compared", html_list(comparison.untimed));
  out += html_section("only-a", "Only in the first", html_list(comparison.only_in_a));
  return out + html_section("only-b", "Only in the second", html_list(comparison.only_in_b));
}

}  // namespace brickbench
