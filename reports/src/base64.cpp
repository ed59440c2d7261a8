#include "reports/src/base64.hpp"

#include <zlib.h>

#include <cassert>
#include <string_view>

namespace brickbench {
namespace {

constexpr std::string_view k_alphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string to_base64(std::span<const std::uint8_t> bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? k_alphabet[word >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

Expected<std::vector<std::uint8_t>> from_base64(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  if (text.size() % 4 != 0) return fail(Fault::invalid, "base64 of a broken length");
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t word = 0;
    std::size_t padding = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto digit = k_alphabet.find(text[i + k]);
      const bool is_padding = text[i + k] == '=' && i + 4 == text.size() && k >= 2;
      if ((digit == std::string_view::npos && !is_padding) || (!is_padding && padding > 0)) {
        return fail(Fault::invalid, "a character that is not base64");
      }
      if (is_padding) ++padding;
      word = word << 6 | (is_padding ? 0U : static_cast<std::uint32_t>(digit));
    }
    for (std::size_t k = 0; k + padding < 3; ++k) {
      bytes.push_back(static_cast<std::uint8_t>(word >> (16 - 8 * k) & 255U));
    }
  }
  return bytes;
}

std::vector<std::uint8_t> deflate_raw(std::span<const std::uint8_t> bytes) {
  z_stream stream{};
  constexpr int window_bits_without_header = -15;
  constexpr int memory_level = 9;
  [[maybe_unused]] int status =
      deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, window_bits_without_header,
                   memory_level, Z_DEFAULT_STRATEGY);
  assert(status == Z_OK);
  std::vector<std::uint8_t> out(deflateBound(&stream, static_cast<uLong>(bytes.size())));
  // zlib's older interface is not const; it does not write to its input.
  stream.next_in = const_cast<Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  status = ::deflate(&stream, Z_FINISH);
  assert(status == Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

}  // namespace brickbench
