// brickbench: which rigid-body engine is right here, by how much, and at what cost?
#include <fmt/core.h>

#include <exception>

#include "cli/verbs.hpp"

namespace {

int run(int argc, char** argv) {
  using namespace brickbench;
  Invocation invocation;
  invocation.arguments.assign(argv, argv + argc);
  CLI::App app("Runs the same rigid-body scenes through several engines and says which is right.");
  app.name("brickbench");
  app.require_subcommand(1);
  add_run_verb(app, invocation);
  add_sweep_verb(app, invocation);
  add_bench_verb(app, invocation);
  add_list_verb(app, invocation);
  add_validate_verb(app, invocation);
  add_report_verb(app, invocation);
  add_render_verb(app, invocation);
  add_compare_verb(app, invocation);
  add_check_verb(app, invocation);
  add_bless_verb(app, invocation);
  add_oracle_verb(app, invocation);
  add_hunt_verb(app, invocation);
  add_doctor_verb(app, invocation);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Help is fine; every other complaint of the parser is bad usage.
    return app.exit(error) == 0 ? k_exit_fine : k_exit_bad_input;
  }
  return invocation.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "brickbench: internal error: {}\n", error.what());
    return brickbench::k_exit_infrastructure;
  }
}
