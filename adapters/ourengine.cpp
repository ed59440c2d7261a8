// ourengine: the engine of this project, behind the same seam as the others.
//
// Choices (docs/engines/ourengine.md):
//  * baraff: the paper's system with overlap handling; paper: its plain choices. Both frictionless:
//    a world in which a pair may rub is refused, unless ignore_friction is 1.
//  * Refused: spheres, and several threads.
#include <algorithm>

#include "adapters/ourengine_variants.hpp"

namespace brickbench {
namespace {

struct Entry {
  Variant variant;
  Expected<std::unique_ptr<Simulation>> (*build)(const World&, const Settings&);
};

// One line per variant; the first is the default.
std::vector<Entry> entries() {
  return {
      {{"baraff", "the paper's system; overlaps are undone; Dantzig pivoting, frictionless"},
       &build_ourengine_baraff},
      {{"paper", "the paper's plain choices: no overlap handling; frictionless"},
       &build_ourengine_baraff},
  };
}

Expected<std::unique_ptr<Simulation>> build_ourengine(const World& world,
                                                      const Settings& settings) {
  if (auto ranges = check_ranges(k_ourengine_knobs, settings); !ranges) {
    return tl::make_unexpected(ranges.error());
  }
  const auto all = entries();
  const auto entry =
      std::ranges::find(all, settings.variant, [](const Entry& e) { return e.variant.name; });
  return entry->build(world, settings);
}

}  // namespace

Adapter ourengine_adapter() {
  Adapter adapter{.name = "ourengine",
                  .version = OURENGINE_VERSION,
                  .precision = "f64",
                  .variants = {},
                  .knobs = to_knobs(k_ourengine_knobs),
                  .build = &build_ourengine,
                  .own = true};
  for (const Entry& entry : entries()) adapter.variants.push_back(entry.variant);
  return adapter;
}

}  // namespace brickbench
