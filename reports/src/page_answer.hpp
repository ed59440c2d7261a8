// What a page answers before everything else: who broke a law, and what one run cannot tell.
#pragma once

#include <string>
#include <vector>

#include "reports/src/palette.hpp"
#include "reports/src/report_source.hpp"

namespace brickbench {

// What the run was asked for beyond its plan: "projectile_speed_mps=15", "--engine ant/v"; from
// what the provenance keeps, of older folders from their command.
std::vector<std::string> overrides_of(const Provenance& provenance);

// Laws that numbers of this run show to be broken, one sentence each, and who is fastest; empty
// without rows. Overlap is judged where a scene's motion was recorded, since bodies have their
// sizes there.
std::vector<std::string> law_lines(const ReportSource& source);

// That outcomes of few starts rank nobody, and the command that would tell; "" if every scene was
// run from statistics::k_least_for_interval starts or more, or if nothing moves by chance there:
// nothing was displaced.
std::string chance_line(const ReportSource& source);

std::string html_answer(const ReportSource& source, const Palette& palette);
std::string markdown_answer(const ReportSource& source);

}  // namespace brickbench
