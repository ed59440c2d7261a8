#include <fmt/format.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "adapters/remote/frame.hpp"
#include "adapters/remote/serve.hpp"
#include "cli/build_facts.hpp"
#include "cli/complain.hpp"
#include "cli/verbs.hpp"
#include "experiments/input/input.hpp"

namespace brickbench {
namespace {

int serve_engine(const std::string& name, bool json) {
  const Catalogues catalogues = all_catalogues();
  const Adapter* adapter = find_adapter(catalogues, name);
  if (adapter == nullptr) {
    return complain(fmt::format("no linked engine '{}'{}", name,
                                known_names(name, names_of(catalogues.adapters))),
                    k_exit_bad_input);
  }
  if (json) {
    const nlohmann::ordered_json facts = {
        {"id", adapter->name}, {"version", adapter->version}, {"protocol", remote::k_protocol}};
    fmt::print("{}\n", facts.dump(2));
    return k_exit_fine;
  }
  // What an engine prints must not get between the frames.
  const int frames = ::dup(STDOUT_FILENO);
  if (frames < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    return complain("standard output cannot be set aside", k_exit_infrastructure);
  }
  const auto served = remote::serve(*adapter, STDIN_FILENO, frames);
  return served ? k_exit_fine : complain(served.error().reason, k_exit_bad_input);
}

}  // namespace

void add_serve_verb(CLI::App& app, Invocation& invocation) {
  struct Choice {
    std::string engine;
    bool json = false;
  };
  CLI::App* verb = app.add_subcommand(
      "serve", "Offer a linked engine over the protocol, on standard input and output");
  auto choice = std::make_shared<Choice>();
  verb->add_option("engine", choice->engine, "A linked engine, with all its variants")->required();
  verb->add_flag("--json", choice->json, "Say what would be served, as JSON, and serve nothing");
  verb->callback(
      [choice, &invocation] { invocation.exit_code = serve_engine(choice->engine, choice->json); });
}

}  // namespace brickbench
