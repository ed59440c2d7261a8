#include "tests/architecture/rules.hpp"

#include <algorithm>
#include <map>
#include <regex>
#include <sstream>

namespace brickbench::architecture {
namespace {

constexpr std::ptrdiff_t k_longest_file = 450;
constexpr std::ptrdiff_t k_longest_adapter = 350;

// Longest prefix decides. Rooms that may see everything are not listed.
const std::map<std::string, std::vector<std::string>>& arrows() {
  static const std::map<std::string, std::vector<std::string>> table = {
      {"ourengine", {"ourengine"}},
      {"adapters", {"adapters"}},
      {"adapters/remote", {"adapters/remote", "adapters/seam"}},
      {"adapters/seam", {"adapters/seam"}},
      {"experiments", {"experiments", "adapters/seam"}},
      {"reports", {"reports", "experiments/record", "experiments/statistics", "adapters/seam"}}};
  return table;
}

// A house as its floors, the lowest first: a room sees itself and the floors below its own, no
// neighbour on its floor.
using Floors = std::vector<std::vector<std::string>>;

const std::map<std::string, Floors>& houses() {
  static const std::map<std::string, Floors> table = {
      {"ourengine",
       {{"model", "parallel"},
        {"integration", "linear"},
        {"collision"},
        {"contact"},
        {"baraff", "exact", "fast"}}},
      {"experiments",
       {{"scenarios", "process", "record", "statistics", "conformance"},
        {"metrics", "input"},
        {"step", "scenes"},
        {"exact/cases"},
        {"exact/schemes", "exact/sketch"},
        {"exact/validation", "run"},
        {"sweep", "oracle", "regression"},
        {"hunt"}}}};
  return table;
}

// The floor of the room in which the file lies, and the room; -1 if it lies in none.
std::pair<std::ptrdiff_t, std::string> place_in(const std::string& house, const Floors& floors,
                                                const std::string& path) {
  for (std::size_t floor = 0; floor < floors.size(); ++floor) {
    for (const std::string& room : floors[floor]) {
      if (is_below(path, house + "/" + room)) return {static_cast<std::ptrdiff_t>(floor), room};
    }
  }
  return {-1, ""};
}

const std::map<std::string, std::string>& engine_headers() {
  static const std::map<std::string, std::string> table = {
      {"btBullet", "bullet"},         {"bullet/", "bullet"},         {"LinearMath/", "bullet"},
      {"BulletCollision/", "bullet"}, {"BulletDynamics/", "bullet"}, {"ode/", "ode"},
      {"mujoco/", "mujoco"}};
  return table;
}

bool is_cpp(const std::string& path) {
  const std::string end = extension(path);
  return end == ".cpp" || end == ".hpp";
}

std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) {
    found.push_back((*it)[1].str());
  }
  return found;
}

// Where the adapters live, and their tests.
const std::vector<std::string>& adapter_rooms() {
  static const std::vector<std::string> rooms = {"adapters", "tests/conformance",
                                                 "tests/unit/adapters"};
  return rooms;
}

bool is_of_adapters(const std::string& path) {
  return std::ranges::any_of(adapter_rooms(),
                             [&](const std::string& room) { return is_below(path, room); });
}

// The files of an engine's adapter and its tests: NAME* in one of the rooms above.
bool belongs_to(const std::string& path, const std::string& engine) {
  return std::ranges::any_of(adapter_rooms(), [&](const std::string& room) {
    return path.starts_with(room + "/" + engine);
  });
}

bool may_see(const std::string& path, const std::string& included) {
  const std::vector<std::string>* allowed = nullptr;
  std::size_t longest = 0;
  for (const auto& [room, rooms] : arrows()) {
    if (is_below(path, room) && room.size() > longest) {
      allowed = &rooms;
      longest = room.size();
    }
  }
  if (allowed == nullptr) return true;
  // A starter kit is copied elsewhere, so its files include each other as they lie.
  if (is_below(path, "adapters/starter") && included.find('/') == std::string::npos) return true;
  if (is_below(included, "ourengine") && belongs_to(path, "ourengine")) return true;
  return std::ranges::any_of(*allowed,
                             [&](const std::string& room) { return is_below(included, room); });
}

std::string selector_pattern(const Tree& tree) {
  std::string names;
  for (const std::string& name : engine_names(tree)) names += (names.empty() ? "" : "|") + name;
  return "\"((?:" + names + ")(?:/[a-z0-9_]*)?)\"";
}

