#include "experiments/regression/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/record/file.hpp"

namespace brickbench::gate {
namespace {

using Json = nlohmann::ordered_json;

Kind kind_of(const std::string& word) {
  for (const Kind kind : {Kind::hash, Kind::bound, Kind::distribution}) {
    if (word == to_word(kind)) return kind;
  }
  throw std::invalid_argument("kind '" + word + "': hash, bound or distribution");
}

Json json_of(const Record& record) {
  Json json = {{"engine", record.engine},      {"axes", record.axes},  {"metric", record.metric},
               {"kind", to_word(record.kind)}, {"unit", record.unit},  {"better", record.better},
               {"outcome", record.outcome},    {"seeds", record.seeds}};
  if (record.validity) json["validity"] = *record.validity;
  if (!record.values.empty()) json["values"] = record.values;
  if (!record.hashes.empty()) json["hashes"] = record.hashes;
  if (record.kind == Kind::bound) {
    json["residual"] = record.residual;
    json["bound"] = record.bound;
  }
  if (record.kind == Kind::distribution) json["margin"] = record.margin;
  json["why"] = record.why;
  json["engine_version"] = record.engine_version;
  json["precision"] = record.precision;
  json["platform"] = record.platform;
  json["blessed"] = {{"reason", record.blessed.reason},
                     {"date_utc", record.blessed.date_utc},
                     {"revision", record.blessed.revision},
                     {"machine", record.blessed.machine},
                     {"compiler", record.blessed.compiler}};
  return json;
}

Record record_of(const Json& json) {
  Record record;
  record.engine = json.at("engine").get<std::string>();
  record.axes = json.at("axes").get<std::string>();
  record.metric = json.at("metric").get<std::string>();
  record.kind = kind_of(json.at("kind").get<std::string>());
  record.unit = json.at("unit").get<std::string>();
  record.better = json.at("better").get<std::string>();
  record.outcome = json.at("outcome").get<std::string>();
  record.validity.reset();
  if (json.contains("validity")) record.validity = json.at("validity").get<std::string>();
  record.seeds = json.at("seeds").get<std::vector<std::uint64_t>>();
  if (json.contains("values")) record.values = json.at("values").get<std::vector<double>>();
  if (json.contains("hashes")) record.hashes = json.at("hashes").get<std::vector<std::string>>();
  if (record.kind == Kind::bound) {
    record.residual = json.at("residual").get<double>();
    record.bound = json.at("bound").get<double>();
  }
  if (record.kind == Kind::distribution) record.margin = json.at("margin").get<double>();
  record.why = json.at("why").get<std::string>();
  record.engine_version = json.at("engine_version").get<std::string>();
  record.precision = json.at("precision").get<std::string>();
  record.platform = json.at("platform").get<std::string>();
  const Json& blessed = json.at("blessed");
  record.blessed = {
      blessed.at("reason").get<std::string>(), blessed.at("date_utc").get<std::string>(),
      blessed.at("revision").get<std::string>(), blessed.at("machine").get<std::string>(),
      blessed.at("compiler").get<std::string>()};
  const bool wanted = record.outcome == "ok";
  const std::size_t numbers =
      record.kind == Kind::hash ? record.hashes.size() : record.values.size();
  if (wanted && numbers != record.seeds.size()) {
    throw std::invalid_argument(
        fmt::format("{}: {} seeds but {} values", record.key(), record.seeds.size(), numbers));
  }
  return record;
}

std::ptrdiff_t lines_before(const std::string& text, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return std::count(text.begin(), end, '\n');
}

// "drop.json:3", or "drop.json, record 2" in a file that is not laid out as to_text does.
std::string place_of(const std::filesystem::path& file, const std::string& text, std::size_t index,
                     std::size_t records) {
  const bool one_per_line = lines_before(text, text.size()) == std::ptrdiff_t(records) + 2;
  return one_per_line ? fmt::format("{}:{}", file.string(), index + 2)
                      : fmt::format("{}, record {}", file.string(), index + 1);
}

Expected<std::vector<Record>> records_of(const std::filesystem::path& file,
                                         const std::string& text) {
  std::vector<Record> records;
  std::string place = file.string();
  try {
    const Json list = Json::parse(text);
    if (!list.is_array()) throw std::invalid_argument("not a list of records");
    for (const Json& json : list) {
      place = place_of(file, text, records.size(), list.size());
      records.push_back(record_of(json));
    }
  } catch (const Json::parse_error& problem) {
    const auto line = 1 + lines_before(text, problem.byte == 0 ? 0 : problem.byte - 1);
    return fail(Fault::invalid, fmt::format("{}:{}: {}", file.string(), line, problem.what()));
  } catch (const std::exception& problem) {
    return fail(Fault::invalid, fmt::format("{}: {}", place, problem.what()));
  }
  return records;
}

}  // namespace

std::string_view to_word(Kind kind) {
  switch (kind) {
    case Kind::hash:
      return "hash";
    case Kind::bound:
      return "bound";
    case Kind::distribution:
      return "distribution";
  }
  return "bound";
}

const Record* Suite::find(const std::string& experiment, const std::string& key) const {
  for (const Experiment& candidate : experiments) {
    if (candidate.name != experiment) continue;
    for (const Record& record : candidate.records) {
      if (record.key() == key) return &record;
    }
  }
  return nullptr;
}

// One record per line: a change of one number is a change of one line.
std::string to_text(const Suite::Experiment& experiment) {
  std::string text = "[\n";
  for (std::size_t i = 0; i < experiment.records.size(); ++i) {
    text += json_of(experiment.records[i]).dump();
    text += i + 1 < experiment.records.size() ? ",\n" : "\n";
  }
  return text + "]\n";
}

Expected<Suite> read_suite(const std::filesystem::path& folder) {
  Suite suite;
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    return fail(Fault::invalid, fmt::format("{}: {}", folder.string(), error.message()));
  }
  std::ranges::sort(files);
  for (const auto& file : files) {
    const auto text = read_file(file);
    if (!text) return tl::unexpected(text.error());
    auto records = records_of(file, *text);
    if (!records) return tl::unexpected(records.error());
    suite.experiments.push_back({file.stem().string(), std::move(*records)});
  }
  return suite;
}

Expected<void> write_suite(const std::filesystem::path& folder, const Suite& suite) {
  if (auto made = create_new_folder(folder); !made) return made;
  for (const Suite::Experiment& experiment : suite.experiments) {
    const auto file = folder / (experiment.name + ".json");
    if (auto ok = write_new_file(file, to_text(experiment)); !ok) return ok;
  }
  return {};
}

}  // namespace brickbench::gate
