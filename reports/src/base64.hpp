// Base64 (RFC 4648) and raw deflate (RFC 1951): how binary data travels inside a page.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "adapters/seam/failure.hpp"

namespace brickbench {

std::string to_base64(std::span<const std::uint8_t> bytes);
// Fault::invalid for characters or lengths that are not base64.
Expected<std::vector<std::uint8_t>> from_base64(std::string_view text);

// zlib at its highest level, without header.
std::vector<std::uint8_t> deflate_raw(std::span<const std::uint8_t> bytes);

}  // namespace brickbench
