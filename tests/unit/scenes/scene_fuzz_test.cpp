// Damaged scene files: whatever is in them, the reader answers, and says where.
//
// BRICKBENCH_FUZZ_INPUTS in the environment sets how many are read; the default is what a test run
// can afford.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "experiments/record/file.hpp"
#include "experiments/scenes/scene_file.hpp"

namespace brickbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t k_inputs = 20000;

std::size_t inputs() {
  const char* text = std::getenv("BRICKBENCH_FUZZ_INPUTS");
  return text == nullptr ? k_inputs : static_cast<std::size_t>(std::strtoull(text, nullptr, 10));
}

std::vector<std::string> shipped_texts() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator("experiments/scenes")) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<std::string> texts;
  for (const fs::path& file : files) texts.push_back(read_file(file).value());
  return texts;
}

// Pieces that matter to the reader.
const std::vector<std::string> k_pieces = {"[",
                                           "]",
                                           "{",
                                           "}",
                                           "\"",
                                           "'",
                                           "=",
                                           "\n",
                                           ",",
                                           ".",
                                           "-",
                                           "#",
                                           "nan",
                                           "inf",
                                           "1e308",
                                           "-1",
                                           "0",
                                           "true",
                                           "[[body]]",
                                           "[law]",
                                           "repeat = { i = 3 }",
                                           "grid",
                                           "stack",
                                           "ring",
                                           "when = 0",
                                           "(",
                                           ")",
                                           "*",
                                           "/",
                                           "^",
                                           "sin(",
                                           "pi",
                                           "1e-320",
                                           "99999",
                                           "\\u0000",
                                           "\xff",
                                           "{k}",
                                           "{{",
                                           "?",
                                           ":",
                                           "plane",
                                           "sphere",
                                           "fixed = true",
                                           "overlaps = \"allowed\"",
                                           "\"\"\"",
                                           "9007199254740993"};

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string damaged(const std::vector<std::string>& texts) {
    std::string text = texts[below(texts.size())];
    for (std::size_t times = 1 + below(4); times > 0; --times) damage(text, texts);
    return text;
  }

 private:
  std::size_t below(std::size_t count) { return count == 0 ? 0 : random_() % count; }

  void damage(std::string& text, const std::vector<std::string>& texts) {
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(text.size() - at, 1 + below(40));
    switch (below(7)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(below(256));
        return;
      case 1:
        text.erase(at, length);
        return;
      case 2:
        text.insert(at, text.substr(below(text.size()), 1 + below(60)));
        return;
      case 3:
        text.insert(at, k_pieces[below(k_pieces.size())]);
        return;
      case 4:
        text.replace(at, length, k_pieces[below(k_pieces.size())]);
        return;
      case 5: {
        const std::string& other = texts[below(texts.size())];
        text.insert(at, other.substr(below(other.size()), 1 + below(200)));
        return;
      }
      default:
        move_line(text);
    }
  }

  // Takes a line out and puts it in elsewhere, so that much stays right.
  void move_line(std::string& text) {
    const std::size_t begin = text.rfind('\n', below(text.size()));
    if (begin == std::string::npos) return;
    const std::size_t end = text.find('\n', begin + 1);
    const std::string line = text.substr(begin, end - begin);
    text.erase(begin, line.size());
    const std::size_t to = text.find('\n', below(text.size()));
    if (to != std::string::npos) text.insert(to, line);
  }

  std::mt19937_64 random_;
};

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n')) + 2;
}

TEST(SceneFuzz, EveryDamagedFileIsReadOrAnsweredWithAPlace) {
  const auto texts = shipped_texts();
  ASSERT_GE(texts.size(), 10u);
  std::size_t read = 0;
  for (std::size_t i = 0; i < inputs(); ++i) {
    const std::string text = Mutator(i).damaged(texts);
    const auto scenario = parse_scene(text, "fuzz.toml");
    if (scenario) {
      ++read;
      continue;
    }
    const InputError& error = scenario.error();
    ASSERT_FALSE(error.reason.empty()) << "input " << i << "\n" << text;
    ASSERT_EQ(error.at.file, "fuzz.toml") << "input " << i << "\n" << text;
    ASSERT_LE(error.at.line, lines_of(text)) << "input " << i << "\n" << text;
  }
  // Neither all damage is seen as such, nor is none: the reader gets far into many of them.
  EXPECT_GT(read, inputs() / 50);
  EXPECT_LT(read, inputs() * 9 / 10);
}

}  // namespace
}  // namespace brickbench
