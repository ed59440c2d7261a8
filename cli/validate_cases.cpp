#include "cli/validate_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "cli/cell_output.hpp"
#include "cli/complain.hpp"
#include "cli/engine_files.hpp"
#include "cli/terminal.hpp"
#include "cli/validation_output.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/provenance.hpp"

namespace brickbench {
namespace {

using exact::Verdict;
using Json = nlohmann::ordered_json;
using Counts = std::map<Verdict, std::size_t>;

// Open questions are about engines as they are: with a knob turned every failure is a new one.
JudgedCell judged(const CasesAsked& asked, const exact::ExactCase& exact_case,
                  exact::CellResult cell, const ParameterValues& given) {
  JudgedCell out;
  out.given = given;
  if (asked.knobs.empty()) {
    out.question = exact::question_of(asked.questions, cell, exact_case,
                                      exact::complete(exact_case, given).value());
  }
  out.verdict = exact::verdict_of(cell, out.question);
  out.reproduce = reproduce_cell(cell, given, asked.knob_text);
  if (!asked.engine_files.empty()) {
    out.reproduce += ' ' + shell_command(engine_file_words(asked.engine_files));
  }
  out.cell = std::move(cell);
  return out;
}

std::string said(const Counts& counts, std::size_t all) {
  const auto of = [&](Verdict verdict) {
    const auto found = counts.find(verdict);
    return found == counts.end() ? std::size_t{0} : found->second;
  };
  return fmt::format(
      "{} of {} cells follow their scheme within the bounds, {} failed, {} are known open "
      "questions, {} have no discrete prediction, {} refused.",
      of(Verdict::held), all, of(Verdict::failed), of(Verdict::known), of(Verdict::open),
      of(Verdict::refused));
}

void put_counts(Json& json, const Counts& counts, std::size_t all, int exit_code) {
  const auto of = [&](Verdict verdict) {
    const auto found = counts.find(verdict);
    return found == counts.end() ? std::size_t{0} : found->second;
  };
  json["count"] = all;
  json["failed"] = of(Verdict::failed);
  json["known"] = of(Verdict::known);
  json["within_bounds"] = of(Verdict::held);
  json["open"] = of(Verdict::open);
  json["refused"] = of(Verdict::refused);
  json["exit_code"] = exit_code;
}

// Listed cells that are within their bound after all: the list is out of date.
void tell_answered(const std::vector<JudgedCell>& cells) {
  for (const JudgedCell& item : cells) {
    if (item.question == nullptr || item.verdict != Verdict::held) continue;
    if (!item.question->region.at_defaults) continue;
    fmt::print("{} {}/{} is listed as an open question and within its bound.\n", item.cell.case_id,
               item.cell.engine, item.cell.variant);
  }
}

int save(const CasesAsked& asked, const Catalogues& catalogues, Json json, int exit_code) {
  if (asked.out.empty()) return exit_code;
  json["engines"] = audited_engines(asked.engines, catalogues, asked.cases, asked.knobs);
  const auto saved =
      save_validation(asked.out, "validation.json", json, "Exact cases in all engines asked for",
                      asked.arguments, asked.engines, catalogues);
  return saved ? exit_code : complain(saved.error());
}

// What the drawings of one case came to over all engines.
struct ScanLine {
  std::size_t inside = 0;
  std::size_t outside = 0;
  Counts counts;
  double worst = 0.0;  // unexplained, over the bound, of the cells that held
};

void print_scan_line(const std::string& case_id, ScanLine& line) {
  fmt::print("{:<30} {:>6} {:>8} {:>6} {:>6} {:>6} {:>8} {:>7} {:>10.2g}\n", case_id, line.inside,
             line.outside, line.counts[Verdict::held], line.counts[Verdict::known],
             line.counts[Verdict::open], line.counts[Verdict::refused],
             line.counts[Verdict::failed], line.worst);
}

Json outside_json(const exact::Drawings& drawings) {
  auto array = Json::array();
  for (const auto& [why, times] : drawings.outside) {
    array.push_back({{"why", why}, {"drawings", times}});
  }
  return array;
}

}  // namespace

int tabulate_cases(const CasesAsked& asked, const Catalogues& catalogues) {
  std::vector<JudgedCell> cells;
  Counts counts;
  const std::size_t count = asked.engines.size() * asked.cases.size();
  Progress progress(count);
  if (!asked.json) print_cell_header();
  for (const exact::ExactCase& exact_case : asked.cases) {
    for (const EngineVariant& engine : asked.engines) {
      progress.begin(exact_case.id + ' ' + engine.label());
      cells.push_back(
          judged(asked, exact_case,
                 exact::validate(*find_adapter(catalogues, engine.engine), engine.variant,
                                 exact_case, asked.parameters, asked.knobs),
                 asked.parameters));
      progress.end(
          fmt::format("{} {}: {}", exact_case.id, engine.label(), cells.back().cell.outcome));
      ++counts[cells.back().verdict];
      if (!asked.json) print_cell(cells.back());
    }
  }
  const int exit_code = counts[Verdict::failed] > 0 ? k_exit_failed_case : k_exit_fine;
  auto array = Json::array();
  for (const JudgedCell& item : cells) array.push_back(cell_json(item));
  Json json = {{"cells", std::move(array)}};
  put_counts(json, counts, count, exit_code);
  if (asked.json) {
    fmt::print("{}\n", json.dump(2));
  } else {
    tell_answered(cells);
    fmt::print("{}\n", said(counts, count));
  }
  return save(asked, catalogues, std::move(json), exit_code);
}

int scan_cases(const CasesAsked& asked, const Catalogues& catalogues, std::size_t count,
               std::uint64_t seed) {
  auto array = Json::array(), failures = Json::array();
  std::vector<JudgedCell> failed;
  Counts total;
  std::size_t all = 0, short_of = 0;
  Progress progress(asked.engines.size() * asked.cases.size());
  if (!asked.json) {
    fmt::print("{:<30} {:>6} {:>8} {:>6} {:>6} {:>6} {:>8} {:>7} {:>10}\n", "case", "inside",
               "outside", "ok", "known", "open", "refused", "FAILED", "worst");
  }
  for (const exact::ExactCase& exact_case : asked.cases) {
    const exact::Drawings drawings = exact::drawings_of(exact_case, seed, count);
    ScanLine line{.inside = drawings.inside.size(), .outside = 0, .counts = {}, .worst = 0.0};
    for (const auto& [why, times] : drawings.outside) line.outside += times;
    short_of += line.inside < count ? 1U : 0U;
    for (const EngineVariant& engine : asked.engines) {
      progress.begin(exact_case.id + ' ' + engine.label());
      const Adapter& adapter = *find_adapter(catalogues, engine.engine);
      for (const ParameterValues& values : drawings.inside) {
        JudgedCell item = judged(
            asked, exact_case,
            exact::validate_at(adapter, engine.variant, exact_case, values, asked.knobs), values);
        ++line.counts[item.verdict];
        ++total[item.verdict];
        ++all;
        if (item.verdict == Verdict::held) {
          line.worst = std::max(line.worst, *item.cell.worst_unexplained() / item.cell.bound);
        }
        if (item.verdict == Verdict::failed) failed.push_back(std::move(item));
      }
      progress.end(exact_case.id + ' ' + engine.label());
    }
    array.push_back({{"case", exact_case.id},
                     {"inside", line.inside},
                     {"outside", outside_json(drawings)},
                     {"worst_over_bound", line.worst}});
    if (asked.json) continue;
    print_scan_line(exact_case.id, line);
    for (const auto& [why, times] : drawings.outside) {
      fmt::print("    outside, {} times: {}\n", times, why);
    }
  }
  const int exit_code = total[Verdict::failed] > 0 ? k_exit_failed_case
                        : short_of > 0             ? k_exit_incomplete
                                                   : k_exit_fine;
  for (const JudgedCell& item : failed) failures.push_back(cell_json(item));
  Json json = {{"seed", seed},
               {"drawings", count},
               {"cases", std::move(array)},
               {"cells", std::move(failures)}};
  put_counts(json, total, all, exit_code);
  if (asked.json) {
    fmt::print("{}\n", json.dump(2));
    return exit_code;
  }
  if (!failed.empty()) print_cell_header();
  for (const JudgedCell& item : failed) print_cell(item);
  if (short_of > 0) fmt::print("{} cases have fewer drawings inside than asked for.\n", short_of);
  fmt::print("Seed {}: {}\n", seed, said(total, all));
  return exit_code;
}

}  // namespace brickbench
