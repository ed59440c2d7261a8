#include "adapters/remote/frame.hpp"

#include <algorithm>

namespace brickbench::remote {
namespace {

constexpr std::size_t k_word_bytes = 8;

}  // namespace

std::string to_bytes(const Header& header) {
  PayloadWriter writer;
  std::string word(to_word(header.tag));
  word.resize(k_word_bytes, ' ');
  writer.put_text(word, k_word_bytes);
  writer.put(header.bytes);
  return writer.bytes();
}

std::optional<Header> to_header(std::string_view bytes) {
  if (bytes.size() < k_header_bytes) return std::nullopt;
  std::string_view word = bytes.substr(0, k_word_bytes);
  while (word.ends_with(' ')) word.remove_suffix(1);
  const auto found = std::ranges::find(k_all_tags, word, &to_word);
  if (found == k_all_tags.end()) return std::nullopt;
  PayloadReader reader(bytes.substr(k_word_bytes, sizeof(std::uint64_t)));
  return Header{*found, reader.take<std::uint64_t>()};
}

std::string to_frame(Tag tag, std::string_view payload) {
  std::string frame = to_bytes({tag, payload.size()});
  frame += payload;
  return frame;
}

void PayloadWriter::put_text(std::string_view text, std::size_t size) {
  bytes_ += text.substr(0, size);
  bytes_.append(size - std::min(size, text.size()), '\0');
}

std::string PayloadReader::take_text(std::size_t size) {
  if (rest_.size() < size) {
    short_ = true;
    rest_ = {};
    return {};
  }
  const std::string_view text = rest_.substr(0, size);
  rest_.remove_prefix(size);
  return std::string(text.substr(0, text.find('\0')));
}

std::string readable(std::string_view text, std::size_t most) {
  while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.remove_suffix(1);
  std::string line;
  for (const char c : text.substr(text.size() - std::min(most, text.size()))) {
    if (c == '\n') {
      line += " | ";
    } else if (c == '\t' || c == '\r') {
      line += ' ';
    } else {
      line += c >= ' ' && c <= '~' ? c : '?';
    }
  }
  return line;
}

}  // namespace brickbench::remote
