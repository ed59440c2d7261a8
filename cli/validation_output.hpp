// Folders that `validate --out` saves and `report` reads.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/exact/cases/exact_case.hpp"
#include "experiments/run/catalogues.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {

// Per engine: version, precision, and the settings that its live object holds when it is built for
// the first of the cases that it takes; no settings where it takes none or shows none.
nlohmann::ordered_json audited_engines(const std::vector<EngineVariant>& engines,
                                       const Catalogues& catalogues,
                                       const std::vector<exact::ExactCase>& cases,
                                       const KnobValues& knobs);

// A new folder, whole or absent, with `json` as `file` and what made it as provenance.json.
Expected<void> save_validation(const std::string& folder, const std::string& file,
                               const nlohmann::ordered_json& json, const std::string& title,
                               const std::vector<std::string>& arguments,
                               const std::vector<EngineVariant>& engines,
                               const Catalogues& catalogues);

}  // namespace brickbench
