// Random block assemblies with a strict label: walls and towers that stand, or fall, with a margin.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/oracle/static_truth.hpp"

namespace brickbench::gate {

struct LabelledAssembly {
  std::string family;  // "tower", "leaning_courses", "missing_bricks", "overhang"
  std::uint64_t seed = 0;
  World world;
  StaticVerdict verdict;
};

// `count` random assemblies: families in turn, and in each family one that stands and one that
// falls in turn. Those without the margin on their side are drawn again; fewer than `count` come
// back only if a thousand draws in a row yield none.
std::vector<LabelledAssembly> labelled_assemblies(std::size_t count, std::uint64_t seed,
                                                  const Margins& margins = {});

}  // namespace brickbench::gate
