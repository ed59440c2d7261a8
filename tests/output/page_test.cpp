// Report pages and comparisons from hand-made folders: golden bytes, escaping, honest refusals.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "reports/src/base64.hpp"
#include "reports/src/compare.hpp"
#include "reports/src/html_report.hpp"
#include "reports/src/losses.hpp"
#include "reports/src/markup.hpp"
#include "reports/src/replay_source.hpp"
#include "reports/src/report_source.hpp"
#include "reports/src/scene_names.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_hostile = "<script>alert('x')</script>&\"";

Row row(const std::string& engine, double step_s, double value, const std::string& axes,
        std::uint64_t seed = 0) {
  Row row;
  row.experiment = "wall";
  row.cell = engine + shortest(step_s) + axes + std::to_string(seed);
  row.scenario = "brick_wall";
  row.engine = engine;
  row.variant = "v";
  row.step_s = step_s;
  row.duration_s = 1.0;
  row.seed = seed;
  row.axes = axes;
  row.group = "energy";
  row.metric = "energy_created_relative";
  row.unit = "1";
  row.better = "lower";
  row.value = value;
  row.outcome = "ok";
  row.state_hash = "00ff";
  return row;
}

ReportSource source(const std::string& title, const std::string& axes, double factor) {
  ReportSource source;
  source.name = title;
  source.provenance.title = title;
  source.provenance.plan = "plan.toml";
  source.provenance.engines = {{"ours", "1", "f64", true}, {"bee", "2", "f32", false}};
  for (const std::string engine : {"ours", "bee"}) {
    for (const double step_s : {0.002, 0.001}) {
      const double value = factor * step_s * (engine == "ours" ? 2.0 : 1.0);
      source.rows.push_back(row(engine, step_s, value, axes));
      SeriesPoint point;
      point.experiment = "wall";
      point.cell = source.rows.back().cell;
      point.engine = engine;
      point.variant = "v";
      point.step_s = step_s;
      point.curve = "total_energy_j";
      point.unit = "J";
      for (const double time_s : {0.0, 0.5, 1.0}) {
        point.time_s = time_s;
        point.value = 3.0 - time_s * (engine == "ours" ? 1.0 : 2.0);
        source.series.push_back(point);
      }
      Timing timing;
      timing.experiment = "wall";
      timing.cell = point.cell;
      timing.engine = engine;
      timing.variant = "v";
      timing.step_s = step_s;
      timing.axes = axes;
      timing.steps = static_cast<std::uint64_t>(std::llround(1.0 / step_s));
      timing.step_median_cpu_s = 1e-4;
      timing.steps_total_cpu_s = 1e-4 / step_s;
      timing.outcome = "ok";
      source.timings.push_back(timing);
    }
  }
  return source;
}

std::vector<OutputFile> files_of(const ReportSource& source, const PageAssets& assets = {}) {
  const std::vector<ReportSource> sources = {source};
  return report_files(sources, assets);
}

Replay replay(const std::string& engine) {
  Replay replay;
  replay.scene = "s";
  replay.engine = engine;
  replay.bodies = {{"b", ReplayShape::box, ReplayRole::brick, {0.1, 0.1, 0.1}}};
  for (int f = 0; f < 5; ++f) {
    replay.times_s.push_back(0.25 * f);
    replay.positions_m.insert(replay.positions_m.end(), {0.1 * f, 0.0, 1.0});
    replay.orientations.insert(replay.orientations.end(), {1.0, 0.0, 0.0, 0.0});
  }
  return replay;
}

class Folder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("brickbench_page." + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path put(const ReportSource& source) const {
    const fs::path where = folder_ / "results";
    fs::create_directories(where);
    write(where / "rows.csv", to_csv<Row>(source.rows));
    write(where / "timings.csv", to_csv<Timing>(source.timings));
    write(where / "series.csv", to_csv<SeriesPoint>(source.series));
    write(where / "provenance.json", to_json(source.provenance).dump());
    return where;
  }
  static void write(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }

  fs::path folder_;
};

