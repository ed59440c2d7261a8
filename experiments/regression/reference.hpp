// References: what a suite yielded when somebody last said that this is right, and why.
//
// One JSON file per experiment in <folder>/<suite>/, records in order of their key, so that a
// change of one number is a change of one record. The folder obtained/ of a check has the same
// format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adapters/seam/failure.hpp"

namespace brickbench::gate {

enum class Kind {
  hash,   // every bit, where engine version, precision and platform are those of the reference
  bound,  // a number and the bound of its change
  distribution,  // a sample over perturbed starts
};

std::string_view to_word(Kind kind);

// Who accepted the numbers, when, why, and what made them.
struct Blessing {
  std::string reason;
  std::string date_utc;
  std::string revision;
  std::string machine;
  std::string compiler;
  bool operator==(const Blessing&) const = default;
};

struct Record {
  // Identity within the experiment.
  std::string engine;  // engine/variant
  std::string axes;    // "step_s=0.001;courses=3"
  std::string metric;  // empty for the state hash

  Kind kind = Kind::bound;
  std::string unit;
  std::string better;  // lower, higher or neither
  std::string outcome = "ok";
  // Of the first flagged start, as in Row; empty: valid; none: a reference of earlier times, which
  // does not say.
  std::optional<std::string> validity = "";
  std::vector<std::uint64_t> seeds;
  std::vector<double> values;       // (seeds); empty for hashes and outcomes without numbers
  std::vector<std::string> hashes;  // (seeds)
  // For bounds: the largest change that rounding-sized changes of the start make, and the bound.
  double residual = 0.0;
  double bound = 0.0;
  double margin = 0.0;  // for distributions: of equivalence of the means, in `unit`
  std::string why;      // how bound or margin follow
  std::string engine_version;
  std::string precision;
  std::string platform;  // architecture and compiler: hashes are compared on the same one alone
  Blessing blessed;

  std::string key() const { return engine + '|' + axes + '|' + metric; }
};

struct Suite {
  struct Experiment {
    std::string name;
    std::vector<Record> records;  // by key
  };
  std::vector<Experiment> experiments;

  const Record* find(const std::string& experiment, const std::string& key) const;
};

std::string to_text(const Suite::Experiment& experiment);

// Fault::invalid with file and line of a damaged record, and if the folder cannot be listed; a
// suite without experiments if the folder is not there.
Expected<Suite> read_suite(const std::filesystem::path& folder);

// Writes obtained numbers into a new folder.
Expected<void> write_suite(const std::filesystem::path& folder, const Suite& suite);

}  // namespace brickbench::gate
