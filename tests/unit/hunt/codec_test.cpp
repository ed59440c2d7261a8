// What a process of the hunt sends to another is what that one reads.
#include "experiments/hunt/codec.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace brickbench::hunt {
namespace {

Shrunk sent(Source source) {
  Shrunk shrunk;
  shrunk.trial.source = source;
  shrunk.trial.scene = "tower";
  shrunk.trial.parameters = {{"count", 3.0}, {"start", "leaning"}};
  shrunk.trial.step_s = 1.0 / 240;
  shrunk.trial.steps = 7;
  shrunk.trial.engine = {"any", "plain"};
  shrunk.trial.knobs = {{"erp", 0.3}};
  shrunk.verdict.reason = "why";
  shrunk.verdict.breaches = {
      {"energy", std::numeric_limits<double>::infinity(), 1.0, "J", 5, 0.25, "0, 2"}};
  shrunk.probes = 9;
  return shrunk;
}

TEST(Codec, ReadsBackWhatItWroteOfBothSources) {
  for (const Source source : {Source::scenario, Source::exact_case}) {
    const Shrunk shrunk = sent(source);
    const Shrunk back = shrunk_of(Json::parse(to_json(shrunk).dump()));
    EXPECT_EQ(back.trial, shrunk.trial);
    EXPECT_EQ(back.probes, shrunk.probes);
    EXPECT_EQ(back.verdict.outcome, shrunk.verdict.outcome);
    EXPECT_EQ(back.verdict.reason, shrunk.verdict.reason);
    ASSERT_EQ(back.verdict.breaches.size(), 1u);
    const Breach& breach = back.verdict.breaches.front();
    const Breach& sent_breach = shrunk.verdict.breaches.front();
    EXPECT_EQ(breach.oracle, sent_breach.oracle);
    EXPECT_EQ(breach.observed, sent_breach.observed);
    EXPECT_EQ(breach.allowed, sent_breach.allowed);
    EXPECT_EQ(breach.unit, sent_breach.unit);
    EXPECT_EQ(breach.step, sent_breach.step);
    EXPECT_EQ(breach.time_s, sent_breach.time_s);
    EXPECT_EQ(breach.bodies, sent_breach.bodies);
  }
}

}  // namespace
}  // namespace brickbench::hunt
