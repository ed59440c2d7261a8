// Saved validations in reports: matrix, audit, CSV and figures from hand-made folders.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "experiments/record/provenance.hpp"
#include "reports/src/html_report.hpp"
#include "reports/src/report_source.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_validation = R"({"cells": [
 {"engine": "ours", "variant": "v", "case": "fall", "outcome": "ok", "failed": false,
  "bound": 1e-9, "scores": [{"error": 0.02, "explained": -0.02, "unexplained": 3e-12},
                            {"error": 0.01, "explained": 0.01, "unexplained": null}]},
 {"engine": "bee", "variant": "w", "case": "fall", "outcome": "ok", "failed": true,
  "bound": 1e-9, "scores": [{"error": 0.5, "explained": 0.25, "unexplained": 0.25}]},
 {"engine": "ours", "variant": "v", "case": "roll", "outcome": "ok", "failed": false,
  "bound": 1e-6, "scores": [{"error": 0.125, "explained": null, "unexplained": null}]},
 {"engine": "bee", "variant": "w", "case": "roll", "outcome": "audit", "failed": true,
  "reason": "mass 1 kg, instead of <script>", "bound": 1e-6, "scores": []},
 {"engine": "bee", "variant": "w", "case": "spin", "outcome": "unsupported", "failed": false,
  "reason": "no spheres", "bound": 1e-6, "scores": []}],
 "engines": [
 {"engine": "ours", "variant": "v", "version": "1", "precision": "f64",
  "settings": [{"name": "step", "unit": "s", "value": "0.001"}]},
 {"engine": "bee", "variant": "w", "version": "2.5", "precision": "f32",
  "settings": [{"name": "iterations", "unit": "1", "value": "50"},
               {"name": "margin", "unit": "m", "value": "0.04"}]}]})";

constexpr const char* k_orders = R"({"orders": [
 {"engine": "ours", "variant": "v", "case": "fall", "outcome": "ok", "order": 1.0,
  "half_width_95": 0.05, "at_rounding": false, "promised": 1.0,
  "ladder": [{"step_s": 0.01, "error": 0.02, "cpu_s": 0.001},
             {"step_s": 0.005, "error": 0.01, "cpu_s": 0.002}]},
 {"engine": "bee", "variant": "w", "case": "fall", "outcome": "ok", "order": null,
  "half_width_95": null, "at_rounding": true, "promised": 0.0,
  "ladder": [{"step_s": 0.01, "error": 0.0, "cpu_s": 0.003}]},
 {"engine": "bee", "variant": "w", "case": "spin", "outcome": "unsupported", "ladder": []}]})";

