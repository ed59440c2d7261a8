// Markup: text from input made safe for HTML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace brickbench {

// & < > " ' as entities; control characters other than line feed and tab become U+FFFD, as XML
// allows no others.
std::string escape_markup(std::string_view text);

// JSON for a <script> element: '<', '>' and '&' as \u003c, \u003e, \u0026, so that no text can end
// the element.
std::string script_json(const std::string& json);

}  // namespace brickbench
