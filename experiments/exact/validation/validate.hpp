// Validation: a case run in an engine, and its errors split into what the engine's documented
// scheme explains and what nothing explains.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adapters/seam/adapter.hpp"
#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// Bounds of the unexplained part, relative to the scale of the observable: rounding accumulated
// over some thousand steps; with a contact, the convergence of an iterative solver and rounding of
// the contact geometry on top.
inline constexpr double k_contact_free_bound = 1e-9;
inline constexpr double k_contact_bound = 1e-6;
// Width of the bracket of a critical parameter, relative.
inline constexpr double k_threshold_width = 1e-4;

struct Score {
  std::string observable;
  std::string unit;
  double truth = 0.0;  // continuous; NaN where there is none for these parameters
  double scale = 1.0;
  std::optional<double> predicted;  // by the scheme
  double measured = 0.0;            // NaN: the event did not happen
  // Relative to the scale.
  double error = 0.0;                 // measured - truth
  std::optional<double> explained;    // predicted - truth
  std::optional<double> unexplained;  // measured - predicted
};

// The critical parameter lies between low and high: the event happened at one and not at the other.
struct Bracket {
  std::string parameter;
  std::string unit;
  double truth = 0.0;
  double low = 0.0;
  double high = 0.0;
  bool found = false;  // the event happens, or not, at both ends of the search
};

struct CellResult {
  std::string engine;
  std::string variant;
  std::string case_id;
  std::string outcome = "ok";  // or to_outcome(fault), or "audit": a fact did not arrive
  std::string reason;
  std::string no_prediction;  // why the scheme predicts nothing; empty if it does
  double bound = 0.0;         // for the unexplained parts
  std::vector<Score> scores;
  std::string law;  // of impact, as ExactCase::classify names it; empty where there is no choice
  std::optional<Bracket> bracket;

  // A failed cell, or an unexplained part above the bound. A refusal is not a failure: the engine
  // said beforehand that it cannot.
  bool failed() const;
  // The largest unexplained part; nullopt without prediction or measurement.
  std::optional<double> worst_unexplained() const;
};

// Settings with the variant filled in.
Settings settings_of(const Adapter& adapter, const std::string& variant, const ExactRun& run,
                     const KnobValues& knobs = {});

// What the scheme of this engine predicts for a run of the case: truths and predictions, no
// measurement. Builds and runs no engine.
CellResult predict(const Adapter& adapter, const std::string& variant, const ExactCase& exact_case,
                   const ExactRun& run, const KnobValues& knobs = {});

// Builds, audits, runs, measures at the given values.
CellResult validate_at(const Adapter& adapter, const std::string& variant,
                       const ExactCase& exact_case, const ParameterValues& given,
                       const KnobValues& knobs = {});

// ... and bisects where the case has a threshold.
CellResult validate(const Adapter& adapter, const std::string& variant, const ExactCase& exact_case,
                    const ParameterValues& given = {}, const KnobValues& knobs = {});

// The observables of one run in one engine, after the audit: Fault::invalid names the facts that
// did not arrive.
Expected<std::vector<double>> measure(const Adapter& adapter, const std::string& variant,
                                      const ExactCase& exact_case, const ExactRun& run,
                                      const KnobValues& knobs = {});

// "all", "family.*", or an id; empty if nothing fits.
std::vector<ExactCase> select_cases(const std::vector<ExactCase>& cases,
                                    const std::string& selector);

}  // namespace brickbench::exact
