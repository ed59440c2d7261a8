// The sections of the HTML report, each a <section> or "" where there is nothing to say.
#pragma once

#include <string>
#include <vector>

#include "reports/src/figure.hpp"
#include "reports/src/palette.hpp"
#include "reports/src/report_source.hpp"
#include "reports/src/scene_names.hpp"

namespace brickbench {

// "" if `body` is empty.
std::string html_section(const std::string& id, const std::string& title, const std::string& body);
// Best with a star, worst with a triangle, failed in words; contenders carry their colour.
std::string html_table(const Table& table, const Palette& palette);
// The figure as SVG, or an empty place that the page's script fills.
std::string html_figure(const Figure& figure, bool draw_svg);

std::string html_verdict(const ReportSource& source, const std::vector<Block>& blocks,
                         const SceneNames& names, const Palette& palette);
std::string html_scene_tables(const std::vector<Block>& blocks, const SceneNames& names,
                              const Palette& palette);
// `csv`: address of the file behind the matrix.
std::string html_validation(const ReportSource& source, const Palette& palette,
                            const std::string& csv);
// Cells that ran to their end and are flagged, with the flags and the command that repeats them.
std::string html_flagged(const ReportSource& source, const SceneNames& names);
std::string html_unfinished(const ReportSource& source, const SceneNames& names);
std::string html_contenders(const ReportSource& source, const Palette& palette);
std::string html_method(const ReportSource& source);
std::string html_glossary(const ReportSource& source);

}  // namespace brickbench
