// Scope: the names that the formulas of a scene file may use, with their values; and what is read
// with it. All functions throw InputError, as readers of experiments/input do.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/input/input.hpp"
#include "experiments/scenarios/scenario.hpp"
#include "experiments/scenes/formula.hpp"

namespace brickbench {

struct Scope {
  std::vector<std::string> names;
  std::vector<double> values;                // (names)
  std::map<std::string, std::string> words;  // of the parameters that are words

  // Rejects a name that is none, or is taken.
  void add(const std::string& name, double value, const SourcePosition& at);
};

// Rejects what is not letters, digits and '_' with no digit first.
void check_name(const std::string& name, const SourcePosition& at);

// A number of the file, or a formula over a scope's names.
class Quantity {
 public:
  // `what` stands in the messages, with its key and unit's suffix: "mass_kg".
  Quantity(const InputValue& value, std::string what, const Scope& scope);

  // Finite; rejected at its place otherwise. The scope has the names of the one given above first.
  double in(const Scope& scope) const;

 private:
  SourcePosition at_;
  std::string what_;
  double number_ = 0.0;
  std::optional<Formula> formula_;
};

// Three numbers or formulas in an array.
class VectorQuantity {
 public:
  VectorQuantity(const InputValue& value, const std::string& what, const Scope& scope);
  Eigen::Vector3d in(const Scope& scope) const;

 private:
  std::vector<Quantity> parts_;
};

// The vector of that key; nullopt if the table has none.
std::optional<VectorQuantity> vector_of(const InputValue& table, const char* key,
                                        const Scope& scope);
std::optional<Quantity> quantity_of(const InputValue& table, const char* key, const Scope& scope);

// Text in which {name} stands for a whole number or a word of the scope, {{ and }} for braces.
class Template {
 public:
  Template(const InputValue& value, const std::string& what, const Scope& scope);
  std::string in(const Scope& scope) const;
  const SourcePosition& at() const { return at_; }

 private:
  struct Part {
    std::string text;
    bool is_name = false;
  };
  SourcePosition at_;
  std::vector<Part> parts_;
};

}  // namespace brickbench
