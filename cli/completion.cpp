#include "cli/completion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

// The verbs right below `above` ("" for the program), by their last word.
std::vector<std::string> words_below(const Json& verbs, const std::string& above) {
  std::vector<std::string> words;
  const std::string prefix = above.empty() ? "" : above + ' ';
  for (const Json& verb : verbs) {
    const std::string id = verb["id"];
    if (!id.starts_with(prefix) || id.find(' ', prefix.size()) != std::string::npos) continue;
    if (id.size() > prefix.size()) words.push_back(id.substr(prefix.size()));
  }
  return words;
}

// "TEXT:{front,side}" -> "front side"; empty where any word may stand.
std::string choices(const Json& option) {
  std::string value = option["value"];
  const auto open = value.find('{');
  const auto close = value.find('}');
  if (open == std::string::npos || close == std::string::npos) return "";
  value = value.substr(open + 1, close - open - 1);
  std::ranges::replace(value, ',', ' ');
  return value;
}

bool is_placed(const Json& option) { return !option["id"].get<std::string>().starts_with("--"); }

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

// In single quotes for a shell; colons are zsh's separators.
std::string quoted(const std::string& text, bool for_zsh) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else if (for_zsh && c == ':') {
      out += "\\:";
    } else {
      out += c;
    }
  }
  return out + "'";
}

// Shell code, the same in both shells: `verb` becomes the verb that `words_so_far` name.
std::string verb_loop(const Json& verbs) {
  std::string known;
  for (const Json& verb : verbs) {
    known += (known.empty() ? "" : "|") + quoted(verb["id"].get<std::string>(), false);
  }
  return fmt::format(
      "  for word in \"${{words_so_far[@]}}\"; do\n"
      "    case \"${{verb:+$verb }}$word\" in\n"
      "      {}) verb=\"${{verb:+$verb }}$word\" ;;\n"
      "    esac\n"
      "  done\n",
      known);
}

// Words that may stand without a dash: verbs below this one, or the choices of what is placed.
std::string free_words(const Json& verbs, const Json& verb) {
  std::string words = joined(words_below(verbs, verb["id"]));
  for (const Json& option : verb["options"]) {
    if (!is_placed(option)) continue;
    if (const std::string some = choices(option); !some.empty()) {
      words += (words.empty() ? "" : " ") + some;
    }
    if (option["id"] == "plan") words += " $(_brickbench_plans)";
  }
  return words;
}

std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  if (out.starts_with('.') || out.starts_with('\'')) out = "\\&" + out;
  return out;
}

constexpr std::string_view k_plans =
    "_brickbench_plans() { brickbench list plans 2>/dev/null | sed -n "
    "'s/^\\([a-z0-9_]*\\):.*/\\1/p'; "
    "}\n";

}  // namespace

std::string bash_completion(const Json& verbs) {
  std::string out = "# Completion of brickbench for bash: eval \"$(brickbench completion bash)\"\n";
  out += k_plans;
  out +=
      "_brickbench() {\n"
      "  local word verb= words= current=${COMP_WORDS[COMP_CWORD]}\n"
      "  local before=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local -a words_so_far=(\"${COMP_WORDS[@]:1:COMP_CWORD-1}\")\n";
  out += verb_loop(verbs);
  out += "  case \"$verb $before\" in\n";
  for (const Json& verb : verbs) {
    for (const Json& option : verb["options"]) {
      const std::string some = choices(option);
      if (is_placed(option) || some.empty()) continue;
      out += fmt::format("    {}) words={} ;;\n",
                         quoted(fmt::format("{} {}", verb["id"].get<std::string>(),
                                            option["id"].get<std::string>()),
                                false),
                         quoted(some, false));
    }
  }
  out += "  esac\n  [ -n \"$words\" ] || case \"$verb\" in\n";
  out += fmt::format("    '') words='{} --help' ;;\n", joined(words_below(verbs, "")));
  for (const Json& verb : verbs) {
    std::string options = "--help";
    for (const Json& option : verb["options"]) {
      if (!is_placed(option)) options += ' ' + option["id"].get<std::string>();
    }
    const std::string free = free_words(verbs, verb);
    out +=
        fmt::format("    {}) words=\"{}{}{}\" ;;\n", quoted(verb["id"].get<std::string>(), false),
                    free, free.empty() ? "" : " ", options);
  }
  return out +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
         "}\n"
         "complete -o default -F _brickbench brickbench\n";
}

std::string zsh_completion(const Json& verbs) {
  std::string out =
      "#compdef brickbench\n"
      "# Completion of brickbench for zsh: eval \"$(brickbench completion zsh)\" after compinit.\n";
  out += k_plans;
  out +=
      "_brickbench() {\n"
      "  local word verb=\n"
      "  local -a words_so_far=(\"${(@)words[2,CURRENT-1]}\") options free\n";
  out += verb_loop(verbs);
  out += "  case \"$verb\" in\n    '') options=(";
  for (const Json& verb : verbs) {
    const std::string id = verb["id"];
    if (id.find(' ') != std::string::npos) continue;
    out += "\n      " + quoted(id, true);
    out.pop_back();
    out += ":" + quoted(verb["meaning"].get<std::string>(), true).substr(1);
  }
  out += ") ;;\n";
  for (const Json& verb : verbs) {
    out += fmt::format("    {}) options=(", quoted(verb["id"].get<std::string>(), false));
    for (const Json& option : verb["options"]) {
      if (is_placed(option)) continue;
      out += "\n      " + quoted(option["id"].get<std::string>(), true);
      out.pop_back();
      out += ":" + quoted(option["meaning"].get<std::string>(), true).substr(1);
    }
    out += fmt::format(")\n      free=({}) ;;\n", free_words(verbs, verb));
  }
  return out +
         "  esac\n"
         "  _describe 'brickbench' options\n"
         "  [ ${#free} -eq 0 ] || compadd -a free\n"
         "  _files\n"
         "}\n"
         "compdef _brickbench brickbench\n";
}

std::string man_page(const Json& verbs, const std::string& version) {
  std::string out = fmt::format(
      ".TH BRICKBENCH 1 \"\" \"brickbench {}\" \"User Commands\"\n"
      ".SH NAME\nbrickbench \\- run the same rigid\\-body scenes through several engines and say "
      "which is right\n"
      ".SH SYNOPSIS\n.B brickbench\n.I VERB\n.RI [ options ]\n.SH VERBS\n",
      roff(version));
  for (const Json& verb : verbs) {
    out += fmt::format(".SS brickbench {}\n{}.\n", roff(verb["id"].get<std::string>()),
                       roff(verb["meaning"].get<std::string>()));
    for (const Json& option : verb["options"]) {
      const std::string value = option["value"];
      out += fmt::format(".TP\n\\fB{}\\fR{}\n{}.\n", roff(option["id"].get<std::string>()),
                         value.empty() ? "" : " \\fI" + roff(value) + "\\fR",
                         roff(option["meaning"].get<std::string>()));
    }
  }
  return out +
         ".SH EXIT STATUS\n"
         ".TP\n0\nFine.\n"
         ".TP\n1\nA deviation, or a case or cell that failed.\n"
         ".TP\n2\nBad usage or input; nothing was run or written.\n"
         ".TP\n3\nIncomplete, or nothing to compare.\n"
         ".TP\n4\nInfrastructure: a disk or a tool refused.\n";
}

}  // namespace brickbench
