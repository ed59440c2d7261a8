#include "reports/src/validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "adapters/seam/unit.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& object, const char* key) {
  return object.contains(key) && object[key].is_string() ? object[key].get<std::string>() : "";
}

std::optional<double> number_of(const Json& object, const char* key) {
  if (!object.contains(key) || !object[key].is_number()) return {};
  return object[key].get<double>();
}

bool flag_of(const Json& object, const char* key) {
  return object.contains(key) && object[key].is_boolean() && object[key].get<bool>();
}

std::string engine_of(const Json& cell) {
  return text_of(cell, "engine") + '/' + text_of(cell, "variant");
}

// The largest |part| over the scores of a cell.
std::optional<double> largest(const Json& cell, const char* part) {
  std::optional<double> worst;
  if (!cell.contains("scores")) return worst;
  for (const Json& score : cell["scores"]) {
    const auto value = number_of(score, part);
    if (value) worst = std::max(worst.value_or(0.0), std::abs(*value));
  }
  return worst;
}

std::string digits(const std::optional<double>& value) {
  return value ? fmt::format("{:.1e}", *value) : "-";
}

std::string exactly(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : "";
}

std::string verdict_of(const Json& cell) {
  const bool failed = flag_of(cell, "failed");
  if (text_of(cell, "outcome") != "ok") return failed ? "failed" : "refused";
  if (failed) return "beyond bound";
  return largest(cell, "unexplained") ? "within bound" : "open";
}

TableCell matrix_cell(const Json& cell) {
  const std::string verdict = verdict_of(cell);
  if (verdict == "failed") return {text_of(cell, "outcome"), Mark::failed};
  if (verdict == "refused") return {text_of(cell, "outcome"), Mark::plain};
  if (verdict == "open") {
    return {"open, error " + digits(largest(cell, "error")), Mark::plain};
  }
  const std::string parts =
      digits(largest(cell, "explained")) + " / " + digits(largest(cell, "unexplained"));
  if (verdict == "within bound") return {parts, Mark::plain};
  return {fmt::format("{} > {}", parts, digits(number_of(cell, "bound"))), Mark::failed};
}

std::string settings_text(const Json& engine) {
  std::string out;
  if (!engine.contains("settings")) return out;
  for (const Json& fact : engine["settings"]) {
    const std::string unit = text_of(fact, "unit");
    out += fmt::format("{}{} {}{}", out.empty() ? "" : "; ", text_of(fact, "name"),
                       text_of(fact, "value"), unit_suffix(unit));
  }
  return out;
}

// RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

constexpr std::string_view k_at_rounding = "at rounding";

std::string order_note(const Json& result) {
  if (flag_of(result, "at_rounding")) return std::string(k_at_rounding);
  const auto order = number_of(result, "order");
  if (!order) return "";
  std::string note = fmt::format("order {:.2f}", *order);
  if (const auto width = number_of(result, "half_width_95")) {
    note += fmt::format(" \xC2\xB1 {:.2g}", *width);
  }
  const auto promised = number_of(result, "promised");
  if (promised && *promised > 0.0) note += fmt::format(", promised {:g}", *promised);
  return note;
}

// One figure per case of orders.json; `kind` begins the id, `x_key` names the rung's abscissa.
std::vector<Figure> orders(const ReportSource& source, Palette& palette, const std::string& kind,
                           const std::string& title, const FigureAxis& x, const char* x_key) {
  std::vector<Figure> figures;
  std::map<std::string, std::size_t> known;
  if (source.orders.is_null()) return figures;
  for (const Json& result : source.orders["orders"]) {
    if (text_of(result, "outcome") != "ok") continue;
    const std::string name = text_of(result, "case");
    const auto [place, is_new] = known.emplace(name, figures.size());
    if (is_new) {
      Figure figure;
      figure.id = file_id(fmt::format("{}-case-{}-{}", kind, figures.size(), name));
      figure.title = fmt::format("{}: {}", title, name);
      figure.x = x;
      figure.y = {"relative error", "1", true};
      figure.markers = true;
      figures.push_back(std::move(figure));
    }
    Curve curve;
    curve.label = engine_of(result);
    curve.colour = palette.index(curve.label);
    curve.note = order_note(result);
    for (const Json& rung : result["ladder"]) {
      const auto at = number_of(rung, x_key);
      const auto error = number_of(rung, "error");
      if (!at || !error) continue;
      curve.x.push_back(*at);
      curve.y.push_back(*error);
    }
    if (!curve.x.empty()) figures[place->second].curves.push_back(std::move(curve));
  }
  std::erase_if(figures, [](const Figure& figure) {
    return std::ranges::none_of(figure.curves, [](const Curve& curve) {
      if (curve.note == k_at_rounding) return false;
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        if (curve.x[i] > 0.0 && curve.y[i] > 0.0) return true;
      }
      return false;
    });
  });
  for (Figure& figure : figures) {
    if (const std::size_t hidden = hidden_points(figure); hidden > 0) {
      figure.caption = fmt::format("{} points that are not above zero are not shown.", hidden);
    }
  }
  return figures;
}

std::string missing_text(const Json& item, const std::vector<const char*>& keys) {
  if (!item.is_object()) return "an entry that is no object";
  for (const char* key : keys) {
    if (!item.contains(key) || !item[key].is_string()) {
      return fmt::format("an entry without the text '{}'", key);
    }
  }
  return "";
}

}  // namespace

