#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/build_facts.hpp"
#include "cli/complain.hpp"
#include "cli/engine_files.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/run/plan_files.hpp"

namespace brickbench {
namespace {

nlohmann::ordered_json doctor_json(const Catalogues& catalogues) {
  auto engines = nlohmann::ordered_json::array();
  for (const Adapter& adapter : catalogues.adapters) {
    engines.push_back({{"id", adapter.name},
                       {"version", adapter.version},
                       {"precision", precision_text(adapter)},
                       {"variants", names_of(adapter.variants)}});
  }
  auto absent = nlohmann::ordered_json::array();
  for (const AbsentEngine& engine : absent_engines(catalogues)) {
    absent.push_back({{"id", engine.name},
                      {"why", !engine.why.empty()       ? engine.why
                              : engine.packages.empty() ? "switched off"
                                                        : "not found"},
                      {"packages", engine.packages}});
  }
  auto folders = nlohmann::ordered_json::array();
  for (const auto& folder : plan_folders()) folders.push_back(folder.string());
  return {{"machine", to_json(this_machine())},
          {"engines", engines},
          {"absent", absent},
          {"plan_folders", folders}};
}

void print(const nlohmann::ordered_json& json) {
  for (const auto& [name, value] : json["machine"].items()) {
    fmt::print("{:<13} {}\n", name, value.is_string() ? value.get<std::string>() : value.dump());
  }
  for (const auto& engine : json["engines"]) {
    fmt::print("linked        {}: {}, {}, variants {}\n", engine["id"].get<std::string>(),
               engine["version"].get<std::string>(), engine["precision"].get<std::string>(),
               fmt::join(engine["variants"].get<std::vector<std::string>>(), " "));
  }
  for (const auto& engine : json["absent"]) {
    const std::string packages = engine["packages"];
    const std::string why = engine["why"];
    fmt::print("{}    {}: {}\n",
               why == "switched off" || !packages.empty() ? "not linked" : "no use    ",
               engine["id"].get<std::string>(),
               !packages.empty()       ? "not found; on Debian: apt-get install " + packages
               : why == "switched off" ? "switched off when this was configured"
                                       : why);
  }
  for (const auto& folder : json["plan_folders"]) {
    fmt::print("plans in      {}\n", folder.get<std::string>());
  }
}

}  // namespace

void add_doctor_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand("doctor", "What is linked, what is missing, on what machine");
  struct Choice {
    std::vector<std::string> engine_files;
    bool json = false;
  };
  auto choice = std::make_shared<Choice>();
  add_engine_files(*verb, choice->engine_files);
  verb->add_flag("--json", choice->json, "The same as JSON");
  verb->callback([choice, &invocation] {
    const auto catalogues = all_catalogues(choice->engine_files);
    if (!catalogues) {
      invocation.exit_code = complain(catalogues.error().text(), k_exit_bad_input);
      return;
    }
    const auto facts = doctor_json(*catalogues);
    if (choice->json)
      fmt::print("{}\n", facts.dump(2));
    else
      print(facts);
    invocation.exit_code = k_exit_fine;
  });
}

}  // namespace brickbench
