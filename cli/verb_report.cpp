#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/ensemble_verdicts.hpp"
#include "cli/record_command.hpp"
#include "cli/replay_depths.hpp"
#include "cli/report_output.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"

namespace brickbench {
namespace {

struct ReportVerbOptions {
  std::vector<std::string> folders;
  std::string out;
  std::string against;
  std::size_t replay_frames = 240;
  bool no_pdf = false;
  bool json = false;
};

int report(const ReportVerbOptions& options) {
  if (auto ok = check_is_new(options.out); !ok) return complain(ok.error());
  auto sources = read_sources(options.folders);
  if (!sources) return complain(sources.error());
  fold_validations(*sources);
  add_replay_depths(*sources, options.replay_frames);
  ReportOptions how{.replay_frames = options.replay_frames};
  for (const ReportSource& source : *sources) {
    how.ensembles.push_back(ensembles_within(source, options.against));
    judge(how.ensembles.back());
  }
  const auto files = report_files(*sources, page_assets(), how);
  const std::vector<Figure> figures = report_figures(*sources, how);
  const auto written = write_report(options.out, files, figures, !options.no_pdf);
  if (!written) return complain(written.error());
  if (!page_assets().missing.empty()) {
    fmt::print(stderr, "brickbench: static figures and no 3D view: {}\n", page_assets().missing);
  }
  if (!written->no_pdf_reason.empty()) {
    fmt::print(stderr, "brickbench: no PDF figures: {}\n", written->no_pdf_reason);
  }
  const bool has_motion = std::ranges::any_of(
      *sources, [](const ReportSource& source) { return !source.replays.empty(); });
  const std::string record = has_motion ? "" : record_command(sources->front().provenance);
  if (options.json) {
    const nlohmann::ordered_json json = {{"folder", options.out},
                                         {"page", options.out + "/index.html"},
                                         {"page_bytes", files.front().content.size()},
                                         {"figures", figures.size()},
                                         {"pdf_figures", written->pdfs},
                                         {"missing", page_assets().missing},
                                         {"record_command", record}};
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{} figures, {} of them as PDF too.\nPage: {}/index.html ({:.2f} MB)\n",
               figures.size(), written->pdfs, options.out,
               static_cast<double>(files.front().content.size()) / 1e6);
    if (!record.empty()) fmt::print("No motion was recorded. To see it: {}\n", record);
  }
  return k_exit_fine;
}

}  // namespace

void add_report_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "report", "Make a page, Markdown and figures from one or more results folders");
  auto options = std::make_shared<ReportVerbOptions>();
  verb->add_option("folders", options->folders, "Results folders")->required();
  verb->add_option("--out", options->out, "New folder for the report")->required();
  verb->add_option("--against", options->against,
                   "Engine that ensembles are compared with; default the first of each scene");
  verb->add_option("--replay-frames", options->replay_frames, "Frames per replay at most")
      ->check(CLI::Range(2, 2000));
  verb->add_flag("--no-pdf", options->no_pdf, "No PDF figures, even if gnuplot is there");
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = report(*options); });
}

}  // namespace brickbench
