#include "reports/src/html_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "reports/src/flags.hpp"
#include "reports/src/losses.hpp"
#include "reports/src/markdown_report.hpp"
#include "reports/src/markup.hpp"
#include "reports/src/replay_source.hpp"
#include "reports/src/validation.hpp"
#include "reports/src/verdict.hpp"

namespace brickbench {
namespace {

constexpr const char* k_table_open = "<div class=\"scroll\"><table>\n";
constexpr const char* k_table_close = "</tbody></table></div>\n";

std::string swatch(const std::string& label, const Palette& palette) {
  const auto found = std::ranges::find(palette.labels(), label);
  if (found == palette.labels().end()) return "";
  const auto index = static_cast<std::size_t>(found - palette.labels().begin());
  return fmt::format("<i class=\"swatch\" style=\"background:{}\"></i>", palette_colour(index));
}

// Names up to this keep to one line; longer ones may break after an underscore.
constexpr std::size_t k_one_line = 20;

std::string breakable(const std::string& text) {
  if (text.size() <= k_one_line) return escape_markup(text);
  std::string out;
  for (const char c : escape_markup(text)) {
    out += c;
    if (c == '_') out += "<wbr>";
  }
  return out;
}

std::string header_row(const std::vector<std::string>& header) {
  std::string out = "<thead><tr>";
  for (const std::string& text : header) {
    out += fmt::format("<th scope=\"col\">{}</th>", breakable(text));
  }
  return out + "</tr></thead><tbody>\n";
}

// Cells longer than this are prose: they wrap, and stand at the left.
constexpr std::size_t k_prose = 40;

const char* class_of(const TableCell& cell) {
  switch (cell.mark) {
    case Mark::best:
      return " class=\"best\"";
    case Mark::worst:
      return " class=\"worst\"";
    case Mark::failed:
      return " class=\"failed\"";
    case Mark::flagged:
      return " class=\"flagged\"";
    case Mark::plain:
      return cell.text.size() > k_prose ? " class=\"text\"" : "";
  }
  return "";
}

// Whether every number of the row failed in the same words.
bool is_failed_row(const std::vector<TableCell>& row) {
  return row.size() > 2 && std::all_of(row.begin() + 1, row.end(), [&](const TableCell& cell) {
           return cell.mark == Mark::failed && cell.text == row[1].text;
         });
}

// A table of texts: all columns at the left, and rows of the same first text as one group.
std::string text_table(const Table& table, const Palette& palette) {
  std::string out = "<div class=\"scroll\"><table class=\"texts\">\n" + header_row(table.header);
  std::string before;
  for (const auto& row : table.rows) {
    const bool again = row[0].text == before;
    before = row[0].text;
    out += again ? "<tr>" : "<tr class=\"first\">";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string text = breakable(row[i].text);
      const std::string label = row[i].text.substr(0, row[i].text.find(": "));
      const std::string colour = swatch(label.substr(0, label.find(" and ")), palette);
      const char* width = row[i].text.size() <= k_one_line ? " class=\"tight\"" : "";
      out += i == 0 ? fmt::format("<th scope=\"row\"{}><span{}>{}{}</span></th>", width,
                                  again ? " class=\"again\"" : "", colour, text)
                    : fmt::format("<td{} data-label=\"{}\">{}{}</td>", class_of(row[i]),
                                  escape_markup(table.header[i]), colour, text);
    }
    out += "</tr>\n";
  }
  return out + k_table_close;
}

// What a cell of the validation matrix says, as a class of the style.
const char* verdict_class(const TableCell& cell) {
  if (cell.mark == Mark::failed) return "failed";
  if (cell.text.starts_with("open")) return "open";
  return cell.text.find(" / ") == std::string::npos ? "none" : "held";
}

// Many narrow columns: cells of two lines, heads that break after the engine.
std::string matrix_table(const Table& table, const Palette& palette) {
  std::string out = "<div class=\"scroll\"><table class=\"matrix\">\n<thead><tr>";
  for (const std::string& name : table.header) {
    std::string text = escape_markup(name);
    if (const std::size_t at = text.find('/'); at != std::string::npos)
      text.insert(at + 1, "<wbr>");
    out += fmt::format("<th scope=\"col\">{}{}</th>", swatch(name, palette), text);
  }
  out += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    out += fmt::format("<tr><th scope=\"row\">{}</th>", escape_markup(row[0].text));
    for (std::size_t i = 1; i < row.size(); ++i) {
      std::string text = escape_markup(row[i].text);
      if (const std::size_t at = text.find(" / "); at != std::string::npos) {
        text.insert(at + 2, "<br>");
      } else if (text.starts_with("open, error ")) {
        text.replace(4, 8, "<br>");
      }
      out += fmt::format("<td class=\"{}\">{}</td>", verdict_class(row[i]), text);
    }
    out += "</tr>\n";
  }
  return out + k_table_close;
}

std::string summary_details(const std::string& summary, const std::string& body, bool open) {
  return fmt::format("<details{}><summary>{}</summary>\n{}</details>\n", open ? " open" : "",
                     escape_markup(summary), body);
}

