// The inner loops of the direct solvers: products with the sparse Jacobian, assembly of
// H = M + J^T D J in 6x6 blocks, and the block Cholesky factorisation of H.
//
// Two implementations of each: SIMD (Highway, chosen at run time for the processor) and a scalar
// twin that states the same algorithm plainly and serves as the oracle of tests.
//
// Layout. Per-body vectors hold 8 doubles per body, [linear 3, angular 3, 0, 0]; one more body at
// the end stands for everything fixed and stays zero. A 6x6 block is 48 doubles, column by column
// with leading dimension 8. Per-contact vectors are component by component: x[k * stride + i] is
// component k of contact i; stride is a multiple of 8 and padding contacts are inert.
#pragma once

#include <cstdint>
#include <vector>

#include "ourengine/linear/aligned.hpp"
#include "ourengine/linear/fronts.hpp"

namespace ourengine {

inline constexpr int kBodyStride = 8;
inline constexpr int kBlockSize = 48;

// Pattern of a lower block-triangular factor, by columns; the diagonal block comes first.
struct BlockPattern {
  int columns = 0;
  std::vector<int> column_begin;  // columns + 1, into `row`
  std::vector<int> row;           // block row of each stored block, ascending in a column
  std::vector<int> row_begin;     // columns + 1, into the two below
  std::vector<int> row_column;    // columns k < j with a block in row j ...
  std::vector<int> row_block;     // ... and that block's index
};

// Contacts between one pair of bodies, consecutive in the contact order.
struct ContactPair {
  int body_a = 0;  // index of the per-body vectors
  int body_b = 0;
  int begin = 0;
  int end = 0;
};

// Read-only view of a compiled contact system (system.hpp).
struct SystemView {
  int bodies = 0;  // dynamic ones
  int contacts = 0;
  int stride = 0;                          // of per-contact vectors
  int components = 1;                      // rows per contact: 1 (normal) or 3
  const double* geometry = nullptr;        // 15 x stride: n, t1, t2, arm a, arm b; x y z each
  const std::int64_t* offset_a = nullptr;  // stride: 8 * index of body a
  const std::int64_t* offset_b = nullptr;
  const double* rows = nullptr;  // 16 per row (contact major): J towards a in 0..5, b in 8..13
  const double* bias = nullptr;  // stride: bias of the normal row
  const double* tangent_bias = nullptr;  // 2 x stride
  const ContactPair* pairs = nullptr;
  int pair_count = 0;
  const double* mass = nullptr;  // one 6x6 block per body
};

// A pair of moving bodies in the front that eliminates the first of them.
struct FrontPair {
  int pair = 0;
  int row = 0;  // local block row of the later body
  int column = 0;
  bool a_below = false;  // the later body is a
};

// A pair as one of its bodies has it.
struct PairSide {
  int pair = 0;
  bool of_b = false;
};

// The fronts of a compiled contact system.
struct FrontalView {
  const FrontPattern* fronts = nullptr;
  const FrontPair* pairs = nullptr;  // front by front
  const int* pair_begin = nullptr;   // fronts + 1
  const PairSide* sides = nullptr;   // body by body
  const int* side_begin = nullptr;   // bodies + 1
};

// Where the blocks of a pair go in the LU factor.
struct PairTarget {
  int diagonal_a = -1;  // block index, or -1 if the body is fixed
  int diagonal_b = -1;
  int off_diagonal = -1;  // -1 unless both move
  bool a_below = false;   // the off-diagonal block has the rows of a (else of b)
};

struct Kernels {
  const char* name;
  // w = J v (+ bias if `with_bias`); w: components x stride.
  void (*multiply_j)(const SystemView& system, const double* v, bool with_bias, double* w);
  // g += J^T f.
  void (*multiply_jt)(const SystemView& system, const double* f, double* g);

  // Cholesky factorisation of H = M + J^T D J, by fronts (fronts.hpp): fronts task.begin .. end, of
  // which the children outside the task are done. D per contact: components == 1: one number;
  // components == 3: symmetric, 00 01 02 11 12 22, each with `stride`. Leaves the panels, where
  // diagonal blocks hold the inverse of their factor. False if a pivot was not positive (the factor
  // is then of a modified matrix).
  bool (*factor_fronts)(const SystemView& system, const FrontalView& fronts, const double* d,
                        FrontTask task, const FrontStores& stores);
  // x = L^-1 x and x = L^-T x, 8 doubles per column; tasks forward in order, backward in reverse.
  // `vectors` is work.
  void (*solve_fronts_forward)(const FrontalView& fronts, FrontTask task, const double* panels,
                               double* vectors, double* x);
  void (*solve_fronts_backward)(const FrontalView& fronts, FrontTask task, const double* panels,
                                double* vectors, double* x);

  // LU factorisation of H with weights D that are not symmetric (3 components, D_kl at
  // (3 k + l) * stride): H = L U without pivoting between blocks. `lower` holds H's lower part,
  // `upper` the transpose of its upper part, both on the pattern; the diagonal is in `lower`, where
  // the factorisation leaves its inverse. False if a diagonal block was singular.
  void (*assemble_general)(const SystemView& system, const double* d, const PairTarget* targets,
                           const BlockPattern& pattern, double* lower, double* upper);
  bool (*factor_general)(const BlockPattern& pattern, int* scratch_columns, double* lower,
                         double* upper);
  void (*solve_general)(const BlockPattern& pattern, const double* lower, const double* upper,
                        double* x);
};

// In place: the inverse of a general 6x6 block. False (block unchanged) if it is singular.
bool invert_general_block(double* block);

// The best implementation for this processor.
const Kernels& simd_kernels();
// The plain twin.
const Kernels& scalar_kernels();

}  // namespace ourengine
