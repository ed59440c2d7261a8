// Scenes that users reported of engines, run as plans are: the answer is right, or told.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "adapters/catalog.hpp"
#include "experiments/hunt/dice.hpp"
#include "experiments/hunt/judge.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/run/run_plan.hpp"

namespace brickbench::hunt {
namespace {

class Reported : public ::testing::Test {
 protected:
  void SetUp() override {
    catalogues_.scenarios = scenarios();
    catalogues_.metrics = metrics();
    catalogues_.adapters = adapters();
  }

  bool is_linked(std::string_view engine) const {
    return find_adapter(catalogues_, engine) != nullptr;
  }

  // The cells of a plan with one experiment.
  std::vector<CellOutcome> run(const std::string& experiment) const {
    const auto plan =
        parse_plan("title = \"t\"\n[[experiment]]\n" + experiment, "p.toml", catalogues_);
    if (!plan) ADD_FAILURE() << plan.error().text();
    const auto cells = expand(plan.value(), catalogues_);
    if (!cells) ADD_FAILURE() << cells.error().text();
    return run_cells(*cells, catalogues_, {"revision", "machine"}).cells;
  }

  Catalogues catalogues_;
};

// A projectile that is on the far side of a wall after one step of 1/60 s.
TEST_F(Reported, ABrickThatPassesAWallIsToldByTheRun) {
  std::map<std::string, bool> passes = {{"bullet/si", true},
                                        {"ode/quick", true},
                                        {"ourengine/exact", false},
                                        {"ourengine/fast", false}};
  for (const auto& [label, through] : passes) {
    if (!is_linked(label.substr(0, label.find('/')))) continue;
    const auto cells = run("scenario = \"brick_wall\"\nengines = [\"" + label +
                           "\"]\nstep_s = \"1/60\"\nduration_s = 0.05\nparameters = { courses = 5, "
                           "columns = 5, projectile_speed_mps = [60, 80, 100, 120, 160, 250] }\n");
    EXPECT_EQ(cells.size(), 6U);
    for (const CellOutcome& cell : cells) {
      EXPECT_EQ(cell.outcome, "ok") << label << ": " << cell.reason;
      EXPECT_EQ(cell.validity.starts_with("tunnelled in "), through)
          << label << ": " << cell.validity;
    }
  }
}

// Conjugate gradients make energy out of nothing of light bricks: such runs end there.
TEST_F(Reported, LightBricksThatExplodeAreBlownUp) {
  if (!is_linked("bullet")) GTEST_SKIP();
  const std::string densities = "density_kgpm3 = [1.0, 3.0, 10.0, 30.0]";
  for (const std::string& scene :
       {"scenario = \"two_bricks\"\nstep_s = 0.001\nduration_s = 0.2\n"
        "parameters = { restitution = 0.5, friction = 0.5, a_" +
            densities + " }\n",
        "scenario = \"tower\"\nstep_s = \"1/240\"\nduration_s = 2.0\nparameters = { count = 3, " +
            densities + " }\n"}) {
    for (const CellOutcome& cell : run(scene + "engines = [\"bullet/nncg\"]\n")) {
      EXPECT_EQ(cell.outcome, "blown_up") << scene;
    }
    for (const CellOutcome& cell : run(scene + "engines = [\"bullet/si\"]\n")) {
      EXPECT_EQ(cell.outcome, "ok") << scene << cell.reason;
    }
  }
}

Trial slope_trial(const std::string& engine, const std::string& variant, const std::string& slope,
                  double friction, double angle_rad) {
  Trial trial;
  trial.scene = "incline";
  trial.engine = {engine, variant};
  trial.parameters = {{"slope", slope}, {"friction", friction}, {"angle_rad", angle_rad}};
  trial.step_s = 0.001;
  trial.steps = 500;
  return trial;
}

// A plane that holds more than its friction, somewhat above the friction angle.
TEST_F(Reported, AFrictionBeyondTheConeIsFound) {
  if (!is_linked("bullet")) GTEST_SKIP();
  for (const double friction : {0.3, 0.45, 0.6}) {
    const double angle_rad = std::atan(friction) + 0.04;
    const auto judged = [&](const char* slope) {
      return judge(slope_trial("bullet", "si", slope, friction, angle_rad), catalogues_);
    };
    EXPECT_NE(judged("plane").find("cone"), nullptr) << friction;
    EXPECT_EQ(judged("box").find("cone"), nullptr) << friction;
    if (is_linked("ourengine")) {
      const auto ours =
          judge(slope_trial("ourengine", "exact", "plane", friction, angle_rad), catalogues_);
      EXPECT_TRUE(ours.breaches.empty()) << friction;
    }
  }
}

struct RandomScene {
  std::string scene;
  double step_s;
  ParameterValues parameters;
};

// Drawn at random, each once showed energy out of nothing or a body deep in another.
std::vector<RandomScene> random_scenes() {
  const auto explosion = [](double step_s, double length_m, double thickness_m, double height_m,
                            double density, double friction, double restitution, double work_j) {
    return RandomScene{"explosion",
                       step_s,
                       {{"brick_length_m", length_m},
                        {"brick_thickness_m", thickness_m},
                        {"brick_height_m", height_m},
                        {"density_kgpm3", density},
                        {"friction", friction},
                        {"restitution", restitution},
                        {"work_j", work_j},
                        {"count_x", 2.0},
                        {"count_y", 2.0},
                        {"count_z", 2.0},
                        {"gap_m", 0.0}}};
  };
  const RandomScene drop = {"brick_drop",
                            1.0 / 60.0,
                            {{"brick_length_m", 0.1981},
                             {"brick_thickness_m", 0.3688},
                             {"brick_height_m", 0.218},
                             {"friction", 3.0},
                             {"restitution", 1.0},
                             {"drop_height_m", 0.08526},
                             {"tilt_x_rad", 1.2},
                             {"tilt_y_rad", 0.9},
                             {"spin_x_radps", 50.0},
                             {"downward_speed_mps", 20.0}}};
  const RandomScene slope = {"incline",
                             1.0 / 60.0,
                             {{"brick_length_m", 0.005449},
                              {"brick_thickness_m", 0.03494},
                              {"brick_height_m", 0.03132},
                              {"friction", 0.5},
                              {"restitution", 1.0},
                              {"angle_rad", 0.3},
                              {"speed_mps", 0.0},
                              {"heading_rad", 1.5},
                              {"slope", std::string("box")}}};
  const RandomScene light_on_heavy = {"two_bricks",
                                      1.0 / 240.0,
                                      {{"friction", 0.1},
                                       {"restitution", 1.0},
                                       {"a_length_m", 0.6957},
                                       {"a_thickness_m", 1.087},
                                       {"a_height_m", 1.592},
                                       {"b_length_m", 0.8218},
                                       {"b_thickness_m", 0.8558},
                                       {"b_height_m", 1.172},
                                       {"a_density_kgpm3", 6.502},
                                       {"b_density_kgpm3", 151.6},
                                       {"a_speed_mps", 2.873},
                                       {"gap_m", 0.01353},
                                       {"offset_y_m", 0.01741},
                                       {"offset_z_m", 0.102},
                                       {"a_spin_z_radps", 10.0}}};
  const RandomScene turning = {"two_bricks",
                               1.0 / 60.0,
                               {{"friction", 0.1},
                                {"a_length_m", 1.175},
                                {"a_thickness_m", 3.566},
                                {"a_height_m", 0.42},
                                {"b_length_m", 2.682},
                                {"b_thickness_m", 1.862},
                                {"b_height_m", 0.6445},
                                {"a_density_kgpm3", 4110.0},
                                {"b_density_kgpm3", 107.9},
                                {"a_speed_mps", 2.802},
                                {"gap_m", 0.2168},
                                {"offset_y_m", 0.09455},
                                {"offset_z_m", 0.1349},
                                {"a_spin_z_radps", 100.0}}};
  return {drop,
          slope,
          light_on_heavy,
          turning,
          explosion(1.0 / 60.0, 0.02446, 0.02626, 0.007775, 385.2, 1.0, 0.0, 8.06),
          explosion(1.0 / 60.0, 0.0112, 0.01349, 0.007217, 962.0, 3.0, 0.7, 4075.0),
          explosion(0.0003, 0.2597, 0.3184, 0.8347, 787.4, 0.0, 1.0, 15.77)};
}

// The neighbours of a scene: every number that is not a count within 5 %.
Trial neighbour(const RandomScene& random, const std::string& variant, Dice& dice) {
  Trial trial;
  trial.scene = random.scene;
  trial.engine = {"ourengine", variant};
  trial.step_s = random.step_s;
  trial.steps = static_cast<std::size_t>(std::ceil(0.3 / random.step_s));
  trial.parameters = random.parameters;
  for (auto& [name, value] : trial.parameters) {
    double* number = std::get_if<double>(&value);
    if (number == nullptr || name.starts_with("count") || name == "restitution") continue;
    *number *= dice.uniform(0.95, 1.05);
  }
  if (variant != "exact") trial.parameters["friction"] = 0.0;
  return trial;
}

TEST_F(Reported, NothingSinksAndNoEnergyIsMadeNearRandomScenes) {
  if (!is_linked("ourengine")) GTEST_SKIP();
  constexpr int k_neighbours = 4;
  Dice dice({14}, "reported");
  for (const RandomScene& random : random_scenes()) {
    for (int k = 0; k < k_neighbours; ++k) {
      for (const char* variant : {"exact", "lcp", "baraff"}) {
        const Trial trial = neighbour(random, variant, dice);
        const Verdict verdict = judge(trial, catalogues_);
        EXPECT_EQ(verdict.outcome, "ok") << label(trial) << ": " << verdict.reason;
        for (const Breach& breach : verdict.breaches) {
          ADD_FAILURE() << breach.oracle << " " << breach.observed << " of " << breach.allowed
                        << ": " << label(trial);
        }
      }
    }
  }
}

}  // namespace
}  // namespace brickbench::hunt