std::ptrdiff_t line_count(const std::string& text) { return std::ranges::count(text, '\n'); }

std::vector<Finding> longer_than(const Tree& tree, std::ptrdiff_t most, const std::string& rule,
                                 bool (*counts)(const std::string&)) {
  std::vector<Finding> findings;
  for (const auto& [path, content] : tree.files) {
    const std::ptrdiff_t lines = line_count(content);
    if (!counts(path) || lines <= most) continue;
    findings.push_back(
        {rule, path, std::to_string(lines) + " lines, at most " + std::to_string(most)});
  }
  return findings;
}

// Types that a source defines at namespace level, as `outer::Name`; formatted as clang-format does.
std::vector<std::string> types_of(const std::string& source) {
  static const std::regex opening(R"(^(?:inline )?namespace ?([\w:]*) ?\{)");
  static const std::regex definition(
      R"(^(?:struct|class|union|enum class|enum) (?:alignas\(\d+\) )?(\w+)(?: final)?(?: : [^{]*)? ?\{)");
  std::vector<std::string> around, types;
  std::istringstream lines(source);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, match, opening)) {
      around.push_back(match[1]);
    } else if (line.starts_with("}  // namespace") && !around.empty()) {
      around.pop_back();
    } else if (std::regex_search(line, match, definition)) {
      if (std::ranges::find(around, std::string()) != around.end()) continue;
      std::string name;
      for (const std::string& scope : around) name += scope + "::";
      types.push_back(name + match[1].str());
    }
  }
  return types;
}

}  // namespace

std::vector<std::string> engine_names(const Tree& tree) {
  std::vector<std::string> names;
  for (const auto& [path, content] : tree.files) {
    if (is_below(path, "adapters") && extension(path) == ".cmake") names.push_back(file_stem(path));
  }
  return names;
}

std::vector<std::string> scenario_names(const Tree& tree) {
  const auto catalogue = tree.files.find("experiments/scenarios/catalog.cpp");
  if (catalogue == tree.files.end()) return {};
  return matches(catalogue->second, R"(\bScenario (\w+)\(\);)");
}

