// Provenance: what made a results folder. The date and the command line live here and never in
// rows.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/seam/failure.hpp"

namespace brickbench {

// How this binary was built and on what it runs.
struct Machine {
  std::string revision;  // of the source: git commit, with "-dirty.<hash of the changes>"
  std::string compiler;
  std::string flags;
  std::string build_type;
  std::string cpu;  // model name
  std::string architecture;
  unsigned cores = 0;  // that this process may use
  std::string system;  // distribution and kernel

  // The short text of the `machine` column.
  std::string label() const { return cpu + ", " + architecture; }
};

Machine this_machine();

struct EngineRecord {
  std::string name;
  std::string version;
  std::string precision;
  bool own = false;  // written by this project: its losses are reported first
};

// What a number means, for the report.
struct MetricRecord {
  std::string name;
  std::string unit;
  std::string group;
  std::string better;
  std::string meaning;
  std::string good;
};

// One setting of an engine: what the plan and the adapter asked for, and what the live engine has.
struct MethodFact {
  std::string name;
  std::string unit;
  std::string asked;  // "not stated" where the adapter says nothing
  std::string used;   // "unsupported" where the engine cannot be read back
  bool operator==(const MethodFact&) const = default;
};

// The method of an engine in one or more cells.
struct MethodRecord {
  std::string engine;  // engine/variant
  std::vector<MethodFact> facts;
  bool operator==(const MethodRecord&) const = default;
};

// A scene that a file says, as it was when it was run.
struct SceneRecord {
  std::string name;
  std::string file;
  std::string hash;  // XXH3-128 of the text
  std::string text;  // of the file
  bool operator==(const SceneRecord&) const = default;
};

inline constexpr std::string_view k_not_stated = "not stated";
inline constexpr std::string_view k_unsupported = "unsupported";

struct Provenance {
  std::string command;   // as typed, quoted for a shell
  std::string date_utc;  // ISO 8601
  std::string plan;      // file
  std::string title;
  std::string analysis;
  Machine machine;
  std::vector<EngineRecord> engines;
  std::vector<MetricRecord> metrics;
  std::vector<MethodRecord> methods = {};      // of the cells that were run, each once
  std::vector<std::string> engine_files = {};  // named beside the plan, as typed
  std::vector<std::string> set = {};           // what the command set beside the plan: "key=value"
  std::vector<SceneRecord> scenes = {};        // of files, each once
};

nlohmann::ordered_json to_json(const Machine& machine);
nlohmann::ordered_json to_json(const Provenance& provenance);
// Fault::invalid if a key is missing or has the wrong type.
Expected<Provenance> provenance_from_json(const nlohmann::ordered_json& json);

// Now, as ISO 8601 in UTC.
std::string now_utc();

// The arguments joined so that a POSIX shell reads them back.
std::string shell_command(const std::vector<std::string>& arguments);

}  // namespace brickbench
