// The tolerances of experiments/conformance/tolerance.hpp for GoogleTest.
#pragma once

#include <gtest/gtest.h>

#include "experiments/conformance/tolerance.hpp"

namespace brickbench::testing {

using conformance::Tolerance;
using conformance::tolerance_scale;

// Assert once, at the end of a loop, with EXPECT_TRUE(worst.within(tol)).
class Worst : public conformance::Worst {
 public:
  ::testing::AssertionResult within(const Tolerance& tolerance) const {
    if (empty()) return ::testing::AssertionFailure() << tolerance.name << ": nothing was compared";
    const double allowed = tolerance.value * tolerance_scale();
    auto result =
        residual() <= allowed ? ::testing::AssertionSuccess() : ::testing::AssertionFailure();
    return result << tolerance.name << ": residual " << residual() << " against " << allowed << " ("
                  << tolerance.derivation << "; last observed " << tolerance.observed << ") at "
                  << where();
  }
};

}  // namespace brickbench::testing
