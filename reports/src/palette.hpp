// Palette: one colour, dash and marker per engine, the same in views, plots and tables.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace brickbench {

// Colours after Okabe and Ito, "Color Universal Design" (2008), without yellow and black, which
// vanish on one of the two backgrounds; the rest after Tol, "Colour Schemes" (SRON/EPS/TN/09-002).
// "#0072b2"; repeats after the tenth.
std::string palette_colour(std::size_t index);

// SVG stroke-dasharray, "" for a solid line. Tells engines apart where colours do not.
std::string palette_dash(std::size_t index);

// Colours by label: the place of the label in order of first appearance.
class Palette {
 public:
  std::size_t index(const std::string& label);
  const std::vector<std::string>& labels() const { return labels_; }

 private:
  std::vector<std::string> labels_;
};

}  // namespace brickbench
