#include "cli/complain.hpp"

#include <fmt/core.h>

#include "cli/verbs.hpp"

namespace brickbench {

int complain(const std::string& message, int code) {
  fmt::print(stderr, "brickbench: {}\n", message);
  return code;
}

int complain(const Failure& failure) {
  return complain(failure.reason,
                  failure.fault == Fault::invalid ? k_exit_bad_input : k_exit_infrastructure);
}

}  // namespace brickbench
