#include "experiments/run/selector.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace brickbench {
namespace {

void check_engine(const Selector& selector, const Catalogues& catalogues, bool must_be_linked) {
  std::vector<std::string> known = names_of(catalogues.adapters);
  if (std::ranges::find(known, selector.engine) != known.end()) return;
  if (std::ranges::find(catalogues.known_engines, selector.engine) !=
      catalogues.known_engines.end()) {
    if (!must_be_linked) return;
    if (const auto why = catalogues.why_absent.find(selector.engine);
        why != catalogues.why_absent.end()) {
      reject(selector.at,
             fmt::format("engine '{}' does not run: {}", selector.engine, why->second));
    }
    reject(selector.at, fmt::format("engine '{}' is not linked in this build; linked: {}",
                                    selector.engine, fmt::join(known, ", ")));
  }
  for (const std::string& name : catalogues.known_engines) {
    if (std::ranges::find(known, name) == known.end()) known.push_back(name);
  }
  known.emplace_back("all");
  reject(selector.at,
         fmt::format("no engine '{}'{}", selector.engine, known_names(selector.engine, known)));
}

void check_variant(const Selector& selector, const Catalogues& catalogues) {
  const Adapter* adapter = find_adapter(catalogues, selector.engine);
  if (adapter == nullptr || selector.variant.empty() || selector.variant == "*") return;
  const auto known = names_of(adapter->variants);
  if (std::ranges::find(known, selector.variant) != known.end()) return;
  reject(selector.at, fmt::format("{} has no variant '{}'{}", selector.engine, selector.variant,
                                  known_names(selector.variant, known)));
}

}  // namespace

Checked<Selector> parse_selector(const std::string& text, const SourcePosition& at,
                                 const Catalogues& catalogues, bool must_be_linked) {
  try {
    return expect_selector(text, at, catalogues, must_be_linked);
  } catch (const InputError& error) {
    return tl::unexpected(error);
  }
}

Selector expect_selector(const std::string& text, const SourcePosition& at,
                         const Catalogues& catalogues, bool must_be_linked) {
  Selector selector{
      .text = text, .engine = text == "all" ? std::string("*") : text, .variant = "", .at = at};
  if (const auto slash = text.find('/'); slash != std::string::npos) {
    selector.engine = text.substr(0, slash);
    selector.variant = text.substr(slash + 1);
    if (selector.variant.empty()) reject(at, fmt::format("'{}' names no variant", text));
  }
  if (selector.engine != "*") check_engine(selector, catalogues, must_be_linked);
  check_variant(selector, catalogues);
  return selector;
}

std::vector<EngineVariant> select(const Selector& selector, const Catalogues& catalogues) {
  std::vector<EngineVariant> selected;
  for (const Adapter& adapter : catalogues.adapters) {
    if (selector.engine != "*" && selector.engine != adapter.name) continue;
    for (std::size_t i = 0; i < adapter.variants.size(); ++i) {
      const std::string& variant = adapter.variants[i].name;
      const bool wanted = selector.variant.empty()
                              ? i == 0
                              : selector.variant == "*" || selector.variant == variant;
      if (wanted) selected.push_back({adapter.name, variant});
    }
  }
  return selected;
}

}  // namespace brickbench