// The bytes of report.md, one SVG and one CSV. After a wanted change:
// BRICKBENCH_BLESS=1 ctest -R output_page
TEST(Page, GoldenBytes) {
  const auto files = files_of(source("golden", "friction=0.5", 1.0));
  const fs::path golden = "tests/output/golden";
  const bool bless = std::getenv("BRICKBENCH_BLESS") != nullptr;
  std::string wrong;
  std::size_t compared = 0;
  for (const OutputFile& file : files) {
    const std::string name = fs::path(file.name).filename().string();
    if (name == "index.html") continue;
    ++compared;
    if (bless) {
      fs::create_directories(golden);
      std::ofstream(golden / name, std::ios::binary) << file.content;
    }
    const auto expected = read_file(golden / name);
    if (!expected || *expected != file.content) wrong += name + ' ';
  }
  EXPECT_EQ(wrong, "");
  // report.md, and SVG and CSV of: the curve at each of two steps, the step study, the cost.
  EXPECT_EQ(compared, 9U);
}

TEST(Page, IsAPureFunctionAndStandsAlone) {
  const ReportSource input = source("twice", "friction=0.5", 1.0);
  const std::string page = files_of(input).front().content;
  EXPECT_EQ(page, files_of(input).front().content);
  for (const char* reference : {"src=\"http", "href=\"http", "@import", "url(http"}) {
    EXPECT_EQ(page.find(reference), std::string::npos) << reference;
  }
  EXPECT_NE(page.find("Our own engine is beaten in 2 of 2 comparisons"), std::string::npos);
  EXPECT_LT(page.find("Our own engine is beaten"), page.find("<h2>Who was run"));
}

TEST(Page, ShowsTheOrderOfConvergence) {
  const std::vector<ReportSource> sources = {source("order", "friction=0.5", 1.0)};
  const auto figures = report_figures(sources);
  const auto study = std::ranges::find_if(
      figures, [](const Figure& figure) { return figure.x.label == "step_s"; });
  ASSERT_NE(study, figures.end());
  EXPECT_EQ(study->curves.front().note, "order 1.00");
}

TEST(Page, NamesScenesByWhatTellsThemApart) {
  ReportSource input = source("names", "courses=10;friction=0.5", 1.0);
  for (const std::size_t more : {2U, 3U}) {
    input.rows.push_back(input.rows[more]);
    input.rows.back().axes = "courses=20;friction=0.5";
    input.rows.back().cell += "more";
  }
  const auto blocks = summarize(input.rows);
  const SceneNames names(blocks);
  EXPECT_EQ(names.brief(scene_label(blocks.front())), "wall: courses=10, step 0.002 s");
  EXPECT_EQ(names.brief(family_label(blocks.front())), "wall: courses=10");
  EXPECT_EQ(names.brief("another"), "another");
  EXPECT_EQ(SceneNames(std::span(blocks).first(1)).brief(scene_label(blocks.front())), "wall");
}

TEST(Page, LongNamesKeepTheirBeginningAndEnd) {
  const std::string id = file_id("time-" + std::string(300, 'x') + "-17-total_energy_j");
  EXPECT_EQ(id.size(), k_longest_id);
  EXPECT_TRUE(id.starts_with("time-xxx"));
  EXPECT_TRUE(id.ends_with("-17-total_energy_j"));
  EXPECT_EQ(file_id(std::string(k_longest_id, 'x')), std::string(k_longest_id, 'x'));
}

// Who is ahead by rounding only is not ahead.
TEST(Page, RoundingIsNoVictory) {
  ReportSource input = source("rounding", "friction=0.5", 1e-12);
  const auto blocks = summarize(input.rows);
  EXPECT_FALSE(blocks.front().numbers.front().best.has_value());
  const std::vector<std::string> own = {"ours"};
  EXPECT_EQ(losses(blocks, own).rounding, 2U);
  const std::string page = files_of(input).front().content;
  EXPECT_NE(page.find("In 2 of them by rounding only (at most 1e-11"), std::string::npos);
  EXPECT_EQ(page.find("The widest:"), std::string::npos);
}

