// What `run` prints: at most one screen, or all tables.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "cli/planned_work.hpp"

namespace brickbench {

// Lines that the one screen has at most.
inline constexpr std::size_t k_screen_lines = 25;

struct RunTold {
  std::string folder;
  std::string record_command;  // that runs the same and records the motion; or empty
  std::map<std::string, double> smallest_edge_m;  // by cell
};

// "wall bee/v step 0.001 s seed 3 friction=0.5".
std::string cell_label(const Cell& cell);

// Who ran, who broke a law, who is fastest, what was refused, and where the rest is; each line
// without its end, none longer than `width`.
std::vector<std::string> run_screen(const RunResult& result, const RunTold& told,
                                    const TerminalStyle& style);

// Every table, and how every cell ended that did not end well.
void print_run_tables(const RunResult& result);

// Smallest edge or diameter of the bodies that move, m, of each cell that ran.
std::map<std::string, double> smallest_edges(const PlannedWork& work, const RunResult& result);

}  // namespace brickbench
