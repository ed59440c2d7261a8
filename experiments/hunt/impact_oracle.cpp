// Carnot's theorem for every step: docs/hunt.md, section impact.
#include <algorithm>
#include <cmath>

#include "experiments/exact/schemes/scheme_map.hpp"
#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/metrics/deepest_overlap.hpp"
#include "experiments/oracle/contact_candidates.hpp"

namespace brickbench::hunt {
namespace {

// Of the energy of the velocities that the step's impulses gave: a restitution that is off by as
// much is told, less is the error of a solver that was stopped. Of a single pair, and of many.
constexpr double k_pair_share = 0.03;
constexpr double k_crowd_share = 0.1;
// Cosine of normals that count as one.
constexpr double k_same_normal = 1.0 - 1e-9;

// The plane in which all contacts of a pair lie.
struct Face {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

// What contact gave one body in a step.
struct Push {
  std::size_t body = 0;
  Eigen::Vector3d impulse_ns = Eigen::Vector3d::Zero();
  Eigen::Vector3d twist_nms = Eigen::Vector3d::Zero();  // about the centre
  Eigen::Vector3d turned_radps = Eigen::Vector3d::Zero();
};

struct Sum {
  double gift_j = 0.0;     // p.v+ and e times the normal part of p.v-: never positive
  double change_j = 0.0;   // p.M^-1 p / 2
  double size_ns = 0.0;    // sum of |p|
  double slip_mps = 0.0;   // fastest point of any body before
  double turn_mps2 = 0.0;  // largest w^2 r: how fast a point of contact turns away
};

// p = M (v+ - v_free), with the free step that the engine states.
Push push_of(const World& world, const gate::StepRecord& record, const Scheme& scheme,
             std::size_t i) {
  const Body& body = world.bodies[i];
  const State& after = record.after[i];
  const State free = exact::next_free_state(scheme, body, record.before[i], record.wrenches[i],
                                            world.gravity_mps2, record.step_s);
  const Eigen::Quaterniond turn = after.orientation.normalized();
  Push push;
  push.body = i;
  push.impulse_ns = body.mass_kg * (after.velocity_mps - free.velocity_mps);
  push.turned_radps = after.angular_velocity_radps - free.angular_velocity_radps;
  push.twist_nms = turn * body.inertia_kgm2.cwiseProduct(turn.conjugate() * push.turned_radps);
  return push;
}

double work_j(const Push& push, const State& at) {
  return push.impulse_ns.dot(at.velocity_mps) + push.twist_nms.dot(at.angular_velocity_radps);
}

// The part of work_j() that forces along the normal do. Tangential forces in a plane at the height
// `arm` over the centre have the moment arm x force; what remains of the moment in the plane is of
// the normal forces.
double normal_work_j(const Push& push, const State& at, const Face& face) {
  const Eigen::Vector3d& n = face.normal;
  const Eigen::Vector3d along_ns = n * n.dot(push.impulse_ns);
  const Eigen::Vector3d arm_m = n * n.dot(face.point_m - at.position_m);
  const Eigen::Vector3d twist_nms = push.twist_nms - arm_m.cross(push.impulse_ns - along_ns);
  const Eigen::Vector3d in_plane_nms = twist_nms - n * n.dot(twist_nms);
  return along_ns.dot(at.velocity_mps) + in_plane_nms.dot(at.angular_velocity_radps);
}

// nullopt where the contacts that the poses allow do not lie in one plane.
std::optional<Face> common_face(const World& world, const gate::StepRecord& record) {
  const Body& a = world.bodies[0];
  const Body& b = world.bodies[1];
  const double way_m = record.step_s * (fastest_point_mps(a, record.before[0]) +
                                        fastest_point_mps(b, record.before[1]));
  const double edge_m = std::min(thinnest_m(a.shape), thinnest_m(b.shape));
  std::vector<gate::ContactCandidate> candidates;
  for (const std::span<const State> states : {record.before, record.after}) {
    gate::contact_candidates(a.shape, states[0], b.shape, states[1],
                             {.margin_m = way_m + 0.01 * edge_m, .slack_m = 0.01 * edge_m},
                             candidates);
  }
  if (candidates.empty()) return std::nullopt;
  const Face face{candidates.front().position_m, candidates.front().normal};
  for (const gate::ContactCandidate& candidate : candidates) {
    if (candidate.normal.dot(face.normal) < k_same_normal) return std::nullopt;
  }
  return face;
}

Sum sum_of(const World& world, const gate::StepRecord& record, const Scheme& scheme,
           double restitution, const std::optional<Face>& face) {
  Sum sum;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed) continue;
    const Push push = push_of(world, record, scheme, i);
    const State& before = record.before[i];
    const double bounce_j = face ? normal_work_j(push, before, *face) : work_j(push, before);
    sum.gift_j += work_j(push, record.after[i]) + restitution * bounce_j;
    sum.change_j += 0.5 * (push.impulse_ns.squaredNorm() / body.mass_kg +
                           push.twist_nms.dot(push.turned_radps));
    sum.size_ns += push.impulse_ns.norm() + push.twist_nms.norm() / reach_m(body.shape);
    sum.slip_mps = std::max(sum.slip_mps, fastest_point_mps(body, before));
    const double spin_of_body = std::max(before.angular_velocity_radps.squaredNorm(),
                                         record.after[i].angular_velocity_radps.squaredNorm());
    sum.turn_mps2 = std::max(sum.turn_mps2, spin_of_body * reach_m(body.shape));
  }
  return sum;
}

// Speed, m/s, at which the engine may push an overlap apart.
double push_mps(const Motion& motion, double depth_m) {
  if (!motion.scheme || !motion.scheme->impulse()) return depth_m / motion.step_s;
  const ImpulseContact& contact = *motion.scheme->impulse();
  return std::min(contact.error_reduction * depth_m / motion.step_s, contact.max_correction_mps);
}

// Points that are hit one after the other get Newton's law each in its turn: what is left of it in
// the sum is that no hit adds energy, which is the law at 1, of any number of pairs.
bool hits_one_by_one(const Scheme& scheme) {
  return scheme.sequential() != nullptr && !scheme.sequential()->hits_at_once;
}

}  // namespace

