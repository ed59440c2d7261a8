// Findings: the finds of a hunt, one for each cause, each with the smallest trial that shows it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/exact/validation/open_questions.hpp"
#include "experiments/hunt/record.hpp"

namespace brickbench::hunt {

struct Finding {
  std::string id;  // oracle-engine-variant-scene, with a number where that stands twice
  std::string oracle;
  std::string needed;       // cause.hpp
  Shrunk shrunk;            // the least burdensome of this cause
  std::uint64_t trial = 0;  // number of the trial that it came from
  std::uint64_t finds = 0;  // shrunk trials of this cause
  std::uint64_t seen = 0;   // trials of this hunt that broke this law in this engine and scene
  std::string question;     // the open question that the case is known by; empty: it is new

  const Breach& breach() const { return *shrunk.verdict.find(oracle); }
};

// By engine, then law, then scene. Of exact cases those are known that `questions` name.
std::vector<Finding> findings(const Record& record, const Catalogues& catalogues,
                              const std::vector<exact::OpenQuestion>& questions = {});

// How many are not known by an open question.
std::size_t new_findings(const std::vector<Finding>& findings);

// Writes ID.toml for each into `folder`. `origin` says where the finding comes from.
Expected<void> write_plans(const std::filesystem::path& folder,
                           const std::vector<Finding>& findings, const std::string& origin);

// The record in one object: findings, counts, what was told.
std::string summary_json(const Quarry& quarry, const Record& record,
                         const std::vector<Finding>& findings);

}  // namespace brickbench::hunt
