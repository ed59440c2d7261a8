// conformance --adapter=NAME: every rule of the seam, for every variant of one linked adapter.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "adapters/catalog.hpp"
#include "experiments/conformance/check.hpp"

namespace brickbench::testing {
namespace {

using conformance::all_checks;
using conformance::Check;
using conformance::Outcome;
using conformance::Subject;
using conformance::Verdict;

class CheckTest : public ::testing::Test {
 public:
  CheckTest(Check check, Subject subject)
      : check_(std::move(check)), subject_(std::move(subject)) {}
  void TestBody() override {
    const Verdict verdict = check_.run(subject_);
    switch (verdict.outcome) {
      case Outcome::passed:
        break;
      case Outcome::failed:
        ADD_FAILURE() << check_.rule << ": " << verdict.detail;
        break;
      case Outcome::refused:
      case Outcome::no_view:
        GTEST_SKIP() << verdict.detail;
    }
  }

 private:
  Check check_;
  Subject subject_;
};

void register_checks(const Adapter& adapter) {
  for (const Variant& variant : adapter.variants) {
    for (const Check& check : all_checks()) {
      const std::string suite = adapter.name + "/" + variant.name;
      ::testing::RegisterTest(
          suite.c_str(), check.name.c_str(), nullptr, nullptr, __FILE__, __LINE__,
          [check, subject = Subject{adapter, variant.name}]() -> ::testing::Test* {
            return new CheckTest(check, subject);
          });
    }
  }
}

}  // namespace
}  // namespace brickbench::testing

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  constexpr std::string_view k_option = "--adapter=";
  std::string linked;
  for (const brickbench::Adapter& adapter : brickbench::adapters()) {
    linked += ' ' + adapter.name;
    if (argc == 2 && argv[1] == std::string(k_option) + adapter.name) {
      brickbench::testing::register_checks(adapter);
      return RUN_ALL_TESTS();
    }
  }
  fmt::print(stderr, "usage: conformance --adapter=NAME; linked:{}\n", linked);
  return 2;
}
