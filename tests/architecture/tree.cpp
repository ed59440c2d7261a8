#include "tests/architecture/tree.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

namespace brickbench::architecture {

namespace fs = std::filesystem;

Tree read_tree(const fs::path& root) {
  const std::set<std::string> produced = {"build", "results", "node_modules"};
  Tree tree;
  for (auto entry = fs::recursive_directory_iterator(root);
       entry != fs::recursive_directory_iterator(); ++entry) {
    const std::string name = entry->path().filename().string();
    if (entry->is_directory() && entry.depth() == 0 && name != ".github" && name != ".ci" &&
        (name.front() == '.' || produced.contains(name))) {
      entry.disable_recursion_pending();
      continue;
    }
    if (!entry->is_regular_file()) continue;
    std::ifstream stream(entry->path(), std::ios::binary);
    std::ostringstream content;
    content << stream.rdbuf();
    add_file(tree, fs::relative(entry->path(), root).generic_string(), content.str());
  }
  return tree;
}

void add_file(Tree& tree, const std::string& path, std::string content) {
  for (auto slash = path.find('/'); slash != std::string::npos; slash = path.find('/', slash + 1)) {
    tree.folders.insert(path.substr(0, slash));
  }
  tree.files[path] = std::move(content);
}

std::string extension(const std::string& path) { return fs::path(path).extension().string(); }

std::string file_stem(const std::string& path) { return fs::path(path).stem().string(); }

bool is_below(const std::string& path, const std::string& folder) {
  return path.starts_with(folder + "/");
}

std::vector<std::string> words(const std::string& text, const std::string& separators) {
  std::vector<std::string> found;
  std::size_t start = 0;
  while ((start = text.find_first_not_of(separators, start)) != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(separators, start), text.size());
    found.push_back(text.substr(start, end - start));
    start = end;
  }
  return found;
}

std::string without_comments(const std::string& cpp) {
  std::istringstream lines(cpp);
  std::string line;
  std::string code;
  while (std::getline(lines, line)) code += line.substr(0, line.find("//")) + "\n";
  return code;
}

}  // namespace brickbench::architecture
