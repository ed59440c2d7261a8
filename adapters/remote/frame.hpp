// Frames: what docs/protocol.md says travels between the harness and an engine in another process.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace brickbench::remote {

inline constexpr int k_protocol = 1;
inline constexpr std::size_t k_header_bytes = 16;

// Requests, and their answers; `hello`, `contacts`, `audit` and `pair_law` are both.
enum class Tag {
  hello,
  build,
  built,
  step,
  read,
  states,
  set_state,
  done,
  contacts,
  audit,
  pair_law,
  failed,
};

inline constexpr std::array k_all_tags = {Tag::hello,    Tag::build,  Tag::built,     Tag::step,
                                          Tag::read,     Tag::states, Tag::set_state, Tag::done,
                                          Tag::contacts, Tag::audit,  Tag::pair_law,  Tag::failed};

// The word on the wire, without the blanks that fill it up to eight bytes.
constexpr std::string_view to_word(Tag tag) {
  switch (tag) {
    case Tag::hello:
      return "hello";
    case Tag::build:
      return "build";
    case Tag::built:
      return "built";
    case Tag::step:
      return "step";
    case Tag::read:
      return "read";
    case Tag::states:
      return "states";
    case Tag::set_state:
      return "setstate";
    case Tag::done:
      return "done";
    case Tag::contacts:
      return "contacts";
    case Tag::audit:
      return "audit";
    case Tag::pair_law:
      return "pairlaw";
    case Tag::failed:
      return "failed";
  }
  return "failed";
}

// A frame's beginning: its word, and the length of what follows in bytes.
struct Header {
  Tag tag = Tag::failed;
  std::uint64_t bytes = 0;
};

// 16 bytes.
std::string to_bytes(const Header& header);
// nullopt where the first 16 bytes begin no frame.
std::optional<Header> to_header(std::string_view bytes);
// Header and payload.
std::string to_frame(Tag tag, std::string_view payload);

static_assert(std::endian::native == std::endian::little, "payloads are copied as they lie");

// Numbers one after the other, little endian.
class PayloadWriter {
 public:
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  template <typename Number>
  void put(Number number) {
    std::array<char, sizeof(Number)> raw;
    std::memcpy(raw.data(), &number, sizeof(Number));
    bytes_.append(raw.data(), raw.size());
  }
  // Cut to, or filled up with zeros to, `size` bytes.
  void put_text(std::string_view text, std::size_t size);
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Reads them back. Beyond the end it yields zeros, and is not whole() any more.
class PayloadReader {
 public:
  explicit PayloadReader(std::string_view bytes) : rest_(bytes) {}
  template <typename Number>
  Number take() {
    Number number{};
    if (rest_.size() < sizeof(Number)) {
      short_ = true;
      rest_ = {};
      return number;
    }
    std::memcpy(&number, rest_.data(), sizeof(Number));
    rest_.remove_prefix(sizeof(Number));
    return number;
  }
  // Up to the first zero byte of the next `size`.
  std::string take_text(std::size_t size);
  std::size_t left() const { return rest_.size(); }
  // Nothing was missing and nothing is left.
  bool whole() const { return !short_ && rest_.empty(); }

 private:
  std::string_view rest_;
  bool short_ = false;
};

// What an engine wrote, fit for a line of a table: no control characters, ASCII, at most `most`
// bytes (the last ones).
std::string readable(std::string_view text, std::size_t most);

}  // namespace brickbench::remote
