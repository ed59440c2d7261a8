// The HTML report: one page that needs nothing but itself.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "reports/src/ensembles.hpp"
#include "reports/src/figure.hpp"
#include "reports/src/page_assets.hpp"
#include "reports/src/report_source.hpp"

namespace brickbench {

struct OutputFile {
  std::string name;  // relative, with '/' between folders
  std::string content;
};

struct ReportOptions {
  std::size_t replay_frames = 240;        // at most, per replay
  std::vector<Ensembles> ensembles = {};  // empty, or those of each source
};

// index.html, report.md, figures/<id>.svg and figures/<id>.csv, in this order. The same bytes for
// the same input; every text of the input is escaped.
std::vector<OutputFile> report_files(std::span<const ReportSource> sources,
                                     const PageAssets& assets, const ReportOptions& options = {});

// All figures of all sources, as report_files() draws them.
std::vector<Figure> report_figures(std::span<const ReportSource> sources,
                                   const ReportOptions& options = {});

// Pages share their frame: head, style, script and data around a body of HTML.
std::string page(const std::string& title, const std::string& body, const std::string& data_json,
                 const PageAssets& assets);

}  // namespace brickbench
