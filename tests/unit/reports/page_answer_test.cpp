// What a page answers first: laws, chance, and what was asked for beyond the plan.
#include "reports/src/page_answer.hpp"

#include <gtest/gtest.h>

#include "reports/src/replay_source.hpp"

namespace brickbench::testing {
namespace {

ReportSource falling_source(std::uint64_t starts, double displaced) {
  ReportSource source;
  source.provenance.command = "brickbench run quick_look --out there";
  for (std::uint64_t seed = 1; seed <= starts; ++seed) {
    for (const auto& [metric, value] : {std::pair{"bricks_displaced", displaced},
                                        {"penetration_max_m", 0.02},
                                        {"energy_created_relative", 0.0}}) {
      Row row;
      row.experiment = "wall";
      row.cell = std::to_string(seed);
      row.engine = "ant";
      row.variant = "v";
      row.seed = seed;
      row.metric = metric;
      row.value = value;
      row.outcome = "ok";
      row.state_hash = "00ff";
      source.rows.push_back(row);
    }
  }
  return source;
}

TEST(PageAnswer, OverridesComeFromTheCommand) {
  Provenance provenance;
  provenance.command =
      "build/brickbench run quick_look --set projectile_speed_mps=15 --set 'columns=[6, 8]' --step "
      "1/240 "
      "--engine 'ant/*' --out there";
  EXPECT_EQ(overrides_of(provenance),
            (std::vector<std::string>{"projectile_speed_mps=15", "columns=[6, 8]", "step_s=1/240",
                                      "--engine ant/*"}));
  provenance.command = "brickbench run quick_look";
  EXPECT_TRUE(overrides_of(provenance).empty());
}

TEST(PageAnswer, OverlapIsJudgedWhereTheMotionTellsTheSizes) {
  ReportSource source = falling_source(1, 0.0);
  EXPECT_EQ(law_lines(source),
            std::vector<std::string>{"Nobody broke a law that these numbers show."});
  Replay replay;
  replay.scene = scene_of(source.rows.front());
  replay.bodies = {{"ground", ReplayShape::plane, ReplayRole::fixed, {0.0, 0.0, 0.0}},
                   {"brick", ReplayShape::box, ReplayRole::brick, {0.1, 0.05, 0.05}}};
  source.replays.push_back(replay);
  EXPECT_EQ(law_lines(source), std::vector<std::string>{"Bodies inside each other: ant/v 20 mm."});
}

TEST(PageAnswer, FewStartsOfWhatFallsRankNobody) {
  const std::string line = chance_line(falling_source(1, 3.0));
  EXPECT_NE(line.find("nobody is ranked"), std::string::npos);
  EXPECT_NE(line.find("--set seeds=16"), std::string::npos) << line;
  EXPECT_EQ(chance_line(falling_source(8, 3.0)), "");
  EXPECT_EQ(chance_line(falling_source(1, 0.0)), "");
}

}  // namespace
}  // namespace brickbench::testing
