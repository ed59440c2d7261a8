#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>

#include "adapters/seam/unit.hpp"
#include "cli/complain.hpp"
#include "cli/json_number.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/regression/check.hpp"

namespace brickbench {
namespace {

struct BlessOptions {
  std::string from;
  std::string reference = "reference_data/baseline";
  std::string reason;
  bool json = false;
};

// A reference is replaced by a whole new file: the old one stays until the new one is on the disk.
Expected<void> replace(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::path fresh = file;
  fresh += ".new";
  if (auto ok = write_new_file(fresh, text); !ok) return ok;
  std::error_code error;
  std::filesystem::rename(fresh, file, error);
  if (error) return fail(Fault::crashed, file.string() + ": " + error.message());
  return {};
}

// What was decided before all starts of its reference were run is no reference.
Expected<void> check_starts(const gate::BlessResult& result, const std::filesystem::path& from) {
  for (const gate::Comparison& c : result.changed) {
    if (c.obtained.seeds.size() >= c.reference.seeds.size()) continue;
    return fail(
        Fault::invalid,
        fmt::format("{} holds {} of the {} starts of {} {}: the check was decided early. Run "
                    "it again with --all-starts and bless that",
                    from.string(), c.obtained.seeds.size(), c.reference.seeds.size(), c.experiment,
                    c.obtained.engine));
  }
  return {};
}

void print_changed(const gate::Comparison& c) {
  const std::string_view trend = gate::to_word(c.trend);
  const bool fresh = c.finding == gate::Finding::fresh;
  fmt::print("{} {} {} {}: {} -> {}{}{}\n", c.experiment, c.obtained.engine, c.obtained.axes,
             c.obtained.metric.empty() ? "state hash" : c.obtained.metric,
             fresh ? "none" : fmt::format("{}", c.reference_value),
             fresh ? "new" : fmt::format("{}", c.obtained_value), unit_suffix(c.obtained.unit),
             trend.empty() ? "" : fmt::format(" ({})", trend));
}

// The references that changed.
Expected<std::vector<gate::Comparison>> bless_suite(const std::filesystem::path& from,
                                                    const std::filesystem::path& to,
                                                    const gate::Blessing& blessing) {
  const auto obtained = gate::read_suite(from);
  if (!obtained) return tl::unexpected(obtained.error());
  const auto reference = gate::read_suite(to);
  if (!reference) return tl::unexpected(reference.error());
  const gate::BlessResult result = gate::bless(*reference, *obtained, blessing, {});
  if (auto ok = check_starts(result, from); !ok) return tl::unexpected(ok.error());
  std::error_code error;
  std::filesystem::create_directories(to, error);
  if (error) return fail(Fault::crashed, to.string() + ": " + error.message());
  for (const gate::Suite::Experiment& experiment : result.suite.experiments) {
    const bool touched = std::ranges::any_of(
        result.changed, [&](const auto& c) { return c.experiment == experiment.name; });
    if (!touched) continue;
    const auto written = replace(to / (experiment.name + ".json"), gate::to_text(experiment));
    if (!written) return tl::unexpected(written.error());
  }
  return result.changed;
}

void print_result(const std::vector<gate::Comparison>& changed, bool as_json) {
  if (!as_json) {
    std::ranges::for_each(changed, print_changed);
    fmt::print("{} references changed. Commit them with the change that caused them.\n",
               changed.size());
    return;
  }
  auto records = nlohmann::ordered_json::array();
  for (const gate::Comparison& c : changed) {
    const bool fresh = c.finding == gate::Finding::fresh;
    records.push_back(
        {{"id", c.experiment + '|' + c.obtained.key()},
         {"unit", c.obtained.unit},
         {"before", fresh ? json_number(std::nan("")) : json_number(c.reference_value)},
         {"after", fresh ? json_number(std::nan("")) : json_number(c.obtained_value)},
         {"is_new", fresh},
         {"trend", gate::to_word(c.trend)}});
  }
  fmt::print("{}\n", records.dump(2));
}

int bless(const BlessOptions& options) {
  for (const char* name : {"CI", "GITHUB_ACTIONS"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || std::string_view(value).empty() || std::string_view(value) == "false") {
      continue;
    }
    return complain(
        fmt::format("bless is refused under CI ({}={}): a person accepts references", name, value),
        k_exit_bad_input);
  }
  if (options.reason.find_first_not_of(" \t\n") == std::string::npos) {
    return complain("--reason must say why the new numbers are right", k_exit_bad_input);
  }
  if (!std::filesystem::is_directory(options.from)) {
    return complain(fmt::format("--from {}: no such folder", options.from), k_exit_bad_input);
  }
  const Machine machine = this_machine();
  const gate::Blessing blessing{options.reason, now_utc(), machine.revision, machine.label(),
                                machine.compiler};
  std::size_t suites = 0;
  std::vector<gate::Comparison> changed;
  for (const auto& entry : std::filesystem::directory_iterator(options.from)) {
    if (!entry.is_directory()) continue;
    const auto suite = entry.path().filename();
    auto blessed =
        bless_suite(entry.path(), std::filesystem::path(options.reference) / suite, blessing);
    if (!blessed) return complain(blessed.error());
    std::ranges::move(*blessed, std::back_inserter(changed));
    ++suites;
  }
  if (suites == 0) {
    return complain(
        fmt::format("--from {}: holds no suite; give the folder that check printed, which "
                    "has one folder per suite",
                    options.from),
        k_exit_bad_input);
  }
  print_result(changed, options.json);
  return k_exit_fine;
}

}  // namespace

void add_bless_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand("bless", "Accept the numbers of a check as new references");
  auto options = std::make_shared<BlessOptions>();
  verb->add_option("--from", options->from, "The obtained/ folder of a check")->required();
  verb->add_option("--reason", options->reason, "Why the new numbers are right")->required();
  verb->add_option("--reference", options->reference,
                   "Folder of the references; default reference_data/baseline");
  verb->add_flag("--json", options->json, "What changed as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = bless(*options); });
}

}  // namespace brickbench
