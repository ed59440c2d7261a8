#include "cli/record_command.hpp"

#include <algorithm>

namespace brickbench {
namespace {

// The words of a text that shell_command() made: blanks between them, single quotes around what is
// not plain, \' for a quote.
std::vector<std::string> shell_words(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  bool quoted = false;
  bool any = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\'') {
      quoted = !quoted;
      any = true;
    } else if (c == '\\' && !quoted && i + 1 < text.size()) {
      word += text[++i];
      any = true;
    } else if (c == ' ' && !quoted) {
      if (any) words.push_back(word);
      word.clear();
      any = false;
    } else {
      word += c;
      any = true;
    }
  }
  if (any) words.push_back(word);
  return words;
}

}  // namespace

std::string record_command(const std::vector<std::string>& words) {
  std::vector<std::string> kept = {"brickbench"};
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (words[i] == "--out") {
      ++i;
    } else if (!words[i].starts_with("--out=") && words[i] != "--record") {
      kept.push_back(words[i]);
    }
  }
  kept.emplace_back("--record");
  return shell_command(kept);
}

std::string record_command(const Provenance& provenance) {
  const std::vector<std::string> words = shell_words(provenance.command);
  if (words.size() < 3 || words[1] != "run") return "";
  return record_command(words);
}

}  // namespace brickbench
