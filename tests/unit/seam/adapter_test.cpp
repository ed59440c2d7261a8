// What the seam itself checks of an adapter's settings.
#include "adapters/seam/adapter.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace brickbench {
namespace {

struct Range {
  Knob knob;
  const char* allowed;
};

TEST(Knob, SaysItsRangeInWords) {
  const double none = HUGE_VAL;
  const std::vector<Range> table = {
      {{"a", "1", 3, "m", 0, 3, true}, "whole numbers from 0 to 3"},
      {{"a", "m", 3, "m", 0, 3, false}, "numbers from 0 to 3 m"},
      {{"a", "m", 3, "m", 0, none, false}, "numbers of at least 0 m"},
      {{"a", "1", 3, "m", -none, 3, true}, "whole numbers of at most 3"},
      {{"a", "1", 3, "m"}, "numbers"}};
  for (const Range& range : table) EXPECT_EQ(range_text(range.knob), range.allowed);
}

TEST(Knob, RefusesWhatIsBeyondItsRangeAndTakesTheRest) {
  for (const bool whole : {false, true}) {
    for (const double min : {-HUGE_VAL, -2.0, 0.0}) {
      for (const double max : {1.0, 4.0, HUGE_VAL}) {
        const Knob knob{"size_m", "m", 1.0, "meaning", min, max, whole};
        for (const double value : {-1e300, -2.0, -1.0, 0.0, 0.5, 1.0, 2.5, 4.0, 1e300}) {
          const bool allowed =
              value >= min && value <= max && (!whole || value == std::floor(value));
          const auto ok = validate(knob, value);
          EXPECT_EQ(ok.has_value(), allowed) << value << ' ' << range_text(knob);
          EXPECT_TRUE(ok || ok.error().reason.ends_with(range_text(knob))) << ok.error().reason;
        }
        EXPECT_FALSE(validate(knob, HUGE_VAL));
        EXPECT_FALSE(validate(knob, std::nan("")));
      }
    }
  }
}

TEST(Adapter, NamesThePrecisionOfItsVariants) {
  Adapter adapter;
  EXPECT_EQ(precision_text(adapter), "");
  adapter.variants = {{"a", "first"}, {"b", "second"}};
  EXPECT_EQ(precision_text(adapter), "f64");
  adapter.variants.push_back({"c", "third", "f32"});
  EXPECT_EQ(precision_text(adapter), "f64; c f32");
  EXPECT_EQ(variant_of(adapter, "c").precision, "f32");
  EXPECT_EQ(variant_of(adapter, "").name, "a");
}

}  // namespace
}  // namespace brickbench