std::optional<Breach> impact_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  if (!motion.scheme) return std::nullopt;
  ContactLaw law = greatest_law(world);
  // With restitution the theorem is proven for contacts that all bounce: one pair.
  const bool one_pair = world.bodies.size() == 2;
  const bool one_by_one = hits_one_by_one(*motion.scheme);
  if (law.restitution > 0.0 && !one_pair && !one_by_one) return std::nullopt;
  if (one_by_one) law.restitution = 1.0;
  const bool both = law.restitution > 0.0 && law.friction > 0.0;
  DeepestOverlap overlap(world);
  const double edge_j = edge_energy_j(world);
  Worst worst;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    const gate::StepRecord record = motion.record(n);
    const auto face = both && one_pair ? common_face(world, record) : std::nullopt;
    const Sum p = sum_of(world, record, *motion.scheme, law.restitution, face);
    const double scale_j = kinetic_j(world, record.before) + edge_j;
    const double depth_m =
        std::max(overlap.find(record.before).depth_m, overlap.find(record.after).depth_m);
    const double slack_mps =
        push_mps(motion, depth_m) + motion.step_s * (2.0 * world.gravity_mps2.norm() + p.turn_mps2);
    // Where the normal is not known, the work of friction before may be counted as bounce.
    const double cone = law.friction / std::hypot(1.0, law.friction);
    const double slip_mps = both && !face ? law.restitution * cone * p.slip_mps : 0.0;
    const double share = one_pair ? k_pair_share : k_crowd_share;
    const double allowed_j =
        share * p.change_j + p.size_ns * (slack_mps + slip_mps) + k_energy_share * scale_j;
    worst.see({"impact", p.gift_j, allowed_j, "J", n + 1, 0.0, ""});
  }
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