ValidationCount count_validation(const Json& validation) {
  ValidationCount count;
  if (validation.is_null()) return count;
  for (const Json& cell : validation["cells"]) {
    const std::string verdict = verdict_of(cell);
    ++count.all;
    count.within += verdict == "within bound" ? 1U : 0U;
    count.beyond += verdict == "beyond bound" ? 1U : 0U;
    count.failed += verdict == "failed" ? 1U : 0U;
    count.open += verdict == "open" ? 1U : 0U;
    count.refused += verdict == "refused" ? 1U : 0U;
  }
  return count;
}

std::string validation_legend(const ReportSource& source) {
  const ValidationCount count = count_validation(source.validation);
  return fmt::format(
      "Each cell: the part of the error that the engine's documented scheme explains / the part "
      "that nothing explains, both relative to the case's scale, of the worst observable; \"open\" "
      "where the scheme predicts nothing. Of {} cells {} are within their bound, {} are beyond it "
      "(open questions), {} failed, {} have no discrete prediction, {} were refused.",
      count.all, count.within, count.beyond, count.failed, count.open, count.refused);
}

Table validation_matrix(const ReportSource& source) {
  Table table;
  if (source.validation.is_null()) return table;
  std::map<std::string, std::size_t> rows, columns;
  table.header = {"case"};
  for (const Json& cell : source.validation["cells"]) {
    if (columns.emplace(engine_of(cell), table.header.size()).second) {
      table.header.push_back(engine_of(cell));
    }
    if (rows.emplace(text_of(cell, "case"), rows.size()).second) {
      table.rows.push_back({{text_of(cell, "case")}});
    }
  }
  for (auto& row : table.rows) row.resize(table.header.size());
  for (const Json& cell : source.validation["cells"]) {
    table.rows[rows[text_of(cell, "case")]][columns[engine_of(cell)]] = matrix_cell(cell);
  }
  return table;
}

Table audit_table(const ReportSource& source) {
  Table table;
  if (source.validation.is_null() || !source.validation.contains("engines")) return table;
  table.header = {"engine", "version", "precision", "settings read back", "audit"};
  for (const Json& engine : source.validation["engines"]) {
    std::size_t passed = 0, differing = 0;
    for (const Json& cell : source.validation["cells"]) {
      if (engine_of(cell) != engine_of(engine)) continue;
      differing += text_of(cell, "outcome") == "audit" ? 1U : 0U;
      passed += text_of(cell, "outcome") == "ok" ? 1U : 0U;
    }
    table.rows.push_back({{engine_of(engine)},
                          {text_of(engine, "version")},
                          {text_of(engine, "precision")},
                          {settings_text(engine)},
                          {fmt::format("{} of {} cells as asked", passed, passed + differing),
                           differing > 0 ? Mark::failed : Mark::plain}});
  }
  return table;
}

std::string validation_csv(const ReportSource& source) {
  std::string out = "case,engine,outcome,verdict,error,explained,unexplained,bound,reason\n";
  if (source.validation.is_null()) return out;
  for (const Json& cell : source.validation["cells"]) {
    out += fmt::format("{},{},{},{},{},{},{},{},{}\n", quoted(text_of(cell, "case")),
                       quoted(engine_of(cell)), quoted(text_of(cell, "outcome")), verdict_of(cell),
                       exactly(largest(cell, "error")), exactly(largest(cell, "explained")),
                       exactly(largest(cell, "unexplained")), exactly(number_of(cell, "bound")),
                       quoted(text_of(cell, "reason")));
  }
  return out;
}

std::vector<Figure> orders_against_step(const ReportSource& source, Palette& palette) {
  return orders(source, palette, "step", "error against the step", {"step_s", "s", true}, "step_s");
}

std::vector<Figure> orders_against_cost(const ReportSource& source, Palette& palette) {
  return orders(source, palette, "cost", "error against cost",
                {"engine CPU time of the run", "s", true}, "cpu_s");
}

std::string validation_fault(const Json& json) {
  if (!json.is_object() || !json.contains("cells") || !json["cells"].is_array()) {
    return "no array 'cells'; write it with `brickbench validate --out`";
  }
  for (const Json& cell : json["cells"]) {
    if (auto what = missing_text(cell, {"engine", "variant", "case", "outcome"}); !what.empty()) {
      return "cells: " + what;
    }
  }
  if (!json.contains("engines")) return "";
  if (!json["engines"].is_array()) return "'engines' is no array";
  for (const Json& engine : json["engines"]) {
    if (auto what = missing_text(engine, {"engine", "variant"}); !what.empty()) {
      return "engines: " + what;
    }
  }
  return "";
}

std::string orders_fault(const Json& json) {
  if (!json.is_object() || !json.contains("orders") || !json["orders"].is_array()) {
    return "no array 'orders'; write it with `brickbench validate --order --out`";
  }
  for (const Json& result : json["orders"]) {
    if (auto what = missing_text(result, {"engine", "variant", "case", "outcome"}); !what.empty()) {
      return "orders: " + what;
    }
    if (!result.contains("ladder") || !result["ladder"].is_array()) {
      return "orders: an entry without the array 'ladder'";
    }
  }
  return "";
}

}  // namespace brickbench