class SavedValidation : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("brickbench_saved." + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    Provenance provenance;
    provenance.title = "Cases";
    write("provenance.json", to_json(provenance).dump());
    write("validation.json", k_validation);
    write("orders.json", k_orders);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string reason() const {
    const auto read = read_report_source(folder_);
    return read ? "read" : read.error().reason;
  }
  std::string file(const std::string& name) const {
    const std::vector<ReportSource> sources = {read_report_source(folder_).value()};
    for (const OutputFile& output : report_files(sources, {})) {
      if (output.name == name) return output.content;
    }
    return "no file " + name;
  }

  fs::path folder_;
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(SavedValidation, BecomesALinePerCell) {
  EXPECT_EQ(file("figures/validation.csv"),
            "case,engine,outcome,verdict,error,explained,unexplained,bound,reason\n"
            "fall,ours/v,ok,within bound,0.02,0.02,3e-12,1e-09,\n"
            "fall,bee/w,ok,beyond bound,0.5,0.25,0.25,1e-09,\n"
            "roll,ours/v,ok,open,0.125,,,1e-06,\n"
            "roll,bee/w,audit,failed,,,,1e-06,\"mass 1 kg, instead of <script>\"\n"
            "spin,bee/w,unsupported,refused,,,,1e-06,no spheres\n");
}

TEST_F(SavedValidation, IsAMatrixWithAuditInMarkdown) {
  const std::string text = file("report.md");
  EXPECT_TRUE(has(text, "| fall | 2.0e-02 / 3.0e-12 | 2.5e-01 / 2.5e-01 > 1.0e-09 |")) << text;
  EXPECT_TRUE(has(text, "| roll | open, error 1.2e-01 | audit |")) << text;
  EXPECT_TRUE(has(text, "| bee/w | 2.5 | f32 | iterations 50; margin 0.04 m | 1 of 2 cells"))
      << text;
  EXPECT_TRUE(has(text, "Of 5 cells 1 are within their bound, 1 are beyond it")) << text;
}

TEST_F(SavedValidation, IsASectionOfThePage) {
  const std::string page = file("index.html");
  EXPECT_TRUE(has(page, "<section id=\"validation\">"));
  EXPECT_TRUE(has(page, "<section id=\"engines\">"));
  EXPECT_TRUE(has(page, "<td class=\"held\">2.0e-02 /<br> 3.0e-12</td>"));
  EXPECT_TRUE(has(page, "iterations 50; margin 0.04 m"));
  EXPECT_FALSE(has(page, "<section id=\"replay\">"));
  EXPECT_FALSE(has(page, "0 of 0 cells"));
}

TEST_F(SavedValidation, OrdersBecomeFiguresWithDataAxesAndPromise) {
  const std::vector<ReportSource> sources = {read_report_source(folder_).value()};
  const std::vector<Figure> figures = report_figures(sources);
  ASSERT_EQ(figures.size(), 2U);
  EXPECT_EQ(figures[0].title, "error against the step: fall");
  EXPECT_EQ(figures[0].x.text(), "step_s (s)");
  EXPECT_EQ(figures[0].curves[0].y, (std::vector<double>{0.02, 0.01}));
  EXPECT_EQ(figures[0].curves[0].note, "order 1.00 \xC2\xB1 0.05, promised 1");
  EXPECT_EQ(figures[0].curves[1].note, "at rounding");
  EXPECT_EQ(figures[1].title, "error against cost: fall");
  EXPECT_EQ(figures[1].x.text(), "engine CPU time of the run (s)");
  EXPECT_EQ(figures[1].curves[0].x, (std::vector<double>{0.001, 0.002}));
}

// A run, its validation and its orders are one page with one verdict.
TEST_F(SavedValidation, BelongsToTheRunBesideIt) {
  ReportSource run;
  run.rows.emplace_back();
  ReportSource cases = read_report_source(folder_).value();
  ReportSource orders = cases;
  cases.orders = nullptr;
  orders.validation = nullptr;
  std::vector<ReportSource> sources = {cases, orders, run, cases};
  fold_validations(sources);
  ASSERT_EQ(sources.size(), 2U) << "the second validation has no run left to belong to";
  EXPECT_EQ(sources[0].rows.size(), 1U);
  EXPECT_FALSE(sources[0].validation.is_null());
  EXPECT_FALSE(sources[0].orders.is_null());
  EXPECT_EQ(sources[0].attached.size(), 2U);
  sources = {cases, orders};
  fold_validations(sources);
  ASSERT_EQ(sources.size(), 1U);
  EXPECT_FALSE(sources[0].orders.is_null());
}

TEST_F(SavedValidation, DamagedFilesAreNamed) {
  EXPECT_EQ(reason(), "read");
  write("orders.json", R"({"orders": [{"engine": "a", "variant": "b", "case": "c",
                                       "outcome": "ok"}]})");
  EXPECT_TRUE(has(reason(), "orders.json: orders: an entry without the array 'ladder'"))
      << reason();
  write("orders.json", k_orders);
  write("validation.json", R"({"cells": [{"engine": "a", "variant": 3}]})");
  EXPECT_TRUE(has(reason(), "validation.json: cells: an entry without the text 'variant'"))
      << reason();
  fs::remove(folder_ / "validation.json");
  fs::remove(folder_ / "orders.json");
  EXPECT_TRUE(has(reason(), "rows.csv")) << reason();
}

}  // namespace
}  // namespace brickbench::testing
