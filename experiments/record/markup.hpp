// Markup: text from input made safe for XML, HTML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace brickbench {

// & < > " ' as entities; control characters other than line feed and tab become U+FFFD, as XML
// allows no others.
std::string escape_markup(std::string_view text);

}  // namespace brickbench
