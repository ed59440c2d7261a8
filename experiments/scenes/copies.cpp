#include "experiments/scenes/copies.hpp"

#include <fmt/format.h>

#include <cmath>

namespace brickbench {
namespace {

constexpr std::size_t k_most_indices = 6;

std::size_t count_in(const Copies::Index& index, const Scope& scope) {
  const double count = index.count.in(scope);
  if (!(count >= 0.0 && count <= static_cast<double>(k_most_bodies)) ||
      count != std::round(count)) {
    reject(index.at, fmt::format("{} = {} must be a whole number in 0 .. {}", index.name, count,
                                 k_most_bodies));
  }
  return static_cast<std::size_t>(count);
}

}  // namespace

Copies::Copies(const InputValue& entry, Scope& scope) : first_(scope.names.size()) {
  const InputValue* repeat = entry.find("repeat");
  if (repeat == nullptr) return;
  if (expect(*repeat, "repeat", ValueKind::table).entries.empty()) {
    reject(repeat->at, "repeat names no index: write repeat = { i = 10 }");
  }
  for (const Entry& index : repeat->entries) {
    add({index.name, Quantity(index.value, index.name, scope), index.at}, scope);
  }
}

void Copies::add(Index index, Scope& scope) {
  if (indices_.size() == k_most_indices) {
    reject(index.at, fmt::format("at most {} indices", k_most_indices));
  }
  scope.add(index.name, 0.0, index.at);
  indices_.push_back(std::move(index));
}

void Copies::close(const InputValue& entry, const Scope& scope) {
  when_ = quantity_of(entry, "when", scope);
}

void Copies::each(Scope scope, const std::function<void(const Scope&)>& visit) const {
  std::size_t tried = 0;
  step(0, scope, tried, visit);
}

void Copies::step(std::size_t level, Scope& scope, std::size_t& tried,
                  const std::function<void(const Scope&)>& visit) const {
  if (level == indices_.size()) {
    if (!when_ || when_->in(scope) != 0.0) visit(scope);
    return;
  }
  const std::size_t count = count_in(indices_[level], scope);
  for (std::size_t i = 0; i < count; ++i) {
    if (++tried > 2 * k_most_bodies) {
      reject(indices_[level].at, fmt::format("more than {} copies", k_most_bodies));
    }
    scope.values[first_ + level] = static_cast<double>(i);
    step(level + 1, scope, tried, visit);
  }
}

std::string Copies::suffix(const Scope& scope) const {
  std::string text;
  for (std::size_t i = 0; i < indices_.size(); ++i) {
    text += fmt::format("_{}", scope.values[first_ + i]);
  }
  return text;
}

}  // namespace brickbench
