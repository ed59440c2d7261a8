// Record: what a hunt has judged and found so far, and the file that it grows by.
//
// progress.jsonl: the first line says what is hunted; each further one is a trial that was judged,
// in order of its number, or a find that was shrunk. A last line that was cut short does not count.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "experiments/hunt/shrink.hpp"

namespace brickbench::hunt {

// What is hunted: the same questions give the same trials, in the same order.
struct Quarry {
  std::uint64_t seed = 1;
  std::vector<EngineVariant> engines;
  std::vector<std::string> scenes;  // names of scenarios, in the order of the catalogue
  std::vector<std::string> cases;   // ids of exact cases

  bool operator==(const Quarry&) const = default;
};

// A law that was broken, in a trial of the hunt; to be shrunk.
struct Find {
  std::uint64_t number = 0;  // of the trial
  std::string oracle;
  Trial trial;
  Verdict verdict;
};

// So many trials of a kind (oracle, engine, scene) are shrunk; the others are counted.
inline constexpr std::uint64_t k_shrunk_of_kind = 4;

class Record {
 public:
  // A trial was judged; in order of `number`. Returns the places of the new finds.
  std::vector<std::size_t> add(std::uint64_t number, const Trial& trial, const Verdict& verdict);
  void add(std::size_t find, Shrunk shrunk) { shrunk_[find] = std::move(shrunk); }

  std::uint64_t judged() const { return judged_; }
  // Of the trials, by their words.
  const std::map<std::string, std::uint64_t>& outcomes() const { return outcomes_; }
  const std::vector<Find>& finds() const { return finds_; }
  const std::map<std::size_t, Shrunk>& shrunk() const { return shrunk_; }
  // How many trials broke which law, by kind_key(); `told`: those that had said themselves, by
  // outcome or flag, that something went wrong.
  const std::map<std::string, std::uint64_t>& seen() const { return seen_; }
  const std::map<std::string, std::uint64_t>& told() const { return told_; }

 private:
  std::uint64_t judged_ = 0;
  std::map<std::string, std::uint64_t> outcomes_;
  std::vector<Find> finds_;
  std::map<std::size_t, Shrunk> shrunk_;
  std::map<std::string, std::uint64_t> seen_;
  std::map<std::string, std::uint64_t> told_;
};

// "oracle | engine/variant | scene"
std::string kind_key(std::string_view oracle, const Trial& trial);

// The file in `folder`. Failures are Fault::invalid (damaged, or of another hunt) or
// Fault::crashed (cannot be written).
class ProgressFile {
 public:
  // Begins the file; the folder is made and must not exist.
  static Expected<ProgressFile> create(const std::filesystem::path& folder, const Quarry& quarry);
  // Reads what is there into `record`.
  static Expected<ProgressFile> resume(const std::filesystem::path& folder, const Quarry& quarry,
                                       Record& record);
  Expected<void> append(std::uint64_t number, const Trial& trial, const Verdict& verdict) const;
  Expected<void> append(std::size_t find, const Shrunk& shrunk) const;

 private:
  explicit ProgressFile(std::filesystem::path file) : file_(std::move(file)) {}
  Expected<void> write_line(const std::string& line) const;
  std::filesystem::path file_;
};

}  // namespace brickbench::hunt
