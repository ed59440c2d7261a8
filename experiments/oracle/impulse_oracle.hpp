// The impulse oracle: is there any set of admissible contact impulses that explains how two
// recorded states follow on each other? What is left over is momentum that no contact and no
// gravity gave.
#pragma once

#include <span>
#include <vector>

#include "adapters/seam/world.hpp"
#include "experiments/oracle/cone_program.hpp"

namespace brickbench::gate {

struct StepRecord {
  std::span<const State> before;     // (bodies), order of World::bodies
  std::span<const State> after;      // (bodies)
  std::span<const Wrench> wrenches;  // (bodies), held during the step
  double step_s = 0.0;
};

struct Unexplained {
  double upper_ns = 0.0;          // what the best impulses found leave over
  double lower_ns = 0.0;          // proven: no admissible impulses leave less
  double given_ns = 0.0;          // the whole momentum change that contacts had to explain
  std::size_t worst_body = 0;     // with the largest share of what is left over
  std::size_t worst_partner = 0;  // its contact with the largest impulse; itself if it has none
  std::size_t contacts = 0;
};

// Where contacts are looked for, beyond what the pair's motion covers in one step; both as shares
// of the smaller body's smallest edge.
struct ContactRoom {
  double gap_share = 0.02;
  double border_share = 0.02;  // faces reach that much over their edges; negative: less
  // Contacts whose normal is more than 45 degrees from the vertical; without them, none.
  bool head_joints = true;
  bool with_fixed_only = false;  // contacts of a moving with a fixed body alone
};

// The contacts that the poses allow. Where the pair moves by more than a hundredth of its size in
// the step, the poses after the step give candidates too.
ConeProblem cone_problem(const World& world, const StepRecord& record,
                         const ContactRoom& room = {});

// Angular momentum counts divided by each body's radius of gyration. A body's own rotation
// scheme is part of what is judged: a free body whose scheme loses angular momentum has it
// unexplained.
Unexplained unexplained_momentum(const World& world, const StepRecord& record, double gap_ns);

}  // namespace brickbench::gate
