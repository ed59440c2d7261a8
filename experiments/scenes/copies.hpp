// Copies: how often an entry of a scene file stands for something, and which of them it is.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/scenes/scope.hpp"

namespace brickbench {

// No scene has more bodies, and no entry is tried more often.
inline constexpr std::size_t k_most_bodies = 100000;

// The keys `repeat` (a table of indices and how often each counts, 0 .. n - 1, the last fastest;
// a count may use the indices before it) and `when` (a formula: 0 leaves the copy out).
class Copies {
 public:
  // Adds the indices to the scope. `more`: indices of a grid, stack or ring, after those of
  // `repeat`. Throws InputError.
  struct Index {
    std::string name;
    Quantity count;
    SourcePosition at;
  };
  Copies(const InputValue& entry, Scope& scope);
  void add(Index index, Scope& scope);
  // Reads `when`, which may use all indices; the last to be called.
  void close(const InputValue& entry, const Scope& scope);

  bool any() const { return !indices_.empty(); }
  std::size_t depth() const { return indices_.size(); }
  // Calls `visit` for every copy with the indices set in `scope`; throws InputError.
  void each(Scope scope, const std::function<void(const Scope&)>& visit) const;
  // The values of the indices, "_2_0"; "" where there are none.
  std::string suffix(const Scope& scope) const;

 private:
  void step(std::size_t level, Scope& scope, std::size_t& tried,
            const std::function<void(const Scope&)>& visit) const;

  std::size_t first_ = 0;  // of the indices among the scope's names
  std::vector<Index> indices_;
  std::optional<Quantity> when_;
};

}  // namespace brickbench
