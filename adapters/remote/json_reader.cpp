#include "adapters/remote/json_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "adapters/remote/codec.hpp"
#include "adapters/remote/frame.hpp"

namespace brickbench::remote {
namespace {

constexpr std::size_t k_shown_bytes = 60;

// How deep brackets are nested outside strings.
int depth_of(std::string_view text) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\') {
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && (c == '[' || c == '{')) {
      deepest = std::max(deepest, ++depth);
    } else if (!quoted && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

Json JsonValue::parse(std::string_view what, std::string_view text, std::size_t most_bytes) {
  if (text.size() > most_bytes) {
    throw Wrong{fmt::format("'{}' is {} bytes of JSON; at most {}", what, text.size(), most_bytes)};
  }
  if (depth_of(text) > k_most_json_depth) {
    throw Wrong{fmt::format("'{}' is nested deeper than {}", what, k_most_json_depth)};
  }
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) {
    throw Wrong{fmt::format("'{}' is not JSON: {}", what,
                            readable(text.substr(0, k_shown_bytes), k_shown_bytes))};
  }
  return json;
}

void JsonValue::wrong(const std::string& wanted) const {
  std::string shown = json_->dump(-1, ' ', true, Json::error_handler_t::replace);
  if (shown.size() > k_shown_bytes) shown = shown.substr(0, k_shown_bytes) + "...";
  throw Wrong{fmt::format("{} must be {}, and is {}", path_, wanted, readable(shown, 100))};
}

void JsonValue::only(const std::vector<std::string_view>& keys) const {
  if (!json_->is_object()) wrong("an object");
  for (const auto& [key, value] : json_->items()) {
    if (std::ranges::find(keys, key) == keys.end()) {
      throw Wrong{fmt::format("{} has a key '{}'; known are {}", path_,
                              readable(key, k_shown_bytes), fmt::join(keys, ", "))};
    }
  }
}

JsonValue JsonValue::at(const std::string& key) const {
  if (!json_->is_object()) wrong("an object");
  const auto found = json_->find(key);
  if (found == json_->end()) throw Wrong{fmt::format("{} has no '{}'", path_, key)};
  return {fmt::format("{}.{}", path_, key), *found};
}

std::vector<JsonValue> JsonValue::items(std::size_t most) const {
  if (!json_->is_array() || json_->size() > most) {
    wrong(fmt::format("an array of at most {} values", most));
  }
  std::vector<JsonValue> all;
  for (const Json& item : *json_) {
    all.emplace_back(fmt::format("{}[{}]", path_, all.size()), item);
  }
  return all;
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::entries(std::size_t most) const {
  if (!json_->is_object() || json_->size() > most) {
    wrong(fmt::format("an object of at most {} values", most));
  }
  std::vector<std::pair<std::string, JsonValue>> all;
  for (const auto& [key, value] : json_->items()) {
    all.emplace_back(key,
                     JsonValue(fmt::format("{}.{}", path_, readable(key, k_shown_bytes)), value));
  }
  return all;
}

double JsonValue::number() const {
  if (!json_->is_number()) wrong("a number");
  const double value = json_->get<double>();
  if (!std::isfinite(value)) wrong("a finite number");
  return value;
}

double JsonValue::number_or(double absent) const { return json_->is_null() ? absent : number(); }

int JsonValue::whole(int least, int most) const {
  const std::string wanted = fmt::format("a whole number from {} to {}", least, most);
  if (!json_->is_number_integer()) wrong(wanted);
  const double value = json_->get<double>();
  if (value < least || value > most) wrong(wanted);
  return static_cast<int>(value);
}

bool JsonValue::boolean() const {
  if (!json_->is_boolean()) wrong("true or false");
  return json_->get<bool>();
}

std::string JsonValue::any_text(std::size_t most_bytes) const {
  if (!json_->is_string() || json_->get_ref<const std::string&>().size() > most_bytes) {
    wrong(fmt::format("text of at most {} bytes", most_bytes));
  }
  return json_->get<std::string>();
}

std::string JsonValue::text(std::size_t most_bytes) const {
  const std::string wanted = fmt::format("one line of text, at most {} bytes", most_bytes);
  if (!json_->is_string()) wrong(wanted);
  auto value = json_->get<std::string>();
  const bool plain = std::ranges::all_of(
      value, [](char c) { return static_cast<unsigned char>(c) >= ' ' && c != 127; });
  if (!plain || value.empty() || value.size() > most_bytes) wrong(wanted);
  return value;
}

std::string JsonValue::word(std::size_t most_bytes) const {
  std::string value = text(most_bytes);
  const bool plain = std::ranges::all_of(
      value, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
  if (!plain) wrong("a name of small letters, digits and _");
  return value;
}

Eigen::Vector3d JsonValue::vector() const {
  const auto parts = items(3);
  if (parts.size() != 3) wrong("three numbers");
  return {parts[0].number(), parts[1].number(), parts[2].number()};
}

Json vector_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

}  // namespace brickbench::remote
