#include "experiments/hunt/record.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "experiments/hunt/codec.hpp"

namespace brickbench::hunt {
namespace {

constexpr const char* k_file = "progress.jsonl";

Json quarry_json(const Quarry& quarry) {
  auto engines = Json::array();
  for (const EngineVariant& engine : quarry.engines) engines.push_back(engine.label());
  return {{"seed", quarry.seed}, {"engines", engines}, {"scenes", quarry.scenes}};
}

void read_line(const Json& line, Record& record) {
  if (line.contains("trial")) {
    record.add(line.at("number").get<std::uint64_t>(), trial_of(line.at("trial")),
               verdict_of(line.at("verdict")));
  } else if (line.contains("shrunk")) {
    record.add(line.at("find").get<std::size_t>(), shrunk_of(line.at("shrunk")));
  } else {
    Verdict verdict;
    verdict.outcome = line.at("outcome").get<std::string>();
    record.add(line.at("number").get<std::uint64_t>(), {}, verdict);
  }
}

}  // namespace

std::string kind_key(std::string_view oracle, const Trial& trial) {
  return fmt::format("{} | {} | {}", oracle, trial.engine.label(), trial.scene);
}

std::vector<std::size_t> Record::add(std::uint64_t number, const Trial& trial,
                                     const Verdict& verdict) {
  judged_ = number + 1;
  ++outcomes_[verdict.outcome];
  std::vector<std::size_t> added;
  for (const Breach& breach : verdict.breaches) {
    const std::string kind = kind_key(breach.oracle, trial);
    if (verdict.is_told()) {
      ++told_[kind];
    } else if (++seen_[kind] <= k_shrunk_of_kind) {
      added.push_back(finds_.size());
      finds_.push_back({number, breach.oracle, trial, verdict});
    }
  }
  return added;
}

Expected<ProgressFile> ProgressFile::create(const std::filesystem::path& folder,
                                            const Quarry& quarry) {
  std::error_code error;
  if (std::filesystem::exists(folder, error)) {
    return fail(Fault::invalid,
                fmt::format("{} exists already; --resume goes on with it", folder.string()));
  }
  if (!std::filesystem::create_directories(folder, error)) {
    return fail(Fault::crashed,
                fmt::format("cannot make {}: {}", folder.string(), error.message()));
  }
  ProgressFile progress(folder / k_file);
  if (auto ok = progress.write_line(Json{{"hunt", quarry_json(quarry)}}.dump()); !ok) {
    return tl::unexpected(ok.error());
  }
  return progress;
}

Expected<ProgressFile> ProgressFile::resume(const std::filesystem::path& folder,
                                            const Quarry& quarry, Record& record) {
  const std::filesystem::path file = folder / k_file;
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail(Fault::invalid, fmt::format("there is no hunt in {}", folder.string()));
  std::stringstream text;
  text << in.rdbuf();
  std::string all = text.str();
  const auto last = all.rfind('\n');
  const std::size_t whole = last == std::string::npos ? 0 : last + 1;
  std::istringstream lines(all.substr(0, whole));
  std::size_t number = 0;
  try {
    for (std::string line; std::getline(lines, line);) {
      ++number;
      const Json json = Json::parse(line);
      if (number > 1) {
        read_line(json, record);
      } else if (json.at("hunt") != quarry_json(quarry)) {
        return fail(Fault::invalid, fmt::format("{} is of another hunt: {}", file.string(),
                                                json.at("hunt").dump()));
      }
    }
  } catch (const Json::exception& error) {
    return fail(Fault::invalid, fmt::format("{}:{}: {}", file.string(), number, error.what()));
  }
  if (number == 0) return fail(Fault::invalid, fmt::format("{} is empty", file.string()));
  std::error_code error;
  std::filesystem::resize_file(file, whole, error);
  if (error) return fail(Fault::crashed, fmt::format("{}: {}", file.string(), error.message()));
  return ProgressFile(file);
}

Expected<void> ProgressFile::append(std::uint64_t number, const Trial& trial,
                                    const Verdict& verdict) const {
  Json line = {{"number", number}};
  if (verdict.breaches.empty()) {
    line["outcome"] = verdict.outcome;
  } else {
    line["trial"] = to_json(trial);
    line["verdict"] = to_json(verdict);
  }
  return write_line(line.dump());
}

Expected<void> ProgressFile::append(std::size_t find, const Shrunk& shrunk) const {
  return write_line(Json{{"find", find}, {"shrunk", to_json(shrunk)}}.dump());
}

Expected<void> ProgressFile::write_line(const std::string& line) const {
  std::ofstream out(file_, std::ios::binary | std::ios::app);
  out << line << '\n';
  out.flush();
  if (!out) return fail(Fault::crashed, fmt::format("cannot write {}", file_.string()));
  return {};
}

}  // namespace brickbench::hunt
