#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/engine_files.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/conformance/diagnosis.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

struct ConformanceOptions {
  std::string engine;
  std::vector<std::string> engine_files;
  bool json = false;
};

std::string_view conformance_word(conformance::Outcome outcome) {
  switch (outcome) {
    case conformance::Outcome::passed:
      return "passed";
    case conformance::Outcome::failed:
      return "failed";
    case conformance::Outcome::refused:
      return "refused";
    case conformance::Outcome::no_view:
      return "no_view";
  }
  return "failed";
}

// All checks and the symptoms of one variant.
Json conformance_json(const Adapter& adapter, const EngineVariant& engine, Progress& progress) {
  const conformance::Subject subject{adapter, engine.variant};
  progress.begin(engine.label());
  auto checks = Json::array();
  std::size_t failed = 0;
  const auto all = conformance::all_checks();
  for (const conformance::Check& check : all) {
    progress.update(static_cast<double>(checks.size()) / static_cast<double>(all.size() + 1));
    const conformance::Verdict verdict = check.run(subject);
    if (verdict.outcome == conformance::Outcome::failed) ++failed;
    checks.push_back({{"id", check.name},
                      {"rule", check.rule},
                      {"outcome", conformance_word(verdict.outcome)},
                      {"detail", verdict.detail}});
  }
  const auto symptoms = conformance::diagnose(subject);
  progress.end(fmt::format("{}: {} of {} checks failed", engine.label(), failed, all.size()));
  return {{"id", engine.label()},
          {"version", adapter.version},
          {"conforms", failed == 0 && symptoms.empty()},
          {"symptoms", symptoms},
          {"checks", checks}};
}

void print_conformance(const Json& record) {
  const auto count = [&](std::string_view outcome) {
    return std::ranges::count_if(record["checks"],
                                 [&](const Json& check) { return check["outcome"] == outcome; });
  };
  fmt::print("{}: {} passed, {} failed, {} refused, {} without the view\n",
             record["id"].get<std::string>(), count("passed"), count("failed"), count("refused"),
             count("no_view"));
  for (const Json& words : record["symptoms"]) {
    fmt::print("  looks like: {}\n", words.get<std::string>());
  }
  for (const Json& check : record["checks"]) {
    if (check["outcome"] == "passed") continue;
    fmt::print("  {} {} ({}): {}\n", check["outcome"].get<std::string>(),
               check["id"].get<std::string>(), check["rule"].get<std::string>(),
               check["detail"].get<std::string>());
  }
}

int conform(const ConformanceOptions& options) {
  const auto catalogues = running_catalogues(options.engine_files);
  if (!catalogues) return complain(catalogues.error().text(), k_exit_bad_input);
  auto selector = parse_selector(options.engine, {.file = "engine"}, *catalogues, true);
  if (!selector) return complain(selector.error().text(), k_exit_bad_input);
  if (selector->variant.empty()) selector->variant = "*";
  const auto engines = select(*selector, *catalogues);
  Progress progress(engines.size());
  auto records = Json::array();
  bool all_conform = true;
  for (const EngineVariant& engine : engines) {
    records.push_back(
        conformance_json(*find_adapter(*catalogues, engine.engine), engine, progress));
    all_conform = all_conform && records.back()["conforms"].get<bool>();
    if (!options.json) print_conformance(records.back());
  }
  if (options.json) fmt::print("{}\n", records.dump(2));
  if (engines.empty()) return complain("no engine to ask", k_exit_incomplete);
  return all_conform ? k_exit_fine : k_exit_failed_case;
}

}  // namespace

void add_conformance_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "conformance", "Ask an engine for every rule of the seam, and say in words what is wrong");
  auto options = std::make_shared<ConformanceOptions>();
  verb->add_option("engine", options->engine, "Engine, with all variants, or engine/variant")
      ->required();
  add_engine_files(*verb, options->engine_files);
  verb->add_flag("--json", options->json, "An array with one object for each variant");
  verb->callback([options, &invocation] { invocation.exit_code = conform(*options); });
}

}  // namespace brickbench
