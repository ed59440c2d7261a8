// Arrangement: a row of copies of a body side by side, upon each other or round a circle.
#pragma once

#include <optional>

#include "experiments/scenes/copies.hpp"

namespace brickbench {

// One of the keys `grid`, `stack`, `ring` of a [[body]], or none of them.
class Arrangement {
 public:
  // Adds its indices to the copies: ix, iy, iz of a grid, k of a stack or ring. Throws InputError.
  Arrangement(const InputValue& entry, Copies& copies, Scope& scope);

  // Moves the pose of one copy (of half the height `reach_m` (m) along the world's z) to its place
  // in the arrangement. Copies come in the order of Copies::each.
  void place(const Scope& scope, double reach_m, State& pose);

 private:
  enum class Kind { none, grid, stack, ring };

  void read_grid(const InputValue& table, Copies& copies, Scope& scope);
  void read_stack(const InputValue& table, Copies& copies, Scope& scope);
  void read_ring(const InputValue& table, Copies& copies, Scope& scope);
  Eigen::Vector3d indices(const Scope& scope) const;

  Kind kind_ = Kind::none;
  std::size_t first_ = 0;  // of its indices among the scope's names
  std::optional<VectorQuantity> count_;
  std::optional<VectorQuantity> pitch_;
  bool centred_ = false;
  std::optional<Quantity> ring_count_;
  std::optional<Quantity> gap_;
  std::optional<Quantity> radius_;
  std::optional<Quantity> start_;
  std::optional<Quantity> turn_;
  int axis_ = 2;
  SourcePosition at_;
  double top_m_ = 0.0;  // of the stack so far
  double last_ = -1.0;  // index in the stack of the copy before
};

}  // namespace brickbench
