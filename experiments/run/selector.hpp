// Selector: which engines and variants a plan means.
//
//   all              every linked engine in its default variant
//   bullet           that engine in its default variant
//   bullet/nncg      that variant
//   bullet/*         all variants of that engine
//   */default        the variant of that name of every linked engine that has one
//   */*              everything
#pragma once

#include <string>
#include <vector>

#include "experiments/input/input.hpp"
#include "experiments/run/catalogues.hpp"

namespace brickbench {

struct Selector {
  std::string text;
  std::string engine;   // "*": any
  std::string variant;  // "*": any; empty: the default one
  SourcePosition at;
};

struct EngineVariant {
  std::string engine;
  std::string variant;

  bool operator==(const EngineVariant&) const = default;
  std::string label() const { return engine + '/' + variant; }
};

// An error for an engine that the project does not know, or a variant that a linked engine does not
// have. `must_be_linked`: also for a named engine that this build lacks.
Checked<Selector> parse_selector(const std::string& text, const SourcePosition& at,
                                 const Catalogues& catalogues, bool must_be_linked);

// The same for readers of input trees (input.hpp), who reject by throwing InputError.
Selector expect_selector(const std::string& text, const SourcePosition& at,
                         const Catalogues& catalogues, bool must_be_linked);

// In the order of the catalogue; may be empty.
std::vector<EngineVariant> select(const Selector& selector, const Catalogues& catalogues);

}  // namespace brickbench
