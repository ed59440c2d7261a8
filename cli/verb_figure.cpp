#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/number_option.hpp"
#include "cli/report_output.hpp"
#include "cli/verbs.hpp"
#include "experiments/input/input.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/provenance.hpp"
#include "reports/src/paper_figure.hpp"

namespace brickbench {
namespace {

// Widths of a column and of a page in most journals of two columns, cm.
constexpr double k_column_cm = 8.6;
constexpr double k_page_cm = 17.8;

struct FigureOptions {
  std::vector<std::string> folders;
  FigureAsk ask;
  std::vector<std::string> where;
  std::string error = "ci";
  std::string log;
  std::string width = "column";
  std::string out;
  bool json = false;
};

Expected<void> check_name(const std::string& option, const std::string& name,
                          const std::vector<std::string>& known) {
  if (std::ranges::count(known, name) > 0) return {};
  return fail(Fault::invalid,
              fmt::format("{}: no '{}' here{}", option, name, known_names(name, known)));
}

Expected<void> check_names(const FigureAsk& ask, const CellTable& table) {
  std::vector<std::string> numbers;
  for (const NumberName& number : table.numbers) numbers.push_back(number.name);
  if (auto ok = check_name("--y", ask.y, numbers); !ok) return ok;
  const std::vector<std::string> settings = setting_names(table);
  for (const auto& [option, name] : {std::pair{"--x", ask.x}, {"--group", ask.group}}) {
    if (auto ok = check_name(option, name, settings); !ok) return ok;
  }
  if (!ask.facet.empty()) {
    if (auto ok = check_name("--facet", ask.facet, settings); !ok) return ok;
  }
  for (const auto& [name, value] : ask.where) {
    if (auto ok = check_name("--where", name, settings); !ok) return ok;
  }
  std::vector<std::string> engines;
  for (const CellLine& line : table.lines) {
    if (std::ranges::count(engines, line.engine) == 0) engines.push_back(line.engine);
  }
  for (const std::string& engine : ask.engines) {
    if (auto ok = check_name("--engine", engine, engines); !ok) return ok;
  }
  return {};
}

Expected<FigureAsk> ask_of(const FigureOptions& options) {
  FigureAsk ask = options.ask;
  for (const std::string& condition : options.where) {
    const auto equals = condition.find('=');
    if (equals == std::string::npos || equals == 0) {
      return fail(Fault::invalid, fmt::format("--where needs name=value, not '{}'", condition));
    }
    ask.where.emplace_back(condition.substr(0, equals), condition.substr(equals + 1));
  }
  ask.error = options.error == "ci"      ? ErrorBars::interval
              : options.error == "range" ? ErrorBars::range
                                         : ErrorBars::none;
  ask.log_x = options.log.find('x') != std::string::npos;
  ask.log_y = options.log.find('y') != std::string::npos;
  return ask;
}

// Draws in a folder of its own, so that a file appears whole or not at all.
Expected<void> draw(const PaperFigure& figure, PaperFormat format, const std::string& out,
                    double width_cm) {
  const std::string gnuplot = program_on_path({"gnuplot"});
  if (gnuplot.empty()) {
    return fail(Fault::crashed,
                "figures need gnuplot, which is not installed (in Debian the package gnuplot-nox); "
                "--out FILE.csv needs nothing");
  }
  std::string pattern = (std::filesystem::temp_directory_path() / "brickbench-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) return fail(Fault::crashed, "no temporary folder");
  const std::filesystem::path folder = pattern;
  struct Cleaner {
    std::filesystem::path folder;
    ~Cleaner() {
      std::error_code ignored;
      std::filesystem::remove_all(folder, ignored);
    }
  } const cleaner{folder};
  if (auto ok =
          write_new_file(folder / "figure.gp", to_gnuplot(figure, format, "figure.out", width_cm));
      !ok) {
    return ok;
  }
  const std::string command =
      fmt::format("cd {} && {} figure.gp >said 2>&1", shell_command({folder.string()}),
                  shell_command({gnuplot}));
  const int status = std::system(command.c_str());
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    const auto said = read_file(folder / "said");
    return fail(Fault::crashed, "gnuplot failed: " + (said ? *said : std::string()));
  }
  undate_pdf(folder / "figure.out");
  const auto bytes = read_file(folder / "figure.out");
  if (!bytes || bytes->empty()) return fail(Fault::crashed, "gnuplot drew nothing");
  return write_new_file(out, *bytes);
}

Expected<void> write_figure(const PaperFigure& figure, const std::string& out,
                            const std::string& width) {
  const std::string kind = std::filesystem::path(out).extension().string();
  if (kind == ".csv") return write_new_file(out, to_csv(figure));
  const double width_cm = width == "column" ? k_column_cm : k_page_cm;
  if (kind == ".pdf") return draw(figure, PaperFormat::pdf, out, width_cm);
  if (kind == ".svg") return draw(figure, PaperFormat::svg, out, width_cm);
  if (kind == ".png") return draw(figure, PaperFormat::png, out, width_cm);
  return fail(Fault::invalid,
              fmt::format("--out {}: the name must end in .pdf, .svg, .png or .csv", out));
}

int figure(const FigureOptions& options) {
  if (auto ok = check_is_new(options.out); !ok) return complain(ok.error());
  const auto ask = ask_of(options);
  if (!ask) return complain(ask.error());
  const auto sources = read_sources(options.folders);
  if (!sources) return complain(sources.error());
  const CellTable table = cell_table(*sources);
  if (auto ok = check_names(*ask, table); !ok) return complain(ok.error());
  const auto drawn = paper_figure(table, *ask);
  if (!drawn) return complain(drawn.error());
  if (auto ok = write_figure(*drawn, options.out, options.width); !ok) return complain(ok.error());
  if (options.json) {
    fmt::print("{}\n", nlohmann::ordered_json({{"file", options.out},
                                               {"x", drawn->x.label},
                                               {"y", drawn->y.label},
                                               {"groups", drawn->groups},
                                               {"panels", drawn->panels.size()},
                                               {"caption", drawn->caption}})
                           .dump(2));
  } else {
    fmt::print("{}\n{}\n", options.out, drawn->caption);
  }
  return k_exit_fine;
}

}  // namespace

void add_figure_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "figure", "Draw one number of results folders against a setting, for a paper");
  auto options = std::make_shared<FigureOptions>();
  verb->add_option("folders", options->folders, "Results folders")->required();
  verb->add_option("--y", options->ask.y, "The number, as `list metrics` names it")->required();
  verb->add_option("--x", options->ask.x, "The setting; default step_s");
  verb->add_option("--facet", options->ask.facet, "A panel for each value of this setting");
  verb->add_option("--group", options->ask.group, "A curve for each value; default engine");
  verb->add_option("--where", options->where, "setting=value of the cells to take; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--engine", options->ask.engines, "engine/variant to draw; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--error", options->error, "Bars: ci, range or none; default ci")
      ->check(CLI::IsMember({"ci", "range", "none"}));
  verb->add_option("--log", options->log, "Logarithmic axes: x, y or xy")
      ->check(CLI::IsMember({"x", "y", "xy"}));
  verb->add_option("--width", options->width, "column (8.6 cm) or page (17.8 cm); default column")
      ->check(CLI::IsMember({"column", "page"}));
  verb->add_option("--out", options->out, "New file, .pdf, .svg, .png or .csv")->required();
  verb->add_flag("--json", options->json, "What was drawn as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = figure(*options); });
}

}  // namespace brickbench
