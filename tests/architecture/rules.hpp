// The rules of the house: what may include what, and what must not be mixed.
#pragma once

#include <string>
#include <vector>

#include "tests/architecture/tree.hpp"

namespace brickbench::architecture {

struct Finding {
  std::string rule;
  std::string path;
  std::string reason;
};

// Arrows run one way: a file includes only what its room may see, and an engine's own headers stand
// only in the adapter of that engine.
std::vector<Finding> check_includes(const Tree& tree);
// Inside ourengine/ and experiments/ rooms lie on floors: each sees itself and the floors below its
// own, and no folder lies on none.
std::vector<Finding> check_floors(const Tree& tree);
// Outside adapters/ and tests, no string names an engine; in tests other than those of the adapters
// nothing is compared with one.
std::vector<Finding> check_engine_names(const Tree& tree);
// No path names both an engine and a scenario.
std::vector<Finding> check_mixed_paths(const Tree& tree);
// C++, CMake and shell files stay short enough to read: 450 lines.
std::vector<Finding> check_lengths(const Tree& tree);
// In a namespace, one name stands for one type in all files: linked together, two would silently be
// taken for one. Types in an unnamed namespace, or declared without a body, do not count.
std::vector<Finding> check_type_names(const Tree& tree);
// Branches on the shape of a body are exhaustive: no get_if or holds_alternative of a shape of the
// seam or of ourengine, so that a new shape does not compile until every place has its case.
std::vector<Finding> check_shapes(const Tree& tree);
// An engine is stepped in one place, experiments/step, and where the rules of the seam are asked:
// only there do blows act, times count, and states that are not finite end a run, in the same way
// for all who look.
std::vector<Finding> check_stepping(const Tree& tree);
// Markdown of the root and of docs/ names, in `backquotes`, only files and folders that exist.
std::vector<Finding> check_documents(const Tree& tree);

// Files over the 350 lines that an adapter with all four views is meant to have: told, not failed.
std::vector<Finding> long_adapters(const Tree& tree);

// Engines, from adapters/*.cmake, and scenarios, from the catalogue of scenes.
std::vector<std::string> engine_names(const Tree& tree);
std::vector<std::string> scenario_names(const Tree& tree);

}  // namespace brickbench::architecture
