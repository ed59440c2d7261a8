#include "reports/src/scene_names.hpp"

#include <fmt/format.h>

#include <set>

namespace brickbench {
namespace {

// "a=1, b=2" as {"a=1", "b=2"}.
std::vector<std::string> axes_of(const std::string& axes) {
  std::vector<std::string> list;
  for (std::size_t at = 0; at < axes.size();) {
    const std::size_t end = std::min(axes.find(", ", at), axes.size());
    list.push_back(axes.substr(at, end - at));
    at = end + 2;
  }
  return list;
}

// What the scenes of one experiment have.
struct Values {
  std::set<std::string> scenes;                       // the whole text of their axes
  std::map<std::string, std::set<std::string>> axes;  // "name=value" -> the scenes that have it
  std::set<double> steps_s;
  std::set<double> durations_s;
};

void append(std::string& text, const std::string& part) {
  text += (text.empty() ? "" : ", ") + part;
}

}  // namespace

std::string family_label(const Block& block) {
  return fmt::format("{}{}{}, {} s", block.experiment, block.axes.empty() ? "" : ": ", block.axes,
                     block.duration_s);
}

SceneNames::SceneNames(std::span<const Block> blocks) {
  std::map<std::string, Values> experiments;
  for (const Block& block : blocks) {
    Values& values = experiments[block.experiment];
    values.scenes.insert(block.axes);
    for (const std::string& axis : axes_of(block.axes)) values.axes[axis].insert(block.axes);
    values.steps_s.insert(block.step_s);
    values.durations_s.insert(block.duration_s);
  }
  for (const Block& block : blocks) {
    const Values& values = experiments[block.experiment];
    std::string family;
    for (const std::string& axis : axes_of(block.axes)) {
      if (values.axes.at(axis).size() < values.scenes.size()) append(family, axis);
    }
    std::string scene = family;
    if (values.steps_s.size() > 1) append(scene, fmt::format("step {} s", block.step_s));
    for (std::string* text : {&family, &scene}) {
      if (values.durations_s.size() > 1) append(*text, fmt::format("{} s", block.duration_s));
      *text = block.experiment + (text->empty() ? "" : ": ") + *text;
    }
    brief_[family_label(block)] = family;
    brief_[scene_label(block)] = scene;
  }
}

const std::string& SceneNames::brief(const std::string& label) const {
  const auto found = brief_.find(label);
  return found == brief_.end() ? label : found->second;
}

}  // namespace brickbench
