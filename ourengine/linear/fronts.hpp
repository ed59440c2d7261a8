// Symbolic part of the multifrontal Cholesky factorisation: which columns are eliminated together
// in which dense front, and where everything lies.
//
// A front holds the columns `first .. first + columns` of the factor on a common set of block rows.
// Its panel (those columns, dense, column by column with leading dimension `lead`, 6 scalar rows
// per block row) is kept; its update matrix (what it subtracts from the columns of later rows) is
// handed to the parent and forgotten (Duff, Reid, The multifrontal solution of indefinite sparse
// symmetric linear equations, 1983; Liu, The multifrontal method for sparse matrix solution, 1992).
#pragma once

#include <cstddef>
#include <vector>

namespace ourengine {

struct Front {
  int first = 0;    // block column
  int columns = 0;  // eliminated here, at least one
  int rows = 0;     // block rows: the columns, then those below
  int row_begin = 0;
  int child_begin = 0, child_end = 0;  // into FrontPattern::child
  int run_begin = 0, run_end = 0;      // into FrontPattern::run
  // In doubles; `lead` and `skip` are multiples of 8. The update matrix keeps the rows of the panel
  // from `skip` on, so that rows stay aligned.
  std::size_t lead = 0;    // of the panel
  std::size_t skip = 0;    // scalar rows of the panel that the update matrix leaves out
  std::size_t panel = 0;   // in the store of panels
  std::size_t update = 0;  // in the store of updates, or in the scratch of its subtree
  bool in_scratch = false;
  std::size_t vector = 0;  // in the store of vectors: `lead` entries

  std::size_t update_lead() const { return lead - skip; }
};

// A front in memory while it is worked on. Rows and columns are scalar ones of the front, and only
// the lower part has a meaning.
struct FrontWork {
  const Front& front;
  double* panel;
  double* update;

  std::size_t pivots() const { return 6 * static_cast<std::size_t>(front.columns); }
  std::size_t rows() const { return 6 * static_cast<std::size_t>(front.rows); }
  double* entry(std::size_t row, std::size_t column) const {
    if (column < pivots()) return panel + column * front.lead + row;
    return update + (column - pivots()) * front.update_lead() + (row - front.skip);
  }
  std::size_t lead(std::size_t column) const {
    return column < pivots() ? front.lead : front.update_lead();
  }
};

// Where the parts of fronts are while they are worked on.
struct FrontStores {
  double* panels = nullptr;
  double* updates = nullptr;
  double* scratch = nullptr;
};

inline FrontWork work_on(const Front& front, const FrontStores& stores) {
  return {front, stores.panels + front.panel,
          (front.in_scratch ? stores.scratch : stores.updates) + front.update};
}

// Consecutive block rows of a front that are consecutive in its parent as well.
struct FrontRun {
  int from = 0;  // local row of the front, at least `columns`
  int to = 0;    // local row of the parent
  int length = 0;
};

// Fronts begin .. end, in order.
struct FrontTask {
  int begin = 0;
  int end = 0;
};

struct FrontPattern {
  std::vector<Front> front;  // children before parents
  std::vector<int> row;      // block rows of each front, ascending
  std::vector<int> child;
  std::vector<FrontRun> run;
  std::vector<int> front_of_column;
  // Subtrees that can be done in any order, and at once, the largest last; then the rest, in order.
  // Whatever the order, every front sees the same numbers.
  std::vector<FrontTask> subtree, rest;
  // Scratch for any one subtree: as many as are done at once are needed.
  std::size_t panel_doubles = 0, update_doubles = 0, scratch_doubles = 0, vector_doubles = 0;
  double flops = 0.0;  // of a factorisation, with those on zeros that fronts store
};

// below[j]: the block rows below the diagonal of column j of the factor, ascending; columns in
// postorder of the elimination tree.
FrontPattern make_fronts(const std::vector<std::vector<int>>& below);

}  // namespace ourengine
