// What the verb `hunt` shows.
#pragma once

#include <vector>

#include "experiments/hunt/findings.hpp"
#include "reports/src/table.hpp"

namespace brickbench {

// One row for each finding, the first `most` of them.
Table findings_table(const std::vector<hunt::Finding>& findings, std::size_t most);

// "412 trials: 380 ok, 20 refused, 12 diverged; 9 runs broke a law and had said so"
std::string counts_text(const hunt::Record& record);

// The table of findings and that of what was told, in Markdown: `link` is the folder of the plans.
std::string findings_page(const hunt::Quarry& quarry, const hunt::Record& record,
                          const std::vector<hunt::Finding>& findings, const std::string& link);

}  // namespace brickbench