std::vector<Finding> check_includes(const Tree& tree) {
  std::vector<Finding> findings;
  for (const auto& [path, content] : tree.files) {
    if (!is_cpp(path)) continue;
    for (const std::string& included : matches(content, R"((?:^|\n)#include "([^"]+)\")")) {
      if (!may_see(path, included)) findings.push_back({"include", path, "includes " + included});
    }
    for (const std::string& included : matches(content, R"((?:^|\n)#include [<"]([^">]+)[>"])")) {
      for (const auto& [prefix, engine] : engine_headers()) {
        if (included.starts_with(prefix) && !belongs_to(path, engine)) {
          findings.push_back({"include", path, "includes " + included + " of " + engine});
        }
      }
    }
  }
  return findings;
}

std::vector<Finding> check_floors(const Tree& tree) {
  std::vector<Finding> findings;
  for (const auto& [path, content] : tree.files) {
    for (const auto& [house, floors] : houses()) {
      // What lies at the door, such as the facade of a library, sees all rooms.
      if (!is_cpp(path) || !is_below(path, house) ||
          path.find('/', house.size() + 1) == std::string::npos) {
        continue;
      }
      const auto [floor, room] = place_in(house, floors, path);
      if (room.empty() && !is_below(path, house + "/example")) {
        findings.push_back({"floors", path, "lies in no room that has a floor"});
      }
      for (const std::string& included : matches(content, "#include \"([^\"]+)\"")) {
        const auto [below, other] = place_in(house, floors, included);
        if (room.empty() || other.empty() || other == room || below < floor) continue;
        findings.push_back({"floors", path, "includes " + included});
      }
    }
  }
  return findings;
}

std::vector<Finding> check_engine_names(const Tree& tree) {
  const std::string selector = selector_pattern(tree);
  const std::string comparison = "(?:[=!]= *|find\\(|contains\\(|starts_with\\()" + selector;
  std::vector<Finding> findings;
  for (const auto& [path, content] : tree.files) {
    if (!is_cpp(path) || is_of_adapters(path) || is_below(path, "tests/architecture")) continue;
    const bool test = is_below(path, "tests");
    for (const std::string& name :
         matches(without_comments(content), test ? comparison : selector)) {
      findings.push_back({"engine name", path, "names the engine " + name});
    }
  }
  return findings;
}

std::vector<Finding> check_mixed_paths(const Tree& tree) {
  std::vector<Finding> findings;
  for (const auto& [path, content] : tree.files) {
    // What a hunt found is of one engine in one scene, and says so.
    if (is_below(path, "reference_data/found")) continue;
    const std::vector<std::string> parts = words(path, "/_.-");
    for (const std::string& engine : engine_names(tree)) {
      if (std::ranges::find(parts, engine) == parts.end()) continue;
      for (const std::string& scenario : scenario_names(tree)) {
        const std::vector<std::string> needle = words(scenario, "_");
        if (std::search(parts.begin(), parts.end(), needle.begin(), needle.end()) != parts.end()) {
          findings.push_back({"mixed path", path, "names " + engine + " and " + scenario});
        }
      }
    }
  }
  return findings;
}

std::vector<Finding> check_lengths(const Tree& tree) {
  return longer_than(tree, k_longest_file, "length", [](const std::string& path) {
    return is_cpp(path) || extension(path) == ".cmake" || extension(path) == ".sh";
  });
}

std::vector<Finding> long_adapters(const Tree& tree) {
  return longer_than(tree, k_longest_adapter, "adapter length", [](const std::string& path) {
    return is_cpp(path) && is_below(path, "adapters") && !is_below(path, "adapters/seam");
  });
}

std::vector<Finding> check_type_names(const Tree& tree) {
  std::map<std::string, std::string> owner;
  std::vector<Finding> findings;
  for (const auto& [path, content] : tree.files) {
    if (!is_cpp(path)) continue;
    for (const std::string& type : types_of(content)) {
      const auto [known, first] = owner.emplace(type, path);
      if (!first)
        findings.push_back({"type name", path, type + " is in " + known->second + " too"});
    }
  }
  return findings;
}

std::vector<Finding> check_shapes(const Tree& tree) {
  std::string kinds;
  for (const auto& [path, content] : tree.files) {
    if (!is_cpp(path)) continue;
    for (const std::string& list :
         matches(content, R"(using (?:Shape|Geometry|Solid) = std::variant<([^>]*)>;)")) {
      for (const std::string& kind : words(list, ", \n"))
        kinds += (kinds.empty() ? "" : "|") + kind;
    }
  }
  std::vector<Finding> findings;
  if (kinds.empty()) return findings;
  const std::string guess =
      "\\b((?:get_if|holds_alternative) ?< ?(?:const )?(?:\\w+::)*(?:" + kinds + ")\\b)";
  for (const auto& [path, content] : tree.files) {
    if (!is_cpp(path) || is_below(path, "tests/architecture")) continue;
    for (const std::string& found : matches(without_comments(content), guess)) {
      findings.push_back({"shape", path, found + ">: visit the shape, with a case for each kind"});
    }
  }
  return findings;
}

std::vector<Finding> check_stepping(const Tree& tree) {
  std::vector<Finding> findings;
  for (const auto& [path, content] : tree.files) {
    const bool looks = is_below(path, "experiments") || is_below(path, "cli");
    // The rules of the seam itself are asked without anything in between.
    const bool may =
        is_below(path, "experiments/step") || is_below(path, "experiments/conformance");
    if (!is_cpp(path) || !looks || may) continue;
    for (const std::string& call : matches(without_comments(content), R"(((?:->|\.)step\(\)))")) {
      findings.push_back({"stepping", path, call + ": leave it to experiments/step"});
    }
  }
  return findings;
}

std::vector<Finding> check_documents(const Tree& tree) {
  const auto produced = [](const std::string& named) {
    return named.starts_with("build/") || named.starts_with("results/");
  };
  std::vector<Finding> findings;
  for (const auto& [path, content] : tree.files) {
    const bool document =
        extension(path) == ".md" && (path.find('/') == std::string::npos || is_below(path, "docs"));
    if (!document) continue;
    for (std::string named : matches(content, "`([A-Za-z0-9_.][A-Za-z0-9_./-]*)`")) {
      const std::size_t slash = named.find('/');
      if (slash == std::string::npos || produced(named)) continue;
      const bool folder = named.back() == '/';
      if (folder) named.pop_back();
      // `bullet/si` is a variant of an engine, not a path.
      if (!folder && !tree.folders.contains(named.substr(0, slash))) continue;
      if (tree.folders.contains(named) || tree.files.contains(named)) continue;
      if (!folder && extension(named).empty() && named.starts_with("ourengine/")) continue;
      findings.push_back({"document", path, "names " + named + ", which does not exist"});
    }
  }
  return findings;
}

}  // namespace brickbench::architecture
