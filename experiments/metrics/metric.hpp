// Metric: watches a run step by step and says at the end what it saw. Memory does not grow with the
// length of the run, and nothing in here shares code with any engine.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/seam/simulation.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

// What a metric sees of one step. All spans are valid during observe() only.
struct Sample {
  std::size_t step = 0;  // 0: the initial state, before any step
  double time_s = 0.0;
  std::span<const State> states;                   // (bodies), order of World::bodies
  std::span<const Wrench> wrenches;                // (bodies), held during the step that ended here
  const std::vector<Contact>* contacts = nullptr;  // nullptr: the engine does not tell
  std::span<const Diagnostic> diagnostics = {};    // empty: the engine does not tell
  Flags flags = {};     // of the step that ended here: the engine's own, and what was seen of it
  Flags tellable = {};  // that could have been raised
  std::string_view passage =
      {};  // of the first body that passed another: "'a' through 'b'"; or empty
};

enum class Better { lower, higher, neither };

// One number that a metric yields: what it means and what a good value is.
struct OutputInfo {
  std::string name;  // snake_case with SI suffix, unique over all metrics
  std::string unit;
  Better better = Better::neither;
  std::string meaning;  // one line
  std::string good;     // what a good value is and why, one line
};

// A metric reports every output that it declares. Where there is no number, the value is NaN and
// the note begins with one of these, then says why.
inline constexpr std::string_view k_not_applicable = "not applicable: ";  // nothing to measure here
inline constexpr std::string_view k_not_finite = "not finite: ";          // the run diverged

struct Measurement {
  std::string name;  // of an OutputInfo; "diag_..." for what only the engine can name
  std::string unit;
  double value = 0.0;
  std::string note;  // empty, or where and when: "bodies 'a' and 'b' at 0.25 s"
};

// Whether the scene and the engine offer what this number needs.
inline bool applies(const Measurement& measurement) {
  return !measurement.note.starts_with(k_not_applicable);
}

class Metric {
 public:
  virtual ~Metric() = default;
  // Called for step 0 and after every step.
  virtual void observe(const Sample& sample) = 0;
  // Appends the numbers of the run so far.
  virtual void report(std::vector<Measurement>& out) const = 0;
  // Appends the numbers of the last sample that are worth a curve over time; may be nothing.
  virtual void trace(std::vector<Measurement>& out) const { (void)out; }
};

struct MetricInfo {
  std::string name;                 // "energy", "momentum", "penetration" ...
  std::string meaning;              // one or two sentences
  std::vector<OutputInfo> outputs;  // of report()
  std::vector<OutputInfo> curves;   // of trace()
  std::unique_ptr<Metric> (*make)(const Scene& scene, double step_s) = nullptr;
};

// experiments/metrics/catalog.cpp: one visible line per entry.
std::vector<MetricInfo> metrics();

}  // namespace brickbench