// Every number in which our own engines are beaten; the widest first.
std::string html_losses(const ReportSource& source, const std::vector<Block>& blocks,
                        const SceneNames& names, const Palette& palette) {
  const std::vector<std::string> own = own_engines(source.provenance);
  const LossTable lost = losses(blocks, own);
  if (lost.rows.empty()) return "";
  Table table;
  table.header = {"number", "scene", "ours", "best", "ours / best"};
  for (const Loss& loss : lost.rows) {
    table.rows.push_back({{loss.number},
                          {names.brief(loss.scene)},
                          {loss.ours + ": " + short_number(loss.ours_value)},
                          {loss.best + ": " + short_number(loss.best_value)},
                          {loss.rounding ? "rounding"
                           : loss.ratio  ? short_number(*loss.ratio)
                                         : "-"}});
  }
  return summary_details(fmt::format("Where our own engine is not the best: {} of {} comparisons",
                                     lost.rows.size(), lost.compared),
                         text_table(table, palette), lost.rows.size() <= 24);
}

// A cell that is no number of others: who, where, why, and the command that repeats it.
std::string cell_row(const Row& row, const std::string& why, const ReportSource& source,
                     const SceneNames& names) {
  const std::string repeat =
      row.outcome == "excluded" ? "" : reproduce_command(row, source.provenance);
  return fmt::format(
      "<tr><th scope=\"row\">{}</th><td class=\"text\">{}</td><td class=\"text\">{}</td>"
      "<td class=\"text\">{}</td></tr>\n",
      escape_markup(contender_of(row)), escape_markup(names.brief(scene_of(row))),
      escape_markup(why),
      repeat.empty() ? ""
                     : fmt::format("<details><summary>command</summary><code>{}</code></details>",
                                   escape_markup(repeat)));
}

// Of one contender.
struct CellCount {
  std::size_t ran = 0;
  std::size_t flagged = 0;
  std::size_t all = 0;
  std::string text() const {
    return fmt::format("{} of {}{}", ran, all, flagged > 0 ? fmt::format(", {} !", flagged) : "");
  }
};

}  // namespace

std::string html_section(const std::string& id, const std::string& title, const std::string& body) {
  if (body.empty()) return "";
  return fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", id, escape_markup(title),
                     body);
}

std::string html_table(const Table& table, const Palette& palette) {
  std::string out = k_table_open + header_row(table.header);
  for (const auto& row : table.rows) {
    out += "<tr>";
    const bool failed = is_failed_row(row);
    for (std::size_t i = 0; i < row.size() && (i < 2 || !failed); ++i) {
      const std::string text = escape_markup(row[i].text);
      if (i == 0)
        out += fmt::format("<th scope=\"row\">{}{}</th>", swatch(row[i].text, palette), text);
      else if (failed)
        out += fmt::format("<td class=\"failed all\" colspan=\"{}\">{}</td>", row.size() - 1, text);
      else
        out += fmt::format("<td{}>{}</td>", class_of(row[i]), text);
    }
    out += "</tr>\n";
  }
  return out + k_table_close;
}

std::string html_figure(const Figure& figure, bool draw_svg) {
  const std::string caption = fmt::format(
      "{}<a href=\"figures/{}.svg\">SVG</a> <a href=\"figures/{}.csv\">CSV</a>",
      figure.caption.empty() ? "" : escape_markup(figure.caption) + ' ', figure.id, figure.id);
  return fmt::format("<figure data-figure=\"{}\">{}<figcaption>{}</figcaption></figure>\n",
                     figure.id, draw_svg ? to_svg(figure, false) : "", caption);
}

std::string html_verdict(const ReportSource& source, const std::vector<Block>& blocks,
                         const SceneNames& names, const Palette& palette) {
  std::string out = "<ul class=\"verdict\">\n";
  for (const std::string& line : verdict(source, blocks, names)) {
    out += fmt::format("<li>{}</li>\n", escape_markup(line));
  }
  out += "</ul>\n" + html_losses(source, blocks, names, palette);
  const Table table = verdict_table(source, blocks, names);
  if (table.rows.empty()) return out;
  return out + "<h4>Best and worst of each scene</h4>\n" + text_table(table, palette);
}

std::string html_scene_tables(const std::vector<Block>& blocks, const SceneNames& names,
                              const Palette& palette) {
  std::string out;
  std::string scene;
  std::string body;
  std::vector<Block> of_scene;
  const auto flush = [&] {
    if (!body.empty()) {
      for (const std::string& line : flag_lines(of_scene)) {
        body += fmt::format("<p class=\"quiet\">{}</p>\n", escape_markup(line));
      }
      const std::string& brief = names.brief(scene);
      const std::string whole =
          brief == scene ? "" : fmt::format("<p class=\"quiet\">{}</p>\n", escape_markup(scene));
      out += summary_details(brief, whole + body, true);
    }
    body.clear();
    of_scene.clear();
  };
  for (const Block& block : blocks) {
    if (scene_label(block) != scene) {
      flush();
      scene = scene_label(block);
    }
    const Table table = to_table(block);
    if (table.rows.empty()) continue;
    body += fmt::format("<h4>{}</h4>\n{}", escape_markup(block.group), html_table(table, palette));
    of_scene.push_back(block);
  }
  flush();
  return out;
}

