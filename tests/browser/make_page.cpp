// make_page FOLDER: writes pages for the browser tests: a wall of 4 x 400 bricks in invented motion
// (`wall`), one of 2 000 bricks (`many`), one with runs that do not count (`flagged`), and one
// whose every text is hostile (`hostile`).
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "experiments/record/file.hpp"
#include "reports/src/html_report.hpp"
#include "reports/src/replay_source.hpp"

namespace brickbench {
namespace {

constexpr double k_step_s = 0.001;
constexpr double k_duration_s = 2.0;
constexpr std::size_t k_frames = 240;
constexpr double k_gravity_mps2 = 9.81;

Row row_of(const std::string& experiment, const std::string& engine) {
  Row row;
  row.experiment = experiment;
  row.cell = experiment + engine;
  row.scenario = "brick_wall";
  row.engine = engine;
  row.variant = "default";
  row.engine_version = "1.0";
  row.precision = "f64";
  row.step_s = k_step_s;
  row.duration_s = k_duration_s;
  row.group = "energy";
  row.metric = "energy_created_relative";
  row.unit = "1";
  row.better = "lower";
  row.value = 1e-3 * static_cast<double>(engine.size());
  row.outcome = "ok";
  row.state_hash = "00";
  return row;
}

// Bricks of a running-bond wall around a hole fly off along y, each with its own speed and spin.
Replay motion(const Row& row, std::size_t courses, std::size_t columns, double strength) {
  Replay replay;
  replay.scene = scene_of(row);
  replay.engine = contender_of(row);
  replay.cell = row.cell;
  replay.bodies.push_back({"ground", ReplayShape::plane, ReplayRole::fixed, {1.0, 1.0, 1.0}});
  replay.bodies.push_back(
      {"projectile", ReplayShape::box, ReplayRole::projectile, {0.1, 0.1, 0.1}});
  for (std::size_t i = 0; i < courses * columns; ++i) {
    replay.bodies.push_back(
        {fmt::format("brick {}", i), ReplayShape::box, ReplayRole::brick, {0.1, 0.05, 0.05}});
  }
  const double middle_m = 0.05 * static_cast<double>(courses);
  for (std::size_t f = 0; f < k_frames; ++f) {
    const double t_s = k_duration_s * static_cast<double>(f) / static_cast<double>(k_frames - 1);
    replay.times_s.push_back(t_s);
    const auto put = [&](double x, double y, double z, double angle) {
      replay.positions_m.insert(replay.positions_m.end(), {x, y, z});
      replay.orientations.insert(replay.orientations.end(),
                                 {std::cos(angle / 2), std::sin(angle / 2), 0.0, 0.0});
    };
    put(0.0, 0.0, 0.0, 0.0);
    put(0.0, std::min(-1.5 + 15.0 * t_s, 0.4), middle_m, 0.0);
    for (std::size_t i = 0; i < courses * columns; ++i) {
      const std::size_t course = i / columns;
      const double x =
          0.201 * (static_cast<double>(i % columns) + 0.5 * static_cast<double>(course % 2) -
                   0.5 * static_cast<double>(columns));
      const double z = 0.05 + 0.1 * static_cast<double>(course);
      const double near = std::exp(-(x * x + (z - middle_m) * (z - middle_m)) / 0.1);
      const double since_s = std::max(t_s - 0.1, 0.0);
      const double fall_m = near > 0.05 ? 0.5 * k_gravity_mps2 * since_s * since_s : 0.0;
      const double height_m = std::max(z - fall_m, 0.05);
      const double flight_s = std::min(since_s, std::sqrt(2.0 * (z - 0.05) / k_gravity_mps2));
      put(x, near > 0.05 ? strength * near * flight_s : 0.0, height_m,
          near > 0.05 ? 4.0 * near * strength * flight_s : 0.0);
    }
  }
  return replay;
}

ReportSource source_of(const std::string& experiment, const std::vector<std::string>& engines,
                       std::size_t courses, std::size_t columns) {
  ReportSource source;
  source.name = experiment;
  source.provenance.title = experiment;
  source.provenance.analysis = "Invented motion, to test the page.";
  source.provenance.plan = "none";
  for (std::size_t e = 0; e < engines.size(); ++e) {
    const Row row = row_of(experiment, engines[e]);
    source.rows.push_back(row);
    source.provenance.engines.push_back({engines[e], "1.0", "f64", e == 0});
    source.replays.push_back(motion(row, courses, columns, 1.0 + 0.5 * static_cast<double>(e)));
    for (int i = 0; i <= 100; ++i) {
      SeriesPoint point;
      point.experiment = experiment;
      point.cell = row.cell;
      point.engine = row.engine;
      point.variant = row.variant;
      point.step_s = row.step_s;
      point.curve = "total_energy_j";
      point.unit = "J";
      point.time_s = k_duration_s * i / 100.0;
      point.value = 100.0 * std::exp(-point.time_s * static_cast<double>(e + 1));
      source.series.push_back(point);
    }
    Timing timing;
    timing.experiment = experiment;
    timing.cell = row.cell;
    timing.engine = row.engine;
    timing.variant = row.variant;
    timing.step_s = row.step_s;
    timing.steps = 2000;
    timing.steps_total_cpu_s = 0.5 * static_cast<double>(e + 1);
    timing.outcome = "ok";
    source.timings.push_back(timing);
    Row coarse = row;
    coarse.cell += "coarse";
    coarse.step_s *= 2.0;
    coarse.value = *row.value * 2.0;
    source.rows.push_back(coarse);
  }
  return source;
}

// One sound engine, one that is flagged from 0.5 s on, and one that blew up at 1 s.
ReportSource flagged_source() {
  ReportSource source = source_of("flagged", {"sound", "bee", "gone"}, 4, 6);
  const std::string flags = "unsolved in 31 of 2000 steps from step 500";
  for (Row& row : source.rows) {
    if (row.engine == "bee") row.validity = flags;
    if (row.engine != "gone") continue;
    row.value.reset();
    row.state_hash.clear();
    row.outcome = "blown_up";
    row.reason = "after step 1000 (1 s) there are 2e+06 J more";
  }
  for (Timing& timing : source.timings) {
    if (timing.engine == "bee") timing.validity = flags;
    if (timing.engine == "gone") timing.outcome = "blown_up";
  }
  std::erase_if(source.series, [](const SeriesPoint& point) { return point.engine == "gone"; });
  source.replays[1].note = "! " + flags;
  source.replays[1].flagged_from_s = 0.5;
  source.replays[2] = thinned(source.replays[2], k_frames / 2);
  source.replays[2].note = "blown_up: " + source.rows.back().reason;
  return source;
}

int write(const std::filesystem::path& folder, const ReportSource& source) {
  const std::vector<ReportSource> sources = {source};
  const auto files = report_files(sources, page_assets());
  for (const OutputFile& file : files) {
    std::filesystem::create_directories((folder / file.name).parent_path());
    if (auto ok = write_new_file(folder / file.name, file.content); !ok) {
      fmt::print(stderr, "{}\n", ok.error().reason);
      return 4;
    }
  }
  return 0;
}

int run(const std::filesystem::path& folder) {
  const std::string hostile = "<script>document.title='owned'</script>&\"'";
  int status = write(folder / "wall", source_of("wall", {"ours", "bee", "cee", "dee"}, 20, 20));
  status += write(folder / "many", source_of("many", {"ours"}, 40, 50));
  status += write(folder / "flagged", flagged_source());
  status += write(folder / "hostile", source_of(hostile, {hostile, "</script><b>"}, 2, 3));
  return status;
}

}  // namespace
}  // namespace brickbench

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: make_page FOLDER\n");
    return 2;
  }
  std::filesystem::remove_all(argv[1]);
  return brickbench::run(argv[1]);
}
