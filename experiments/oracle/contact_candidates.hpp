// Where two shapes could press on each other, from their poses alone.
//
// The list is generous on purpose: an oracle that allows a contact too many accuses nobody falsely.
// Every separating axis whose gap is within `slack` of the largest one gives a normal, and for each
// normal the whole overlap of the two touching faces is covered by its corners.
#pragma once

#include <vector>

#include "adapters/seam/world.hpp"

namespace brickbench::gate {

struct ContactCandidate {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from a towards b
  double gap_m = 0.0;                                 // negative: overlap
};

struct CandidateRange {
  double margin_m = 0.0;  // shapes further apart than this do not touch
  double slack_m = 0.0;   // axes within this of the deepest are kept too
  double border_m =
      0.0;  // touching faces of boxes count this much larger on every side; may be negative
};

// Appends the candidates of the pair. Boxes, spheres, planes (a plane only with a body that can
// move).
void contact_candidates(const Shape& a, const State& at_a, const Shape& b, const State& at_b,
                        const CandidateRange& range, std::vector<ContactCandidate>& out);

}  // namespace brickbench::gate
