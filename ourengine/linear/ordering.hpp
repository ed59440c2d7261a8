// Elimination order and symbolic factorisation of the block matrix M + J^T D J, whose graph has
// the dynamic bodies as vertices and their contact pairs as edges.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "ourengine/linear/kernels.hpp"

namespace ourengine {

struct BodyGraph {
  int bodies = 0;
  std::vector<std::pair<int, int>> edges;  // (smaller, larger), ascending, each once
  bool operator==(const BodyGraph&) const = default;
  auto operator<=>(const BodyGraph&) const = default;
};

struct SymbolicFactor {
  std::vector<int> position;  // of each body in the elimination order
  BlockPattern pattern;       // by single columns
  FrontPattern fronts;        // of the same factor
  double flops = 0.0;         // of one factorisation, useful ones
};

// Order: approximate minimum degree (Amestoy, Davis, Duff 1996, through Eigen) below
// kNestedDissectionBodies, nested dissection (Karypis, Kumar 1998, METIS) from there on; then a
// postorder of the elimination tree. Deterministic.
SymbolicFactor analyse(const BodyGraph& graph);

inline constexpr int kNestedDissectionBodies = 1000;

// Keeps the symbolic factors of the graphs seen lately, so that an unchanged contact graph costs
// nothing in the next step.
class SymbolicCache {
 public:
  std::shared_ptr<const SymbolicFactor> find_or_analyse(const BodyGraph& graph);
  int analyses() const { return analyses_; }

 private:
  struct Entry {
    std::shared_ptr<const SymbolicFactor> factor;
    long last_use = 0;
  };
  std::map<BodyGraph, Entry> entries_;
  long clock_ = 0;
  int analyses_ = 0;
};

}  // namespace ourengine
