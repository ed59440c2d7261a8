// What an engine in another process may do wrong: done by remote_program, demanded by the tests.
#pragma once

#include <array>
#include <string_view>

namespace brickbench::testing {

// In the answer to the third step, unless the name says when.
enum class RemoteMishap {
  none,
  dies,
  exits,
  hangs,
  trickles,
  closes_output,
  garbage,
  other_word,
  too_long,
  too_short,
  too_much,
  eats_memory,
  chatters,  // on standard error, and answers rightly
  refuses,
  unknown_fault,
  bad_flags,
  negative_time,
  not_finite,
  contact_of_nobody,  // when asked for contacts
  audit_is_no_json,   // when asked for the audit
  other_version,      // hello
  hello_hangs,
  hello_without_variants,
  hello_too_deep,
  hello_unknown_key,
  mutated,  // every answer, by a seed
};

struct RemoteMishapName {
  RemoteMishap mishap;
  std::string_view name;
};

inline constexpr std::array k_remote_mishaps = {
    RemoteMishapName{RemoteMishap::none, "none"},
    RemoteMishapName{RemoteMishap::dies, "dies"},
    RemoteMishapName{RemoteMishap::exits, "exits"},
    RemoteMishapName{RemoteMishap::hangs, "hangs"},
    RemoteMishapName{RemoteMishap::trickles, "trickles"},
    RemoteMishapName{RemoteMishap::closes_output, "closes_output"},
    RemoteMishapName{RemoteMishap::garbage, "garbage"},
    RemoteMishapName{RemoteMishap::other_word, "other_word"},
    RemoteMishapName{RemoteMishap::too_long, "too_long"},
    RemoteMishapName{RemoteMishap::too_short, "too_short"},
    RemoteMishapName{RemoteMishap::too_much, "too_much"},
    RemoteMishapName{RemoteMishap::eats_memory, "eats_memory"},
    RemoteMishapName{RemoteMishap::chatters, "chatters"},
    RemoteMishapName{RemoteMishap::refuses, "refuses"},
    RemoteMishapName{RemoteMishap::unknown_fault, "unknown_fault"},
    RemoteMishapName{RemoteMishap::bad_flags, "bad_flags"},
    RemoteMishapName{RemoteMishap::negative_time, "negative_time"},
    RemoteMishapName{RemoteMishap::not_finite, "not_finite"},
    RemoteMishapName{RemoteMishap::contact_of_nobody, "contact_of_nobody"},
    RemoteMishapName{RemoteMishap::audit_is_no_json, "audit_is_no_json"},
    RemoteMishapName{RemoteMishap::other_version, "other_version"},
    RemoteMishapName{RemoteMishap::hello_hangs, "hello_hangs"},
    RemoteMishapName{RemoteMishap::hello_without_variants, "hello_without_variants"},
    RemoteMishapName{RemoteMishap::hello_too_deep, "hello_too_deep"},
    RemoteMishapName{RemoteMishap::hello_unknown_key, "hello_unknown_key"},
    RemoteMishapName{RemoteMishap::mutated, "mutated"},
};

}  // namespace brickbench::testing
