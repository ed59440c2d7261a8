#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/ensemble_verdicts.hpp"
#include "cli/report_output.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "reports/src/compare.hpp"
#include "reports/src/ensemble_report.hpp"
#include "reports/src/html_sections.hpp"

namespace brickbench {
namespace {

struct CompareOptions {
  std::string a;
  std::string b;
  std::string out;
  std::size_t rows = 20;
  bool markdown = false;
  bool json = false;
};

nlohmann::ordered_json change_json(const Change& change) {
  const auto number = [](const std::optional<double>& value) {
    return value && std::isfinite(*value) ? nlohmann::ordered_json(*value)
                                          : nlohmann::ordered_json(nullptr);
  };
  constexpr std::array kinds = {"beyond_noise", "within_noise", "outcome"};
  return {{"id", fmt::format("{}:{}:{}", change.engine, change.scene, change.number)},
          {"kind", kinds[static_cast<std::size_t>(change.kind)]},
          {"unit", change.unit},
          {"before", number(change.before)},
          {"after", number(change.after)},
          {"relative", number(change.relative)},
          {"noise", number(change.noise)},
          {"worse", change.worse},
          {"words", change.words}};
}

void print_json(const FolderComparison& comparison) {
  nlohmann::ordered_json json = {{"headline", headline(comparison)},
                                 {"facts", comparison.facts},
                                 {"compared", comparison.compared},
                                 {"same", comparison.same},
                                 {"flagged", comparison.flagged},
                                 {"without_number", comparison.without_number},
                                 {"untimed", comparison.untimed},
                                 {"beyond_noise", comparison.beyond_noise},
                                 {"only_in_a", comparison.only_in_a},
                                 {"only_in_b", comparison.only_in_b},
                                 {"changes", nlohmann::ordered_json::array()},
                                 {"timings", nlohmann::ordered_json::array()}};
  for (const Change& change : comparison.changes) json["changes"].push_back(change_json(change));
  for (const Change& change : comparison.timings) json["timings"].push_back(change_json(change));
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void print_tables(const FolderComparison& comparison, const Ensembles& ensembles,
                  std::size_t rows) {
  const TerminalStyle style = standard_output_style();
  fmt::print("{}\n", headline(comparison));
  for (const std::string& fact : comparison.facts) fmt::print("  {}\n", fact);
  Table changes = changes_table(comparison, rows);
  if (!changes.rows.empty()) {
    changes.title =
        fmt::format("beyond noise: {} of {}", changes.rows.size(), comparison.beyond_noise);
    fmt::print("\n{}", to_terminal(changes, style));
  }
  Table timings = timings_table(comparison);
  if (!timings.rows.empty()) {
    timings.title = "CPU time per step";
    fmt::print("\n{}", to_terminal(timings, style));
  }
  Table spread = ensemble_table(ensembles);
  if (!spread.rows.empty()) {
    if (spread.rows.size() > rows) spread.rows.resize(rows);
    spread.title = ensemble_headline(ensembles).front();
    fmt::print("\n{}", to_terminal(spread, style));
  }
  for (const std::string& line : comparison.untimed) fmt::print("time of {}\n", line);
  for (const std::string& cell : comparison.only_in_a) fmt::print("only in the first: {}\n", cell);
  for (const std::string& cell : comparison.only_in_b) fmt::print("only in the second: {}\n", cell);
}

// The last parts of two paths, where these tell them apart.
std::pair<std::string, std::string> short_labels(const std::string& a, const std::string& b) {
  const auto last = [](const std::string& path) {
    return (std::filesystem::path(path + "/.").lexically_normal())
        .parent_path()
        .filename()
        .string();
  };
  return last(a).empty() || last(b).empty() || last(a) == last(b) ? std::pair{a, b}
                                                                  : std::pair{last(a), last(b)};
}

int compare_folders(const CompareOptions& options) {
  if (auto ok = check_is_new(options.out); !ok) return complain(ok.error());
  const auto sources = read_sources({options.a, options.b});
  if (!sources) return complain(sources.error());
  const FolderComparison comparison = compare(sources->front(), sources->back());
  const auto [label_a, label_b] = short_labels(options.a, options.b);
  Ensembles ensembles = ensembles_between(sources->front(), sources->back(), label_a, label_b);
  judge(ensembles);
  Palette palette;
  const std::string markdown = compare_markdown(comparison, options.a, options.b) +
                               markdown_ensembles(ensembles, palette, "");
  if (!options.out.empty()) {
    PageAssets assets = page_assets();
    assets.script.clear();  // nothing to replay here
    const std::string body =
        compare_html(comparison, options.a, options.b) +
        html_section("ensembles", "Ensembles", html_ensembles(ensembles, palette, ""));
    std::vector<OutputFile> files = {
        {"index.html", page(options.a + " -> " + options.b, body, "", assets)},
        {"compare.md", markdown}};
    std::ranges::move(ensemble_files(ensembles, palette, ""), std::back_inserter(files));
    if (auto ok = write_folder(options.out, files); !ok) return complain(ok.error());
  }
  if (options.json)
    print_json(comparison);
  else if (options.markdown)
    fmt::print("{}", markdown);
  else
    print_tables(comparison, ensembles, options.rows);
  const bool differs = comparison.beyond_noise > 0 ||
                       std::ranges::any_of(ensembles.pairs, [](const EnsemblePair& pair) {
                         return pair.verdict.word == EnsembleWord::different;
                       });
  if (differs) return k_exit_failed_case;
  if (comparison.compared == 0) return k_exit_incomplete;
  const bool other_cells = !comparison.only_in_a.empty() || !comparison.only_in_b.empty();
  return other_cells ? k_exit_failed_case : k_exit_fine;
}

}  // namespace

void add_compare_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "compare",
      "Say what changed between two results folders; exit code 1 if anything did, 3 if nothing "
      "could be compared");
  auto options = std::make_shared<CompareOptions>();
  verb->add_option("before", options->a, "Results folder")->required();
  verb->add_option("after", options->b, "Results folder")->required();
  verb->add_option("--out", options->out, "New folder for a page and Markdown");
  verb->add_option("--rows", options->rows, "Changes to print at most");
  verb->add_flag("--markdown", options->markdown, "Print Markdown, to paste elsewhere");
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = compare_folders(*options); });
}

}  // namespace brickbench
