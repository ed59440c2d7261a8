// The catalogue: complete entries, valid worlds, errors for bad parameters.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "adapters/seam/shape.hpp"
#include "experiments/exact/cases/exact_case.hpp"
#include "experiments/exact/sketch/sketch.hpp"
#include "tests/exact/random_parameters.hpp"

namespace brickbench::exact {
namespace {

TEST(Catalog, HoldsAtLeast36CasesWithDistinctIds) {
  std::set<std::string> ids;
  for (const ExactCase& exact_case : exact_cases()) ids.insert(exact_case.id);
  EXPECT_EQ(ids.size(), exact_cases().size());
  EXPECT_GE(ids.size(), 36u);
}

TEST(Catalog, EveryEntrySaysWhereItsTruthComesFrom) {
  for (const ExactCase& exact_case : exact_cases()) {
    EXPECT_FALSE(exact_case.source.empty() || exact_case.claim.empty() ||
                 exact_case.formula.empty() || exact_case.title.empty())
        << exact_case.id;
    for (const Observable& observable : exact_case.observables) {
      EXPECT_FALSE(observable.name.empty() || observable.unit.empty()) << exact_case.id;
    }
    for (const Parameter& parameter : exact_case.parameters) {
      const double value = std::get<double>(parameter.default_value);
      EXPECT_TRUE(value >= parameter.minimum && value <= parameter.maximum)
          << exact_case.id << " " << parameter.name;
    }
  }
}

TEST(Catalog, BuildsValidRunsForRandomParameters) {
  std::mt19937_64 generator(1);
  for (const ExactCase& exact_case : exact_cases()) {
    for (int i = 0; i < 20; ++i) {
      ParameterValues values = testing::random_parameters(exact_case, generator);
      while (exact_case.outside != nullptr && !exact_case.outside(values).empty()) {
        values = testing::random_parameters(exact_case, generator);
      }
      const auto run = build(exact_case, values);
      ASSERT_TRUE(run.has_value()) << exact_case.id << ": " << run.error().reason;
      EXPECT_EQ(run->truths.size(), exact_case.observables.size()) << exact_case.id;
      EXPECT_GT(run->steps, 0u) << exact_case.id;
      for (const Truth& truth : run->truths) EXPECT_GT(truth.scale, 0.0) << exact_case.id;
    }
  }
}

TEST(Catalog, DeclaredNeedsMatchTheWorld) {
  for (const ExactCase& exact_case : exact_cases()) {
    const ExactRun run = build(exact_case).value();
    bool spheres = false;
    for (const Body& body : run.world.bodies) {
      spheres = spheres || is_round(body.shape);
    }
    EXPECT_EQ(spheres, exact_case.needs.spheres) << exact_case.id;
    EXPECT_EQ(run.world.law.friction > 0.0, exact_case.needs.friction) << exact_case.id;
    EXPECT_EQ(static_cast<bool>(run.load), exact_case.needs.applied_forces) << exact_case.id;
    EXPECT_TRUE(run.world.law.restitution == 0.0 || exact_case.needs.restitution) << exact_case.id;
    EXPECT_TRUE(!run.geometry || exact_case.needs.contacts != Contacts::none) << exact_case.id;
  }
}

TEST(Catalog, RefusesUnknownAndOutOfRangeParameters) {
  const ExactCase exact_case = testing::find_case("free_flight.projectile");
  EXPECT_FALSE(build(exact_case, {{"speed", 1.0}}).has_value());
  EXPECT_FALSE(build(exact_case, {{"speed_x_mps", 1e9}}).has_value());
  EXPECT_FALSE(build(exact_case, {{"speed_x_mps", std::string("fast")}}).has_value());
  EXPECT_FALSE(build(exact_case, {{"speed_x_mps", std::nan("")}}).has_value());
  EXPECT_TRUE(build(exact_case, {{"speed_x_mps", 1.0}}).has_value());
}

TEST(Catalog, ThresholdsLieInsideTheirBrackets) {
  int count = 0;
  for (const ExactCase& exact_case : exact_cases()) {
    if (!exact_case.threshold) continue;
    ++count;
    const Threshold& threshold = *exact_case.threshold;
    const double critical = threshold.critical(complete(exact_case).value());
    for (const double factor : {threshold.low_factor, threshold.high_factor}) {
      EXPECT_TRUE(build(exact_case, {{threshold.parameter, critical * factor}}).has_value())
          << exact_case.id;
    }
    EXPECT_TRUE(threshold.low_factor < 1.0 && threshold.high_factor > 1.0) << exact_case.id;
  }
  EXPECT_GE(count, 5);
}

// Centres of the moving bodies in a drawing, in pixels.
std::vector<Eigen::Vector2d> centres(const std::string& svg) {
  static const std::regex dot("<circle cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\" r=\"2\"");
  std::vector<Eigen::Vector2d> points;
  for (std::sregex_iterator it(svg.begin(), svg.end(), dot), end; it != end; ++it) {
    points.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  }
  return points;
}

TEST(Sketch, ShowsEveryMovingBodyOfEveryCase) {
  std::string wrong;
  for (const ExactCase& exact_case : exact_cases()) {
    const ExactRun run = build(exact_case).value();
    const std::string svg = sketch_svg(exact_case, run);
    const auto points = centres(svg);
    const auto moving = std::ranges::count(run.world.bodies, false, &Body::fixed);
    const bool inside = std::ranges::all_of(points, [](const Eigen::Vector2d& p) {
      return p.x() > 0.0 && p.x() < 720.0 && p.y() > 0.0 && p.y() < 230.0;
    });
    const bool numbers = svg.find("nan") == std::string::npos && svg.find("inf ") == svg.npos;
    if (std::ssize(points) != moving || !inside || !numbers) wrong += exact_case.id + ' ';
  }
  EXPECT_EQ(wrong, "");
}

// Two balls in a row: the drawing keeps their order and the ratio of distance and radius.
TEST(Sketch, IsToScale) {
  const ExactCase exact_case = testing::find_case("impact.central_spheres");
  ExactRun run = build(exact_case).value();
  run.world.bodies[1].initial.position_m.x() += 0.1;
  const std::string svg = sketch_svg(exact_case, run);
  const auto points = centres(svg);
  ASSERT_EQ(points.size(), 2u);
  static const std::regex ball("r=\"([0-9.]+)\" fill=\"#3b82c4\"");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(svg, found, ball));
  const double distance_m =
      run.world.bodies[1].initial.position_m.x() - run.world.bodies[0].initial.position_m.x();
  const double radius_m = std::get<SphereShape>(run.world.bodies[0].shape).radius_m;
  // A tenth of a pixel is what the drawing rounds to.
  EXPECT_NEAR((points[1] - points[0]).x() / std::stod(found[1]), distance_m / radius_m, 0.01);
}

}  // namespace
}  // namespace brickbench::exact
