#include <fmt/format.h>

#include "cli/completion.hpp"
#include "cli/verbs.hpp"
#include "cli/verbs_json.hpp"
#include "experiments/record/provenance.hpp"

namespace brickbench {
namespace {

struct CompletionOptions {
  std::string what;
  bool json = false;
};

int complete(const CompletionOptions& options, const CLI::App& app) {
  const nlohmann::ordered_json verbs = verbs_json(app);
  const std::string text = options.what == "bash"  ? bash_completion(verbs)
                           : options.what == "zsh" ? zsh_completion(verbs)
                                                   : man_page(verbs, this_machine().revision);
  if (options.json) {
    fmt::print("{}\n", nlohmann::ordered_json({{"id", options.what}, {"text", text}}).dump(2));
  } else {
    fmt::print("{}", text);
  }
  return k_exit_fine;
}

}  // namespace

void add_completion_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "completion", "Print completion for a shell, or the manual page, made from the verbs");
  auto options = std::make_shared<CompletionOptions>();
  verb->add_option("what", options->what, "bash, zsh or man")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "man"}));
  verb->add_flag("--json", options->json, "The text as JSON on standard output");
  verb->callback([options, &app, &invocation] { invocation.exit_code = complete(*options, app); });
}

}  // namespace brickbench
