// Markup: text from input made safe for HTML and SVG, and data for scripts.
#pragma once

#include "experiments/record/markup.hpp"

namespace brickbench {

// JSON for a <script> element: '<', '>' and '&' as \u003c, \u003e, \u0026, so that no text can end
// the element.
std::string script_json(const std::string& json);

}  // namespace brickbench
