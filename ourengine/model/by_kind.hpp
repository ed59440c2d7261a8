// The one way to branch on the shape of a body.
#pragma once

#include <utility>
#include <variant>

namespace ourengine {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

// What the case for the kind at hand returns. There is one case for each kind: where one is added,
// nothing that branches compiles until it says what it does with it.
template <class Kinds, class... Cases>
decltype(auto) by_kind(const Kinds& shape, Cases&&... cases) {
  static_assert(sizeof...(Cases) == std::variant_size_v<Kinds>, "one case for each kind of shape");
  return std::visit(Overloaded{std::forward<Cases>(cases)...}, shape);
}

}  // namespace ourengine
