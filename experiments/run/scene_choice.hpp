// Which scene an experiment or a cell means: one of the catalogue, or one of a file.
#pragma once

#include <memory>

#include "experiments/input/input.hpp"
#include "experiments/run/catalogues.hpp"

namespace brickbench {

// A scene of a file, shared by an experiment and its cells.
using FileScene = std::shared_ptr<const Scenario>;

struct SceneChoice {
  const Scenario* scenario = nullptr;  // in the catalogue, or `file`
  FileScene file;                      // null: compiled
};

// `name`: that of a compiled scene, or the path of a scene file, relative to the folder of the file
// in which the name stands. A file must not be called like a compiled scene: rows could not tell
// them apart.
Checked<SceneChoice> choose_scene(const InputValue& name, const Catalogues& catalogues);
// The same for a name of the command line; `option` stands in the complaint.
Checked<SceneChoice> choose_scene(const std::string& name, const std::string& option,
                                  const Catalogues& catalogues);

// The scene of `of`, an Experiment or a Cell.
template <typename Of>
const Scenario& scenario_of(const Of& of, const Catalogues& catalogues) {
  return of.file_scene ? *of.file_scene : *find_scenario(catalogues, of.scenario);
}

}  // namespace brickbench
