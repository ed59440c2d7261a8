// SceneNames: the labels of a folder's scenes, cut to what tells them apart.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "reports/src/summary.hpp"

namespace brickbench {

// "wall: courses=10, friction=0.5, step 0.001 s, 1 s" becomes "wall: courses=10" where only the
// courses vary within the experiment, and "wall" where nothing does.
class SceneNames {
 public:
  SceneNames() = default;
  explicit SceneNames(std::span<const Block> blocks);

  // Of scene_label() or family_label(); a label of no block is given back as it is.
  const std::string& brief(const std::string& label) const;

 private:
  std::map<std::string, std::string> brief_;
};

// The scene without its step: what a study of the step compares.
std::string family_label(const Block& block);

}  // namespace brickbench