TEST(Page, EveryTextIsEscaped) {
  ReportSource input = source(k_hostile, "friction=0.5", 1.0);
  for (Row& row : input.rows) {
    row.experiment = k_hostile;
    row.engine = k_hostile;
    row.note = k_hostile;
    row.group = k_hostile;
  }
  input.rows.back().outcome = k_hostile;
  input.rows.back().reason = k_hostile;
  input.rows.back().state_hash.clear();
  input.provenance.analysis = k_hostile;
  input.provenance.command = k_hostile;
  input.replays = {replay(k_hostile)};
  PageAssets assets;
  assets.script = "'ours';";
  for (const OutputFile& file : files_of(input, assets)) {
    if (file.name.ends_with(".csv") || file.name.ends_with(".md")) continue;
    EXPECT_EQ(file.content.find("<script>alert"), std::string::npos) << file.name;
    EXPECT_EQ(file.content.find("alert('x')</script"), std::string::npos) << file.name;
    EXPECT_EQ(file.name.find('<'), std::string::npos);
  }
  EXPECT_EQ(escape_markup("<a b='c'>&\"\x01"), "&lt;a b=&#39;c&#39;&gt;&amp;&quot;\xEF\xBF\xBD");
}

TEST(Page, WithoutAScriptSaysWhatIsMissingAndKeepsTheFigures) {
  PageAssets assets;
  assets.missing = "no Node";
  ReportSource input = source("static", "friction=0.5", 1.0);
  input.replays = {replay("ours/v")};
  const std::string page = files_of(input, assets).front().content;
  EXPECT_NE(page.find("no Node"), std::string::npos);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
}

TEST_F(Folder, DamagedFilesAreNamedWithTheirLine) {
  const fs::path where = put(source("damaged", "friction=0.5", 1.0));
  ASSERT_TRUE(read_report_source(where).has_value());
  const std::string rows = *read_file(where / "rows.csv");
  const std::string series = *read_file(where / "series.csv");
  const auto reason = [&] {
    const auto read = read_report_source(where);
    return read ? std::string("read") : read.error().reason;
  };
  std::string bad = rows;
  bad.replace(bad.find(",0.002,"), 7, ",zero,");
  write(where / "rows.csv", bad);
  EXPECT_NE(reason().find("rows.csv:2: step_s"), std::string::npos) << reason();
  write(where / "rows.csv", rows.substr(0, rows.size() - 30));
  EXPECT_NE(reason().find("rows.csv:5"), std::string::npos) << reason();
  write(where / "rows.csv", rows);
  write(where / "series.csv", series + "1,2\n");
  EXPECT_NE(reason().find("series.csv:14"), std::string::npos) << reason();
  write(where / "series.csv", series);
  write(where / "validation.json", "{\n  \"cells\": [}\n");
  EXPECT_NE(reason().find("validation.json:2:13"), std::string::npos) << reason();
  fs::remove(where / "validation.json");
  write(where / "provenance.json", "{}");
  EXPECT_NE(reason().find("provenance.json: "), std::string::npos) << reason();
}

TEST(Replays, ThatDoNotFitAreRefused) {
  EXPECT_TRUE(check(replay("a")).has_value());
  Replay bad = replay("a");
  bad.times_s[2] = bad.times_s[1];
  EXPECT_FALSE(check(bad).has_value());
  bad = replay("a");
  bad.positions_m.pop_back();
  EXPECT_FALSE(check(bad).has_value());
  bad = replay("a");
  bad.orientations[7] = std::nan("");
  EXPECT_FALSE(check(bad).has_value());
  const Replay thin = thinned(replay("a"), 3);
  EXPECT_EQ(thin.times_s, (std::vector<double>{0.0, 0.5, 1.0}));
  EXPECT_EQ(thin.positions_m.size(), 9U);
}

TEST(Replays, Base64GoesBothWays) {
  for (std::size_t size = 0; size < 20; ++size) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(251 * i + 7));
    const auto back = from_base64(to_base64(bytes));
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(*back, bytes);
  }
  EXPECT_EQ(to_base64(std::vector<std::uint8_t>{'f', 'o', 'o', 'b'}), "Zm9vYg==");
  for (const char* bad : {"abc", "a=bc", "ab\ncd", "===="}) EXPECT_FALSE(from_base64(bad)) << bad;
}

TEST(Compare, ARunWithItselfHasNoChange) {
  const ReportSource one = source("one", "gravity_mps2=9.81", 1.0);
  const FolderComparison comparison = compare(one, one);
  EXPECT_EQ(comparison.compared, 4U);
  EXPECT_EQ(comparison.same, 4U);
  EXPECT_TRUE(comparison.changes.empty());
  EXPECT_TRUE(comparison.facts.empty());
  EXPECT_EQ(headline(comparison), "No change: 4 of 4 numbers are identical.");
}

