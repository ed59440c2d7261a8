#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/json_number.hpp"
#include "cli/report_output.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/schema.hpp"
#include "reports/src/cell_table.hpp"

namespace brickbench {
namespace {

struct TableOptions {
  std::vector<std::string> folders;
  std::string out;
  bool wide = false;
  bool json = false;
};

// An array of objects; null where the field is empty or the number infinite.
nlohmann::ordered_json json_of(const FlatTable& table) {
  auto array = nlohmann::ordered_json::array();
  for (const auto& row : table.rows) {
    nlohmann::ordered_json object;
    for (std::size_t i = 0; i < row.size(); ++i) {
      nlohmann::ordered_json& place = object[table.header[i]];
      if (!table.is_number[i]) {
        place = row[i];
      } else if (const auto number = parse_number(row[i])) {
        place = json_number(*number);
      }
    }
    array.push_back(std::move(object));
  }
  return array;
}

int tabulate(const TableOptions& options) {
  if (auto ok = check_is_new(options.out); !ok) return complain(ok.error());
  const auto sources = read_sources(options.folders);
  if (!sources) return complain(sources.error());
  const CellTable cells = cell_table(*sources);
  const FlatTable table = options.wide ? wide_table(cells) : long_table(cells);
  const std::string text = options.json ? json_of(table).dump(2) + '\n' : to_csv(table);
  if (options.out.empty()) {
    fmt::print("{}", text);
  } else if (auto ok = write_new_file(options.out, text); !ok) {
    return complain(ok.error());
  }
  return table.rows.empty() ? k_exit_incomplete : k_exit_fine;
}

}  // namespace

void add_table_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "table", "Print results folders as one CSV table with a column for each axis");
  auto options = std::make_shared<TableOptions>();
  verb->add_option("folders", options->folders, "Results folders")->required();
  verb->add_flag("--wide", options->wide, "One line per cell, and each number a column too");
  verb->add_option("--out", options->out, "New file; default standard output");
  verb->add_flag("--json", options->json, "An array of objects instead of CSV");
  verb->callback([options, &invocation] { invocation.exit_code = tabulate(*options); });
}

}  // namespace brickbench
