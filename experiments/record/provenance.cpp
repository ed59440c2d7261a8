#include "experiments/record/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <sched.h>
#include <sys/utsname.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "experiments/record/revision.hpp"

namespace brickbench {
namespace {

// Value after the first line "key<spaces><separator> value" of a file; "" if there is none.
std::string value_in_file(const char* file, std::string_view key, char separator) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const auto at = line.find(separator);
    if (!line.starts_with(key) || at == std::string::npos) continue;
    std::string value = line.substr(at + 1);
    while (!value.empty() && (value.front() == ' ' || value.front() == '"')) value.erase(0, 1);
    while (!value.empty() && (value.back() == ' ' || value.back() == '"')) value.pop_back();
    return value;
  }
  return "";
}

unsigned usable_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  return ::sched_getaffinity(0, sizeof set, &set) == 0 ? static_cast<unsigned>(CPU_COUNT(&set))
                                                       : 1U;
}

}  // namespace

Machine this_machine() {
  Machine machine;
  machine.revision = source_revision();
  machine.compiler = build_compiler();
  machine.flags = build_flags();
  machine.build_type = build_type();
  machine.cpu = value_in_file("/proc/cpuinfo", "model name", ':');
  if (machine.cpu.empty()) machine.cpu = "unknown CPU";
  machine.cores = usable_cores();
  utsname system{};
  if (::uname(&system) == 0) {
    machine.architecture = system.machine;
    machine.system = fmt::format("{}, {} {}", value_in_file("/etc/os-release", "PRETTY_NAME", '='),
                                 system.sysname, system.release);
  }
  return machine;
}

nlohmann::ordered_json to_json(const Machine& machine) {
  return {{"revision", machine.revision}, {"compiler", machine.compiler},
          {"flags", machine.flags},       {"build_type", machine.build_type},
          {"cpu", machine.cpu},           {"architecture", machine.architecture},
          {"cores", machine.cores},       {"system", machine.system}};
}

nlohmann::ordered_json to_json(const Provenance& provenance) {
  auto engines = nlohmann::ordered_json::array();
  for (const EngineRecord& engine : provenance.engines) {
    engines.push_back({{"id", engine.name},
                       {"version", engine.version},
                       {"precision", engine.precision},
                       {"own", engine.own}});
  }
  auto metrics = nlohmann::ordered_json::array();
  for (const MetricRecord& metric : provenance.metrics) {
    metrics.push_back({{"id", metric.name},
                       {"unit", metric.unit},
                       {"group", metric.group},
                       {"better", metric.better},
                       {"meaning", metric.meaning},
                       {"good", metric.good}});
  }
  auto methods = nlohmann::ordered_json::array();
  for (const MethodRecord& method : provenance.methods) {
    auto facts = nlohmann::ordered_json::array();
    for (const MethodFact& fact : method.facts) {
      facts.push_back(
          {{"name", fact.name}, {"unit", fact.unit}, {"asked", fact.asked}, {"used", fact.used}});
    }
    methods.push_back({{"engine", method.engine}, {"facts", facts}});
  }
  auto scenes = nlohmann::ordered_json::array();
  for (const SceneRecord& scene : provenance.scenes) {
    scenes.push_back(
        {{"id", scene.name}, {"file", scene.file}, {"hash", scene.hash}, {"text", scene.text}});
  }
  return {{"schema", 2},
          {"command", provenance.command},
          {"date_utc", provenance.date_utc},
          {"plan", provenance.plan},
          {"set", provenance.set},
          {"engine_files", provenance.engine_files},
          {"title", provenance.title},
          {"analysis", provenance.analysis},
          {"machine", to_json(provenance.machine)},
          {"engines", engines},
          {"metrics", metrics},
          {"methods", methods},
          {"scenes", scenes}};
}

Expected<Provenance> provenance_from_json(const nlohmann::ordered_json& json) {
  try {
    Provenance result;
    result.command = json.at("command");
    result.date_utc = json.at("date_utc");
    result.plan = json.at("plan");
    result.set = json.value("set", std::vector<std::string>());
    result.engine_files = json.value("engine_files", std::vector<std::string>());
    result.title = json.at("title");
    result.analysis = json.at("analysis");
    const auto& machine = json.at("machine");
    result.machine = {.revision = machine.at("revision"),
                      .compiler = machine.at("compiler"),
                      .flags = machine.at("flags"),
                      .build_type = machine.at("build_type"),
                      .cpu = machine.at("cpu"),
                      .architecture = machine.at("architecture"),
                      .cores = machine.at("cores"),
                      .system = machine.at("system")};
    for (const auto& engine : json.at("engines")) {
      result.engines.push_back(
          {engine.at("id"), engine.at("version"), engine.at("precision"), engine.at("own")});
    }
    for (const auto& metric : json.at("metrics")) {
      result.metrics.push_back({metric.at("id"), metric.at("unit"), metric.at("group"),
                                metric.at("better"), metric.at("meaning"), metric.at("good")});
    }
    for (const auto& scene : json.value("scenes", nlohmann::ordered_json::array())) {
      result.scenes.push_back(
          {scene.at("id"), scene.at("file"), scene.at("hash"), scene.at("text")});
    }
    for (const auto& method : json.value("methods", nlohmann::ordered_json::array())) {
      MethodRecord record{method.at("engine"), {}};
      for (const auto& fact : method.at("facts")) {
        record.facts.push_back(
            {fact.at("name"), fact.at("unit"), fact.at("asked"), fact.at("used")});
      }
      result.methods.push_back(std::move(record));
    }
    return result;
  } catch (const nlohmann::json::exception& error) {
    return fail(Fault::invalid, fmt::format("provenance: {}", error.what()));
  }
}

std::string now_utc() {
  const auto now =
      std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
}

std::string shell_command(const std::vector<std::string>& arguments) {
  constexpr std::string_view plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./=:,+@%";
  std::string text;
  for (const std::string& argument : arguments) {
    if (!text.empty()) text += ' ';
    if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos) {
      text += argument;
      continue;
    }
    text += '\'';
    for (const char c : argument) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += '\'';
  }
  return text;
}

}  // namespace brickbench
