// brickbench: which rigid-body engine is right here, by how much, and at what cost?
#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "cli/complain.hpp"
#include "cli/verbs.hpp"
#include "experiments/input/input.hpp"

namespace {

// What is wrong with the first word that stands where a verb must, and is none; empty if nothing
// is.
std::string unknown_verb(const CLI::App& program, const std::vector<std::string>& arguments) {
  const CLI::App* app = &program;
  for (std::size_t i = 1; i < arguments.size() && !arguments[i].starts_with('-'); ++i) {
    std::vector<std::string> known;
    const CLI::App* chosen = nullptr;
    for (const CLI::App* verb : app->get_subcommands([](const CLI::App*) { return true; })) {
      known.push_back(verb->get_name());
      if (verb->get_name() == arguments[i]) chosen = verb;
    }
    const auto options = app->get_options();
    const bool takes_words = std::ranges::any_of(
        options, [](const CLI::Option* option) { return option->get_positional(); });
    if (chosen == nullptr && (known.empty() || takes_words)) return {};
    if (chosen == nullptr) {
      return fmt::format("no verb '{}'{}", arguments[i],
                         brickbench::known_names(arguments[i], known));
    }
    app = chosen;
  }
  return {};
}

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
  add_figure_verb(app, invocation);
  add_table_verb(app, invocation);
  add_render_verb(app, invocation);
  add_compare_verb(app, invocation);
  add_check_verb(app, invocation);
  add_bless_verb(app, invocation);
  add_oracle_verb(app, invocation);
  add_hunt_verb(app, invocation);
  add_scene_verb(app, invocation);
  add_threshold_verb(app, invocation);
  add_conformance_verb(app, invocation);
  add_serve_verb(app, invocation);
  add_doctor_verb(app, invocation);
  add_completion_verb(app, invocation);
  if (const std::string wrong = unknown_verb(app, invocation.arguments); !wrong.empty()) {
    return complain(wrong, k_exit_bad_input);
  }
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
