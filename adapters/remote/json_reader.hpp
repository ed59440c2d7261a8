// A JSON tree read strictly: each value by its path, unknown keys refused. For the readers of
// codec.cpp and world_json.cpp, which throw Wrong, and whose public functions catch it.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/seam/failure.hpp"

namespace brickbench::remote {

using Json = nlohmann::ordered_json;

struct Wrong {
  std::string reason;
};

class JsonValue {
 public:
  // Throws Wrong where the text is longer than allowed, nested too deep, or no JSON.
  static Json parse(std::string_view what, std::string_view text, std::size_t most_bytes);
  JsonValue(std::string path, const Json& json) : path_(std::move(path)), json_(&json) {}

  // Throws Wrong unless this is an object with no other keys than these.
  void only(const std::vector<std::string_view>& keys) const;
  bool has(const std::string& key) const { return json_->contains(key); }
  JsonValue at(const std::string& key) const;
  std::vector<JsonValue> items(std::size_t most) const;
  std::vector<std::pair<std::string, JsonValue>> entries(std::size_t most) const;

  bool is_text() const { return json_->is_string(); }
  double number() const;                  // finite
  double number_or(double absent) const;  // `absent` for null
  int whole(int least, int most) const;
  bool boolean() const;
  std::string any_text(std::size_t most_bytes) const;
  std::string text(std::size_t most_bytes) const;  // one line, not empty
  std::string word(std::size_t most_bytes) const;  // a-z, 0-9, _
  Eigen::Vector3d vector() const;                  // finite

  [[noreturn]] void wrong(const std::string& wanted) const;

 private:
  std::string path_;
  const Json* json_;
};

Json vector_json(const Eigen::Vector3d& v);

// Runs a reader; what it throws becomes Fault::crashed.
template <typename Read>
auto checked(const Read& read) -> Expected<decltype(read())> {
  try {
    return read();
  } catch (const Wrong& error) {
    return fail(Fault::crashed, error.reason);
  }
}

}  // namespace brickbench::remote
