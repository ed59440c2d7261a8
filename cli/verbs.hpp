// The verbs of the program. Each adds its subcommand; when it is chosen it runs and sets the exit
// code: 0 fine, 1 a deviation or failed case, 2 bad usage or input, 3 incomplete, 4 infrastructure.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "experiments/run/catalogues.hpp"

namespace brickbench {

inline constexpr int k_exit_fine = 0;
inline constexpr int k_exit_failed_case = 1;
inline constexpr int k_exit_bad_input = 2;
inline constexpr int k_exit_incomplete = 3;
inline constexpr int k_exit_infrastructure = 4;

struct Invocation {
  std::vector<std::string> arguments;  // as typed
  int exit_code = k_exit_fine;
};

void add_run_verb(CLI::App& app, Invocation& invocation);
void add_sweep_verb(CLI::App& app, Invocation& invocation);
void add_sweep_plan_verb(CLI::App& sweep, Invocation& invocation);    // below `sweep`
void add_sweep_submit_verb(CLI::App& sweep, Invocation& invocation);  // below `sweep`
void add_bench_verb(CLI::App& app, Invocation& invocation);
void add_list_verb(CLI::App& app, Invocation& invocation);
void add_validate_verb(CLI::App& app, Invocation& invocation);
void add_report_verb(CLI::App& app, Invocation& invocation);
void add_render_verb(CLI::App& app, Invocation& invocation);
void add_compare_verb(CLI::App& app, Invocation& invocation);
void add_check_verb(CLI::App& app, Invocation& invocation);
void add_bless_verb(CLI::App& app, Invocation& invocation);
void add_oracle_verb(CLI::App& app, Invocation& invocation);
void add_hunt_verb(CLI::App& app, Invocation& invocation);
void add_completion_verb(CLI::App& app, Invocation& invocation);
void add_figure_verb(CLI::App& app, Invocation& invocation);
void add_table_verb(CLI::App& app, Invocation& invocation);
void add_scene_verb(CLI::App& app, Invocation& invocation);
void add_threshold_verb(CLI::App& app, Invocation& invocation);
void add_conformance_verb(CLI::App& app, Invocation& invocation);
void add_serve_verb(CLI::App& app, Invocation& invocation);
void add_doctor_verb(CLI::App& app, Invocation& invocation);

}  // namespace brickbench
