// PageAssets: what a page embeds; generated when the project is built.
#pragma once

#include <string>

namespace brickbench {

struct PageAssets {
  std::string style;     // CSS
  std::string script;    // one bundled script; empty where the build had no Node
  std::string licences;  // of what the script bundles, as text
  std::string missing;   // why there is no script; empty if there is one
};

PageAssets page_assets();

}  // namespace brickbench
