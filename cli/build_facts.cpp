#include "cli/build_facts.hpp"

#include <algorithm>
#include <sstream>

#include "adapters/catalog.hpp"

namespace brickbench {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

}  // namespace

Catalogues all_catalogues() {
  Catalogues catalogues{.scenarios = scenarios(),
                        .metrics = metrics(),
                        .adapters = adapters(),
                        .known_engines = split(BRICKBENCH_ENGINES_KNOWN, ',')};
  for (const Adapter& adapter : catalogues.adapters) {
    auto& known = catalogues.known_engines;
    if (std::ranges::find(known, adapter.name) == known.end()) known.push_back(adapter.name);
  }
  return catalogues;
}

std::vector<AbsentEngine> absent_engines(const Catalogues& catalogues) {
  std::vector<AbsentEngine> absent;
  for (const std::string& name : catalogues.known_engines) {
    if (find_adapter(catalogues, name) == nullptr) {
      const auto why = catalogues.why_absent.find(name);
      absent.push_back({name, "", why == catalogues.why_absent.end() ? "" : why->second});
    }
  }
  for (const std::string& entry : split(BRICKBENCH_ENGINES_MISSING, ',')) {
    const auto colon = entry.find(':');
    for (AbsentEngine& engine : absent) {
      if (engine.name == entry.substr(0, colon)) engine.packages = entry.substr(colon + 1);
    }
  }
  return absent;
}

}  // namespace brickbench
