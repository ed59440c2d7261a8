// The discrete map of contacts that are hit one after the other and then rest on forces: the two
// stages of Baraff's notes, in the order in which the scheme lists its contacts.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// A point where two bodies touch, as the scheme lists it.
struct TouchingPoint {
  std::size_t body_a = 0;
  std::size_t body_b = 0;  // the body of the corner, where there is one
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from a towards b
  double gap_m = 0.0;
  double curvature_per_m = 0.0;  // 1/distance of the centres of two balls, else 0: flat
  bool corner = false;           // the normal turns with a; else both bodies are met centrally
  bool plain = true;  // false: once the pair tilts, crossing edges touch that are not listed
};

// The points with a gap of at most margin_m. Pairs in the order of the bodies; a box on a plane:
// all corners, x fastest, negative first; on a face of another box: the four corners of its most
// opposed face, counterclockwise in the plane of the next two axes, from (+, +); closer to the
// border of the other face than border_share of the thinnest half extent is on it. Source:
// ourengine/baraff/collision.hpp.
std::vector<TouchingPoint> touching_points(const ExactRun& run, std::span<const State> states,
                                           double margin_m, double border_share);

// Advances all states (bodies) by one step; false, with a reason, where the scheme leaves it open.
// Source: D. Baraff, Rigid Body Simulation II, sections 7 to 9 and appendix D.
bool advance_sequential(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
                        std::span<State> states, std::string& why);

}  // namespace brickbench::exact
