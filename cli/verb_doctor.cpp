#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/build_facts.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/run/plan_files.hpp"

namespace brickbench {
namespace {

nlohmann::ordered_json doctor_json() {
  const Catalogues catalogues = all_catalogues();
  auto engines = nlohmann::ordered_json::array();
  for (const Adapter& adapter : catalogues.adapters) {
    engines.push_back({{"id", adapter.name},
                       {"version", adapter.version},
                       {"precision", precision_text(adapter)},
                       {"variants", names_of(adapter.variants)}});
  }
  auto absent = nlohmann::ordered_json::array();
  for (const AbsentEngine& engine : absent_engines()) {
    absent.push_back({{"id", engine.name},
                      {"why", engine.packages.empty() ? "switched off" : "not found"},
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
    fmt::print("not linked    {}: {}\n", engine["id"].get<std::string>(),
               packages.empty() ? "switched off when this was configured"
                                : "not found; on Debian: apt-get install " + packages);
  }
  for (const auto& folder : json["plan_folders"]) {
    fmt::print("plans in      {}\n", folder.get<std::string>());
  }
}

}  // namespace

void add_doctor_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand("doctor", "What is linked, what is missing, on what machine");
  auto json = std::make_shared<bool>(false);
  verb->add_flag("--json", *json, "The same as JSON");
  verb->callback([json, &invocation] {
    const auto facts = doctor_json();
    if (*json)
      fmt::print("{}\n", facts.dump(2));
    else
      print(facts);
    invocation.exit_code = k_exit_fine;
  });
}

}  // namespace brickbench
