#include <fmt/format.h>

#include <cstdlib>

#include "adapters/seam/unit.hpp"
#include "cli/complain.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/regression/check.hpp"

namespace brickbench {
namespace {

struct BlessOptions {
  std::string from;
  std::string reference = "reference_data/baseline";
  std::string reason;
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

Expected<std::size_t> bless_suite(const std::filesystem::path& from,
                                  const std::filesystem::path& to, const gate::Blessing& blessing) {
  const auto obtained = gate::read_suite(from);
  if (!obtained) return tl::unexpected(obtained.error());
  const auto reference = gate::read_suite(to);
  if (!reference) return tl::unexpected(reference.error());
  const gate::BlessResult result = gate::bless(*reference, *obtained, blessing, {});
  for (const gate::Comparison& c : result.changed) {
    const std::string_view trend = gate::to_word(c.trend);
    fmt::print("{} {} {} {}: {} -> {}{}{}\n", c.experiment, c.obtained.engine, c.obtained.axes,
               c.obtained.metric.empty() ? "state hash" : c.obtained.metric,
               c.finding == gate::Finding::fresh ? "none" : fmt::format("{}", c.reference_value),
               c.finding == gate::Finding::fresh ? "new" : fmt::format("{}", c.obtained_value),
               unit_suffix(c.obtained.unit), trend.empty() ? "" : fmt::format(" ({})", trend));
  }
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
  return result.changed.size();
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
  std::size_t changed = 0;
  for (const auto& entry : std::filesystem::directory_iterator(options.from)) {
    if (!entry.is_directory()) continue;
    const auto suite = entry.path().filename();
    const auto count =
        bless_suite(entry.path(), std::filesystem::path(options.reference) / suite, blessing);
    if (!count) return complain(count.error());
    changed += *count;
    ++suites;
  }
  if (suites == 0) {
    return complain(
        fmt::format("--from {}: holds no suite; give the folder that check printed, which "
                    "has one folder per suite",
                    options.from),
        k_exit_bad_input);
  }
  fmt::print("{} references changed. Commit them with the change that caused them.\n", changed);
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
  verb->callback([options, &invocation] { invocation.exit_code = bless(*options); });
}

}  // namespace brickbench
