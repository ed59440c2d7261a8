#include "cli/validation_output.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <set>

#include "cli/report_output.hpp"
#include "experiments/exact/validation/validate.hpp"
#include "experiments/record/provenance.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

Json live_settings(const Adapter& adapter, const std::string& variant,
                   const std::vector<exact::ExactCase>& cases, const KnobValues& knobs) {
  auto settings = Json::array();
  for (const exact::ExactCase& exact_case : cases) {
    const auto run = exact::build(exact_case);
    if (!run) continue;
    const auto built =
        build(adapter, run->world, exact::settings_of(adapter, variant, *run, knobs));
    if (!built) continue;
    const AuditView* view = (*built)->audit_view();
    if (view == nullptr) break;
    for (const AuditFact& fact : view->audit().settings) {
      settings.push_back({{"name", fact.name}, {"unit", fact.unit}, {"value", fact.value}});
    }
    break;
  }
  return settings;
}

}  // namespace

Json audited_engines(const std::vector<EngineVariant>& engines, const Catalogues& catalogues,
                     const std::vector<exact::ExactCase>& cases, const KnobValues& knobs) {
  auto array = Json::array();
  for (const EngineVariant& engine : engines) {
    const Adapter& adapter = *find_adapter(catalogues, engine.engine);
    array.push_back({{"engine", engine.engine},
                     {"variant", engine.variant},
                     {"version", adapter.version},
                     {"precision", variant_of(adapter, engine.variant).precision},
                     {"settings", live_settings(adapter, engine.variant, cases, knobs)}});
  }
  return array;
}

Expected<void> save_validation(const std::string& folder, const std::string& file, const Json& json,
                               const std::string& title, const std::vector<std::string>& arguments,
                               const std::vector<EngineVariant>& engines,
                               const Catalogues& catalogues) {
  Provenance provenance;
  provenance.command = shell_command(arguments);
  provenance.date_utc = now_utc();
  provenance.title = title;
  provenance.machine = this_machine();
  std::set<std::string> seen;
  for (const EngineVariant& engine : engines) {
    if (!seen.insert(engine.engine).second) continue;
    const Adapter& adapter = *find_adapter(catalogues, engine.engine);
    provenance.engines.push_back(
        {adapter.name, adapter.version, precision_text(adapter), adapter.own});
  }
  return write_folder(folder, {{file, json.dump(2) + '\n'},
                               {"provenance.json", to_json(provenance).dump(2) + '\n'}});
}

}  // namespace brickbench
