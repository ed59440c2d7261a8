// The source tree as data, so that the rules can be tried on trees that break them.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace brickbench::architecture {

struct Tree {
  std::map<std::string, std::string> files;  // path from the root, with /, -> content
  std::set<std::string> folders;             // every folder that holds one of them, at any depth
};

// The project's own files: everything below `root` but hidden folders, build/ and results/.
Tree read_tree(const std::filesystem::path& root);
// Adds the file and the folders above it.
void add_file(Tree& tree, const std::string& path, std::string content);

std::string extension(const std::string& path);  // ".cpp", "" without one
std::string file_stem(const std::string& path);  // "wall" of "a/wall.cpp"
bool is_below(const std::string& path, const std::string& folder);
// Split at any of the given characters; no empty words.
std::vector<std::string> words(const std::string& text, const std::string& separators);
// Without // comments; good enough for sources that have no // inside strings on code lines.
std::string without_comments(const std::string& cpp);

}  // namespace brickbench::architecture
