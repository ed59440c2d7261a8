#include "experiments/sweep/shard.hpp"

#include <fmt/format.h>

#include "experiments/record/schema.hpp"

namespace brickbench {

Expected<Shard> parse_shard(std::string_view text) {
  constexpr std::uint64_t most = 1'000'000;
  const auto slash = text.find('/');
  const auto index = parse_count(text.substr(0, slash));
  const auto count = parse_count(slash == text.npos ? "" : text.substr(slash + 1));
  if (!index || !count || *count == 0 || *count > most || *index >= *count) {
    return fail(Fault::invalid,
                fmt::format("shard '{}' is not i/n with 0 <= i < n, n at most {}", text, most));
  }
  return Shard{*index, *count};
}

}  // namespace brickbench