std::string html_validation(const ReportSource& source, const Palette& palette,
                            const std::string& csv) {
  if (source.validation.is_null()) return "";
  return fmt::format("<p>{} <a href=\"{}\">CSV</a></p>\n{}",
                     escape_markup(validation_legend(source)), csv,
                     matrix_table(validation_matrix(source), palette));
}

std::string html_flagged(const ReportSource& source, const SceneNames& names) {
  std::string rows;
  for (const Row* row : flagged_cells(source.rows)) {
    rows += cell_row(*row, "! " + row->validity, source, names);
  }
  if (rows.empty()) return "";
  return k_table_open + header_row({"engine", "scene", "flags", "repeat"}) + rows + k_table_close;
}

std::string html_unfinished(const ReportSource& source, const SceneNames& names) {
  std::string rows;
  std::set<std::string> seen;
  for (const Row& row : source.rows) {
    if (!row.state_hash.empty() || !seen.insert(row.cell).second) continue;
    rows +=
        cell_row(row, row.outcome + (row.reason.empty() ? "" : ": ") + row.reason, source, names);
  }
  if (rows.empty()) return "";
  return k_table_open + header_row({"engine", "scene", "outcome", "repeat"}) + rows + k_table_close;
}

std::string html_contenders(const ReportSource& source, const Palette& palette) {
  std::map<std::string, CellCount> cells;
  std::vector<std::pair<std::string, const Row*>> order;
  std::set<std::string> seen;
  for (const Row& row : source.rows) {
    if (!seen.insert(row.cell).second) continue;
    const std::string label = contender_of(row);
    if (!cells.contains(label)) order.emplace_back(label, &row);
    cells[label].ran += row.state_hash.empty() ? 0 : 1;
    cells[label].flagged += row.validity.empty() ? 0 : 1;
    ++cells[label].all;
  }
  const std::vector<std::string> own = own_engines(source.provenance);
  Table table;
  table.header = {"engine", "version", "precision", "settings", "by", "cells that ran"};
  for (const auto& [label, row] : order) {
    const std::string knobs = split_axes(row->axes).knobs;
    const bool is_own = std::ranges::find(own, row->engine) != own.end();
    table.rows.push_back({{label},
                          {row->engine_version},
                          {row->precision},
                          {knobs.empty() ? "the variant's own" : knobs},
                          {is_own ? "this project" : "others"},
                          {cells[label].text()}});
  }
  std::string out = table.rows.empty() ? "" : text_table(table, palette);
  const Table audit = audit_table(source);
  if (!audit.rows.empty()) {
    out +=
        "<p>Validated; settings and facts are read back from the live engine before any score, "
        "and a fact that did not arrive is a failed cell.</p>\n" +
        text_table(audit, palette);
  }
  return out;
}

std::string html_method(const ReportSource& source) {
  const Provenance& p = source.provenance;
  const Machine& m = p.machine;
  std::string attached;
  for (const Provenance& other : source.attached) {
    attached += fmt::format("<p>{}, at {}, revision {}:</p>\n<pre><code>{}</code></pre>\n",
                            escape_markup(other.title), escape_markup(other.date_utc),
                            escape_markup(other.machine.revision), escape_markup(other.command));
  }
  return fmt::format(
      "<p>Every number is computed from the states that an engine reported, by code that shares "
      "nothing with any engine. A mean or a ratio names how many cells it speaks of.</p>\n"
      "<pre><code>{}</code></pre>\n<p>Run at {} on {} ({} cores), {}, {}. Revision {}, {} build "
      "with {} {}.{}</p>\n{}",
      escape_markup(p.command), escape_markup(p.date_utc), escape_markup(m.cpu), m.cores,
      escape_markup(m.architecture), escape_markup(m.system), escape_markup(m.revision),
      escape_markup(m.build_type), escape_markup(m.compiler), escape_markup(m.flags),
      p.plan.empty() ? "" : " Plan " + escape_markup(p.plan) + '.', attached);
}

std::string html_glossary(const ReportSource& source) {
  std::set<std::string> used;
  for (const Row& row : source.rows) used.insert(row.metric);
  std::string rows;
  for (const MetricRecord& metric : source.provenance.metrics) {
    if (!used.contains(metric.name)) continue;
    rows += fmt::format(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td class=\"text\">{}</td>"
        "<td class=\"text\">{}</td></tr>\n",
        escape_markup(metric.name), escape_markup(metric.unit), escape_markup(metric.better),
        escape_markup(metric.meaning), escape_markup(metric.good));
  }
  if (rows.empty()) return "";
  return k_table_open + header_row({"number", "unit", "better", "meaning", "a good value"}) + rows +
         k_table_close;
}

}  // namespace brickbench