TEST(Compare, ATurnedParameterIsNamedAndItsEffectMeasured) {
  const FolderComparison comparison =
      compare(source("one", "gravity_mps2=9.81", 1.0), source("two", "gravity_mps2=9.9081", 1.01));
  ASSERT_EQ(comparison.facts.size(), 1U);
  EXPECT_EQ(comparison.facts.front(), "wall/gravity_mps2: 9.81 -> 9.9081");
  EXPECT_EQ(comparison.beyond_noise, 4U);
  EXPECT_NEAR(comparison.changes.front().relative, 0.01 / 1.01, 1e-12);
  EXPECT_TRUE(comparison.changes.front().worse);
  EXPECT_TRUE(comparison.only_in_a.empty());
}

constexpr const char* k_unsolved = "unsolved in 31 of 240 steps from step 12";

ReportSource flagged_source(const std::string& engine, const std::string& validity) {
  ReportSource one = source("one", "", 1.0);
  for (Row& r : one.rows) {
    if (engine.empty() || r.engine == engine) r.validity = validity;
  }
  for (Timing& timing : one.timings) {
    if (engine.empty() || timing.engine == engine) timing.validity = validity;
  }
  return one;
}

TEST(Compare, FlaggedNumbersAreCountedAndNotCompared) {
  const ReportSource bee = flagged_source("bee", k_unsolved);
  FolderComparison comparison = compare(bee, bee);
  EXPECT_EQ(comparison.compared, 2U);
  EXPECT_EQ(comparison.same, 2U);
  EXPECT_EQ(comparison.flagged, 2U);
  EXPECT_EQ(headline(comparison),
            "No change: 2 of 2 numbers are identical; 2 could not be compared (2 flagged, 0 "
            "without a number).");
  ASSERT_EQ(comparison.untimed.size(), 1U);
  EXPECT_EQ(comparison.untimed[0], std::string("bee/v, wall: not comparable: ") + k_unsolved);
  const ReportSource all = flagged_source("", k_unsolved);
  comparison = compare(all, all);
  EXPECT_EQ(comparison.compared, 0U);
  EXPECT_EQ(headline(comparison),
            "Nothing could be compared: of 4 numbers 4 are flagged and 0 have no value.");
}

TEST(Compare, ARunThatCameToBeFlaggedIsAChange) {
  const FolderComparison comparison =
      compare(source("one", "", 1.0), flagged_source("bee", k_unsolved));
  EXPECT_EQ(comparison.beyond_noise, 2U);
  EXPECT_EQ(comparison.changes.front().words, "ok -> unsolved (flagged)");
  EXPECT_TRUE(comparison.changes.front().worse);
}

TEST(Compare, MissingOnBothSidesIsNotIdentical) {
  ReportSource one = source("one", "", 1.0);
  for (Row& r : one.rows) {
    r.value.reset();
    r.outcome = "diverged";
  }
  const FolderComparison comparison = compare(one, one);
  EXPECT_EQ(comparison.compared, 0U);
  EXPECT_EQ(comparison.same, 0U);
  EXPECT_EQ(comparison.without_number, 4U);
  EXPECT_EQ(headline(comparison),
            "Nothing could be compared: of 4 numbers 0 are flagged and 4 have no value.");
}

TEST(Compare, SeedsMeasureTheNoise) {
  ReportSource one;
  ReportSource two;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    one.rows.push_back(row("bee", 0.001, 1.0 + 0.1 * static_cast<double>(seed), "", seed));
    two.rows.push_back(row("bee", 0.001, 1.02 + 0.1 * static_cast<double>(seed), "", seed));
  }
  EXPECT_EQ(compare(one, two).beyond_noise, 0U) << "0.02 within a range of 0.2";
  for (Row& row : two.rows) row.value = *row.value + 1.0;
  EXPECT_EQ(compare(one, two).beyond_noise, 1U);
  two.rows.back().value.reset();
  two.rows.back().outcome = "diverged";
  const FolderComparison lost = compare(one, two);
  EXPECT_EQ(lost.changes.front().words, "ok -> 2 ok, some diverged");
}

}  // namespace
}  // namespace brickbench::testing
