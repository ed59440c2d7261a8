// Experiments before numbers, a changed setting once, bounds that guard nothing.
#include "experiments/regression/digest.hpp"

#include <gtest/gtest.h>

namespace brickbench::gate {
namespace {

Comparison made(const std::string& experiment, const std::string& engine, const std::string& axes,
                Finding finding) {
  Comparison c;
  c.experiment = experiment;
  c.reference.engine = c.obtained.engine = engine;
  c.reference.axes = c.obtained.axes = axes;
  c.finding = finding;
  return c;
}

TEST(Digest, ExperimentsAreSummedUpTheRedOnesFirst) {
  const auto all = digest({made("drop", "ant/v", "a=1", Finding::fine),
                           made("drop", "ant/v", "a=1", Finding::flagged),
                           made("slide", "ant/v", "a=1", Finding::deviation),
                           made("slide", "ant/v", "a=1", Finding::missing),
                           made("slide", "bee/v", "a=1", Finding::open)});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "slide");
  EXPECT_EQ(all[0].red_engines, std::vector<std::string>{"ant/v"});
  EXPECT_EQ(all[0].compared, 2u);
  EXPECT_EQ(all[1].numbers, 2u);
  EXPECT_EQ(all[1].compared, 1u);
  EXPECT_EQ(all[1].count(Finding::fine), 1u);
  EXPECT_EQ(all[1].count(Finding::open), 0u);
}

TEST(Digest, AChangedSettingIsToldOnceForAllEnginesAndNumbers) {
  std::vector<Comparison> comparisons;
  for (const char* engine : {"ant/v", "bee/v"}) {
    for (int number = 0; number < 5; ++number) {
      comparisons.push_back(made("slide", engine, "step_s=0.1;friction=0.3", Finding::missing));
      comparisons.push_back(made("slide", engine, "step_s=0.1;friction=0.285", Finding::fresh));
    }
  }
  // An engine of which one number was compared has no changed setting, nor has one that is new.
  comparisons.push_back(made("slide", "cow/v", "step_s=0.1;friction=0.3", Finding::missing));
  comparisons.push_back(made("slide", "cow/v", "step_s=0.1;friction=0.285", Finding::fresh));
  comparisons.push_back(made("slide", "cow/v", "step_s=0.1", Finding::fine));
  comparisons.push_back(made("slide", "dog/v", "step_s=0.1;friction=0.285", Finding::fresh));
  const auto changes = changed_settings(comparisons);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].change, "friction 0.3 -> 0.285");
  EXPECT_EQ(changes[0].engines, (std::vector<std::string>{"ant/v", "bee/v"}));
  EXPECT_EQ(changes[0].missing, 10u);
  EXPECT_EQ(changes[0].fresh, 10u);
  EXPECT_TRUE(is_told_by(changes, comparisons.front()));
  EXPECT_FALSE(is_told_by(changes, comparisons.back()));
  EXPECT_FALSE(is_told_by(changes, made("slide", "ant/v", "a=1", Finding::deviation)));
}

TEST(Digest, ABoundWiderThanItsNumberIsLoose) {
  const auto bounded = [](double value, double bound) {
    Comparison c = made("slide", "ant/v", "a=1", Finding::fine);
    c.reference.kind = Kind::bound;
    c.reference_value = value;
    c.bound = bound;
    return c;
  };
  std::vector<Comparison> comparisons = {bounded(1.0, 0.5), bounded(-1.0, 2.0), bounded(0.0, 1.0),
                                         bounded(1.0, 30.0)};
  comparisons.push_back(bounded(1.0, 50.0));
  comparisons.back().reference.kind = Kind::distribution;  // its bound is of p
  comparisons.push_back(bounded(1.0, 50.0));
  comparisons.back().finding = Finding::flagged;
  const auto loose = loose_bounds(comparisons);
  ASSERT_EQ(loose.size(), 2u);
  EXPECT_EQ(loose[0]->bound, 30.0);
  EXPECT_EQ(loose[1]->bound, 2.0);
}

}  // namespace
}  // namespace brickbench::gate
