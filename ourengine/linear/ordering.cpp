#include "ourengine/linear/ordering.hpp"

#include <metis.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <numeric>

namespace ourengine {
namespace {

constexpr std::size_t kCacheEntries = 256;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Elimination order by minimum degree: order[k] is the body eliminated k-th.
std::vector<int> minimum_degree(const BodyGraph& graph) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < graph.bodies; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [a, b] : graph.edges) {
    entries.emplace_back(a, b, 1.0);
    entries.emplace_back(b, a, 1.0);
  }
  Eigen::SparseMatrix<double> matrix(graph.bodies, graph.bodies);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(matrix, permutation);
  return {permutation.indices().data(), permutation.indices().data() + graph.bodies};
}

std::vector<int> nested_dissection(const BodyGraph& graph) {
  std::vector<std::vector<idx_t>> neighbours(at(graph.bodies));
  for (const auto& [a, b] : graph.edges) {
    neighbours[at(a)].push_back(b);
    neighbours[at(b)].push_back(a);
  }
  std::vector<idx_t> begin{0}, adjacency;
  for (const auto& list : neighbours) {
    adjacency.insert(adjacency.end(), list.begin(), list.end());
    begin.push_back(static_cast<idx_t>(adjacency.size()));
  }
  idx_t vertices = graph.bodies;
  std::vector<idx_t> order(at(graph.bodies)), position(at(graph.bodies));
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  const int status = METIS_NodeND(&vertices, begin.data(), adjacency.data(), nullptr, options,
                                  order.data(), position.data());
  if (status != METIS_OK) return minimum_degree(graph);  // same factor, only more of it
  return {order.begin(), order.end()};
}

// Neighbours of each position that come later in the order.
std::vector<std::vector<int>> later_neighbours(const BodyGraph& graph,
                                               const std::vector<int>& position) {
  std::vector<std::vector<int>> later(at(graph.bodies));
  for (const auto& [a, b] : graph.edges) {
    const auto [first, second] = std::minmax(position[at(a)], position[at(b)]);
    later[at(first)].push_back(second);
  }
  return later;
}

// Rows below the diagonal of each column of the factor, ascending (George, Liu 1981): a column has
// the rows of the matrix and those of its children in the elimination tree.
std::vector<std::vector<int>> column_rows(const std::vector<std::vector<int>>& later) {
  const int n = static_cast<int>(later.size());
  std::vector<std::vector<int>> rows(at(n)), children(at(n));
  std::vector<int> mark(at(n), -1);
  for (int j = 0; j < n; ++j) {
    std::vector<int>& own = rows[at(j)];
    const auto add = [&](int i) {
      if (i > j && mark[at(i)] != j) {
        mark[at(i)] = j;
        own.push_back(i);
      }
    };
    for (const int i : later[at(j)]) add(i);
    for (const int child : children[at(j)]) {
      for (const int i : rows[at(child)]) add(i);
    }
    std::sort(own.begin(), own.end());
    if (!own.empty()) children[at(own.front())].push_back(j);
  }
  return rows;
}

// Postorder of the elimination tree, children in ascending order: new_of_old.
std::vector<int> postorder(const std::vector<std::vector<int>>& rows) {
  const int n = static_cast<int>(rows.size());
  std::vector<std::vector<int>> children(at(n + 1));
  for (int j = n - 1; j >= 0; --j)
    children[at(rows[at(j)].empty() ? n : rows[at(j)].front())].push_back(j);
  std::vector<int> new_of_old(at(n));
  std::vector<int> stack{n};
  int next = n;  // a reversed preorder with reversed children is a postorder
  while (!stack.empty()) {
    const int j = stack.back();
    stack.pop_back();
    if (j < n) new_of_old[at(j)] = --next;
    for (auto child = children[at(j)].rbegin(); child != children[at(j)].rend(); ++child)
      stack.push_back(*child);
  }
  return new_of_old;
}

BlockPattern pattern_of(const std::vector<std::vector<int>>& rows) {
  BlockPattern pattern;
  pattern.columns = static_cast<int>(rows.size());
  pattern.row_begin.assign(rows.size() + 1, 0);
  for (int j = 0; j < pattern.columns; ++j) {
    pattern.column_begin.push_back(static_cast<int>(pattern.row.size()));
    pattern.row.push_back(j);
    for (const int i : rows[at(j)]) {
      pattern.row.push_back(i);
      ++pattern.row_begin[at(i + 1)];
    }
  }
  pattern.column_begin.push_back(static_cast<int>(pattern.row.size()));
  std::partial_sum(pattern.row_begin.begin(), pattern.row_begin.end(), pattern.row_begin.begin());
  pattern.row_column.resize(at(pattern.row_begin.back()));
  pattern.row_block.resize(at(pattern.row_begin.back()));
  std::vector<int> next = pattern.row_begin;
  for (int j = 0; j < pattern.columns; ++j) {
    for (int q = pattern.column_begin[at(j)] + 1; q < pattern.column_begin[at(j + 1)]; ++q) {
      const int slot = next[at(pattern.row[at(q)])]++;
      pattern.row_column[at(slot)] = j;
      pattern.row_block[at(slot)] = q;
    }
  }
  return pattern;
}

}  // namespace

SymbolicFactor analyse(const BodyGraph& graph) {
  const std::vector<int> order =
      graph.bodies >= kNestedDissectionBodies ? nested_dissection(graph) : minimum_degree(graph);
  SymbolicFactor factor;
  factor.position.resize(at(graph.bodies));
  for (int k = 0; k < graph.bodies; ++k) factor.position[at(order[at(k)])] = k;
  const std::vector<int> renumber =
      postorder(column_rows(later_neighbours(graph, factor.position)));
  for (int& position : factor.position) position = renumber[at(position)];
  const auto rows = column_rows(later_neighbours(graph, factor.position));
  factor.pattern = pattern_of(rows);
  factor.fronts = make_fronts(rows);
  for (const auto& column : rows) {
    const double below = static_cast<double>(column.size());
    factor.flops += below * (below + 1.0) / 2.0 * 432.0 + below * 216.0 + 72.0;
  }
  return factor;
}

std::shared_ptr<const SymbolicFactor> SymbolicCache::find_or_analyse(const BodyGraph& graph) {
  ++clock_;
  const auto found = entries_.find(graph);
  if (found != entries_.end()) {
    found->second.last_use = clock_;
    return found->second.factor;
  }
  if (entries_.size() >= kCacheEntries) {
    entries_.erase(std::min_element(
        entries_.begin(), entries_.end(),
        [](const auto& a, const auto& b) { return a.second.last_use < b.second.last_use; }));
  }
  ++analyses_;
  auto factor = std::make_shared<const SymbolicFactor>(analyse(graph));
  entries_[graph] = {factor, clock_};
  return factor;
}

}  // namespace ourengine
