#include "experiments/exact/schemes/impulse_map.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/exact/schemes/box_points.hpp"
#include "experiments/exact/schemes/fall_map.hpp"
#include "experiments/exact/schemes/pivoting.hpp"
#include "experiments/exact/schemes/scheme_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Velocity of the material point of a body, and how an impulse there changes it.
struct Arm {
  double inverse_mass = 0.0;
  Matrix3d inverse_inertia = Matrix3d::Zero();
  Vector3d lever = Vector3d::Zero();
};

Arm arm_of(const World& world, std::size_t i, const State& state, const PointContact& contact) {
  const Body& body = world.bodies[i];
  Arm arm;
  if (body.fixed) return arm;
  arm.inverse_mass = 1.0 / body.mass_kg;
  if (contact.central) return arm;
  const Matrix3d r = state.orientation.toRotationMatrix();
  arm.inverse_inertia = r * body.inertia_kgm2.cwiseInverse().asDiagonal() * r.transpose();
  arm.lever = contact.position_m - state.position_m;
  return arm;
}

double inverse_mass_along(const Arm& arm, const Vector3d& direction) {
  const Vector3d turn = arm.lever.cross(direction);
  return arm.inverse_mass + turn.dot(arm.inverse_inertia * turn);
}

Vector3d point_velocity(const Arm& arm, const State& state) {
  if (arm.inverse_mass == 0.0) return Vector3d::Zero();
  return state.velocity_mps + state.angular_velocity_radps.cross(arm.lever);
}

void push(const Arm& arm, const Vector3d& impulse, State& state) {
  state.velocity_mps += arm.inverse_mass * impulse;
  state.angular_velocity_radps += arm.inverse_inertia * arm.lever.cross(impulse);
}

// The friction impulse (N s) on b against the slip; the tangential response is isotropic with
// inverse mass k, and does not couple to the normal.
Vector3d friction_impulse(FrictionSet set, const Vector3d& slip_mps, double k, double limit_ns,
                          const Vector3d& normal) {
  const Vector3d stick = -slip_mps / k;
  if (set == FrictionSet::circle) {
    return stick.norm() <= limit_ns ? stick : Vector3d(stick * (limit_ns / stick.norm()));
  }
  // Fixed tangents: the world axes for a normal along z.
  const Vector3d t1 = std::abs(normal.x()) < 0.9
                          ? Vector3d(Vector3d::UnitX() - normal.x() * normal)
                          : Vector3d(Vector3d::UnitY() - normal.y() * normal);
  const Vector3d u = t1.normalized();
  const Vector3d v = normal.cross(u);
  return u * std::clamp(stick.dot(u), -limit_ns, limit_ns) +
         v * std::clamp(stick.dot(v), -limit_ns, limit_ns);
}

// A contact that acts in this step, with the velocity that it asks for.
struct Row {
  const PointContact* contact = nullptr;
  Arm a, b;
  double target_mps = 0.0;
  bool holds = false;         // with a fixed body, and no bounce
  double inverse_mass = 0.0;  // along the normal, with the softness of the contact
  double impulse_ns = 0.0;
};

Vector3d slip_velocity(const Row& row, std::span<const State> states) {
  return point_velocity(row.b, states[row.contact->body_b]) -
         point_velocity(row.a, states[row.contact->body_a]);
}

void push_pair(const Row& row, const Vector3d& impulse, std::span<State> states) {
  push(row.a, -impulse, states[row.contact->body_a]);
  push(row.b, impulse, states[row.contact->body_b]);
}

// The gap up to which a contact has a row.
double margin_m(const ImpulseContact& law, const World& world, const PointContact& contact) {
  if (std::isinf(law.plane_reach_share)) return law.margin_m;
  const Shape& a = world.bodies[contact.body_a].shape;
  const Shape& b = world.bodies[contact.body_b].shape;
  if (!is_half_space(a) && !is_half_space(b)) return std::min(law.margin_m, 0.0);
  const Shape& body = is_half_space(a) ? b : a;
  return std::min(law.margin_m, law.plane_reach_share * half_extents_m(body).norm());
}

std::vector<Row> active_rows(const Scheme& scheme, const ExactRun& run,
                             std::span<const Wrench> wrenches, const FreeFall& fall,
                             const std::vector<PointContact>& contacts,
                             std::span<const State> before) {
  ImpulseContact law_of_step = *scheme.impulse();
  law_of_step.restitution_threshold_mps = std::max(
      law_of_step.restitution_threshold_mps,
      law_of_step.restitution_threshold_steps * run.step_s * run.world.gravity_mps2.norm());
  std::vector<Row> rows;
  for (const PointContact& contact : contacts) {
    if (contact.gap_m > margin_m(*scheme.impulse(), run.world, contact)) continue;
    Row row;
    row.contact = &contact;
    row.a = arm_of(run.world, contact.body_a, before[contact.body_a], contact);
    row.b = arm_of(run.world, contact.body_b, before[contact.body_b], contact);
    const ContactLaw law = contact_law(run.world, contact.body_a, contact.body_b);
    row.target_mps =
        target_velocity_mps(law_of_step, law.restitution, contact.gap_m,
                            contact.normal.dot(slip_velocity(row, before)), run.step_s);
    if (fall.falls) {
      const FallingTarget target =
          falling_target(law_of_step, run, free_gap(run.world, wrenches, contact, before),
                         run.step_s - fall.flight_s);
      row.target_mps = target.velocity_mps;
      row.holds = target.holds;
    }
    row.inverse_mass = inverse_mass_along(row.a, contact.normal) +
                       inverse_mass_along(row.b, contact.normal) +
                       scheme.impulse()->softness_per_kgs / (run.step_s * contact.points);
    rows.push_back(row);
  }
  return rows;
}

// The complementarity problem of all normal impulses at once: each impulse pushes or its contact
// separates faster than asked. Projected Gauss-Seidel to rounding; one row needs one pass.
void solve_normals(const Scheme& scheme, double h, std::vector<Row>& rows,
                   std::span<State> states) {
  constexpr int k_most_passes = 100000;
  for (int pass = 0; pass < k_most_passes; ++pass) {
    double change = 0.0;
    for (Row& row : rows) {
      const Vector3d& n = row.contact->normal;
      const double softness = scheme.impulse()->softness_per_kgs / (h * row.contact->points);
      const double lacking =
          row.target_mps - n.dot(slip_velocity(row, states)) - softness * row.impulse_ns;
      const double next = std::max(0.0, row.impulse_ns + lacking / row.inverse_mass);
      push_pair(row, (next - row.impulse_ns) * n, states);
      change = std::max(change, std::abs(next - row.impulse_ns) * row.inverse_mass);
      row.impulse_ns = next;
    }
    if (rows.size() < 2 || change < 1e-17) return;
  }
}

// The same rows by pivoting in the order of their island.
void pivot_normals(const Scheme& scheme, const World& world, double h,
                   const std::vector<PointContact>& contacts, std::vector<Row>& rows,
                   std::span<State> states) {
  std::vector<Row*> ordered;
  for (const std::size_t c : island_order(world, contacts)) {
    for (Row& row : rows) {
      if (row.contact == &contacts[c]) ordered.push_back(&row);
    }
  }
  const auto n = static_cast<Eigen::Index>(ordered.size());
  Eigen::MatrixXd response(n, n);
  Eigen::VectorXd lacking(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Row& pushed = *ordered[static_cast<std::size_t>(j)];
    lacking[j] = pushed.target_mps - pushed.contact->normal.dot(slip_velocity(pushed, states));
    std::vector<State> unit(states.begin(), states.end());
    for (State& s : unit) s.velocity_mps = s.angular_velocity_radps = Vector3d::Zero();
    push_pair(pushed, pushed.contact->normal, unit);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Row& felt = *ordered[static_cast<std::size_t>(i)];
      response(i, j) = felt.contact->normal.dot(slip_velocity(felt, unit));
    }
    response(j, j) += scheme.impulse()->softness_per_kgs / (h * pushed.contact->points);
  }
  const Eigen::VectorXd impulses = pivot_in_order(response, lacking);
  for (Eigen::Index j = 0; j < n; ++j) {
    Row& row = *ordered[static_cast<std::size_t>(j)];
    row.impulse_ns = impulses[j];
    push_pair(row, impulses[j] * row.contact->normal, states);
  }
}

void solve_friction(const Scheme& scheme, const ContactLaw& law, double h, const Row& row,
                    std::span<State> states) {
  const Vector3d& n = row.contact->normal;
  const Vector3d velocity = slip_velocity(row, states);
  const Vector3d slip = velocity - n.dot(velocity) * n;
  const Vector3d along = n.unitOrthogonal();
  const double response = inverse_mass_along(row.a, along) + inverse_mass_along(row.b, along) +
                          scheme.impulse()->softness_per_kgs / (h * row.contact->points);
  push_pair(row,
            friction_impulse(scheme.friction, slip, response, law.friction * row.impulse_ns, n),
            states);
}

// Corrections that move positions alone share the depth like the impulse does.
void shift_split(const Scheme& scheme, const World& world, const Row& row,
                 std::span<State> states) {
  const PointContact& contact = *row.contact;
  if (contact.gap_m >= 0.0 || contact.gap_m > scheme.impulse()->split_at_gap_m) return;
  const double share = scheme.impulse()->error_reduction * -contact.gap_m / row.inverse_mass;
  const auto move = [&](std::size_t i, double sign) {
    if (world.bodies[i].fixed) return;
    states[i].position_m += sign * share / world.bodies[i].mass_kg * contact.normal;
    const Arm& arm = i == contact.body_a ? row.a : row.b;
    const Vector3d turn_rad = arm.inverse_inertia * arm.lever.cross(sign * share * contact.normal);
    states[i].orientation =
        (rotation_of(scheme.impulse()->split_turn_share * turn_rad) * states[i].orientation)
            .normalized();
  };
  move(contact.body_a, -1.0);
  move(contact.body_b, 1.0);
}

bool is_edge_on_plane(const World& world, const PointContact& contact) {
  return contact.points > 1 && is_half_space(world.bodies[contact.body_a].shape) &&
         box_of(world.bodies[contact.body_b].shape) != nullptr;
}

// A corner of a box that a plane keeps in mind.
struct SeenCorner {
  std::size_t plane = 0, box = 0;
  Vector3d corner_m = Vector3d::Zero();    // box frame
  Vector3d on_plane_m = Vector3d::Zero();  // below it, when it was seen last
};

// One step of what the plane of `contact` sees and forgets; false if it sees too many.
bool look_from_plane(const ImpulseContact& law, const World& world, const PointContact& contact,
                     std::span<const State> states, std::vector<SeenCorner>& seen) {
  const State& plane = states[contact.body_a];
  const State& box = states[contact.body_b];
  const double reach_m = margin_m(law, world, contact);
  const auto same = [&](const SeenCorner& s) {
    return s.plane == contact.body_a && s.box == contact.body_b;
  };
  const auto gap_m = [&](const SeenCorner& s) {
    return contact.normal.dot(box.position_m + box.orientation * s.corner_m - plane.position_m);
  };
  const auto below_m = [&](const SeenCorner& s) -> Vector3d {
    return box.position_m + box.orientation * s.corner_m - gap_m(s) * contact.normal;
  };
  SeenCorner now{.plane = contact.body_a, .box = contact.body_b};
  const Vector3d down = box.orientation.conjugate() * -contact.normal;
  const Vector3d& half_m = std::get<BoxShape>(world.bodies[contact.body_b].shape).half_extents_m;
  for (Eigen::Index k = 0; k < 3; ++k) now.corner_m[k] = down[k] >= 0.0 ? half_m[k] : -half_m[k];
  now.on_plane_m = below_m(now);
  if (gap_m(now) < reach_m) {
    const auto old = std::ranges::find_if(seen, [&](const SeenCorner& s) {
      return same(s) && (s.corner_m - now.corner_m).norm() < reach_m;
    });
    if (old != seen.end()) {
      *old = now;
    } else {
      seen.push_back(now);
    }
  }
  std::erase_if(seen, [&](const SeenCorner& s) {
    return same(s) && (gap_m(s) > reach_m || (below_m(s) - s.on_plane_m).norm() > reach_m);
  });
  return static_cast<std::size_t>(std::ranges::count_if(seen, same)) <= law.most_corners;
}

struct Advance {
  bool done = false;
  bool held = false;  // a fixed body pushed falling bodies without a bounce
};

// One step of contacts from where the free flight ends.
Advance advance_from(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
                     const FreeFall& fall, const std::vector<PointContact>& contacts,
                     std::span<State> states, std::string& why) {
  const double h = run.step_s - fall.flight_s;
  const std::vector<State> before(states.begin(), states.end());
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = run.world.bodies[i];
    if (body.fixed) continue;
    const State free =
        next_free_state(scheme, body, before[i], wrenches[i], run.world.gravity_mps2, h);
    states[i].velocity_mps = free.velocity_mps;
    if (scheme.gyroscopic == GyroscopicRule::spatial_momentum) {
      push_momentum(body.inertia_kgm2, h * wrenches[i].torque_nm, states[i]);
    } else {
      states[i].angular_velocity_radps = free.angular_velocity_radps;
    }
  }
  const auto unseen = [&](const PointContact& contact) {
    return std::isfinite(scheme.impulse()->plane_reach_share) &&
           is_edge_on_plane(run.world, contact);
  };
  if (std::ranges::any_of(contacts, unseen)) {
    why = "a plane finds the corners of a box one per step";
    return {};
  }
  std::vector<Row> rows = active_rows(scheme, run, wrenches, fall, contacts, before);
  const auto has_friction = [&](const Row& row) {
    return contact_law(run.world, row.contact->body_a, row.contact->body_b).friction > 0.0;
  };
  if (rows.size() > 1 && std::ranges::any_of(rows, has_friction)) {
    why = "several contacts with friction act in one step";
    return {};
  }
  if (scheme.impulse()->gives_up_at_zero_pivot) {
    pivot_normals(scheme, run.world, h, contacts, rows, states);
  } else {
    solve_normals(scheme, h, rows, states);
  }
  if (rows.size() == 1 && has_friction(rows[0])) {
    const ContactLaw law = contact_law(run.world, rows[0].contact->body_a, rows[0].contact->body_b);
    solve_friction(scheme, law, h, rows[0], states);
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (run.world.bodies[i].fixed) continue;
    const bool pushed = std::ranges::any_of(rows, [i](const Row& row) {
      return row.impulse_ns > 0.0 && (row.contact->body_a == i || row.contact->body_b == i);
    });
    const bool new_velocity = pushed && scheme.position == PositionRule::mean_unless_pushed;
    advance_position(new_velocity ? PositionRule::new_velocity : scheme.position,
                     before[i].velocity_mps, h, states[i]);
    if (new_velocity && fall.falls) {
      states[i].position_m -= 0.5 * h * h * run.world.gravity_mps2;
    }
    if (scheme.gyroscopic == GyroscopicRule::spatial_momentum) {
      turn_with_momentum(scheme, run.world.bodies[i].inertia_kgm2, before[i].angular_velocity_radps,
                         h, states[i]);
    } else {
      states[i].orientation =
          next_attitude(scheme, before[i].orientation, states[i].angular_velocity_radps, h);
    }
  }
  for (const Row& row : rows) shift_split(scheme, run.world, row, states);
  return {.done = true, .held = std::ranges::any_of(rows, [](const Row& row) {
                          return row.holds && row.impulse_ns > 0.0;
                        })};
}

}  // namespace

ContactGeometry corner_by_corner(const ImpulseContact& law, const ExactRun& run) {
  return [&law, &run, seen = std::vector<SeenCorner>()](
             std::span<const State> states, std::vector<PointContact>& contacts) mutable {
    std::vector<PointContact> all;
    run.geometry(states, all);
    for (const PointContact& contact : all) {
      if (!is_edge_on_plane(run.world, contact) ||
          !look_from_plane(law, run.world, contact, states, seen)) {
        contacts.push_back(contact);
        continue;
      }
      for (const SeenCorner& corner : seen) {
        if (corner.plane != contact.body_a || corner.box != contact.body_b) continue;
        const State& box = states[corner.box];
        PointContact point = contact;
        point.points = 1;
        point.central = false;
        point.position_m = box.position_m + box.orientation * corner.corner_m;
        point.gap_m = contact.normal.dot(point.position_m - states[corner.plane].position_m);
        contacts.push_back(point);
      }
    }
  };
}

bool advance_impulse(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
                     const std::vector<PointContact>& contacts, std::span<State> states,
                     std::string& why) {
  const FreeFall fall = free_fall(*scheme.impulse(), run, wrenches, contacts, states);
  if (!fall.falls) return advance_from(scheme, run, wrenches, fall, contacts, states, why).done;
  const std::vector<State> start(states.begin(), states.end());
  std::vector<PointContact> met = contacts;
  if (fall.flight_s > 0.0) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (run.world.bodies[i].fixed) continue;
      states[i] = next_free_state(scheme, run.world.bodies[i], states[i], wrenches[i],
                                  run.world.gravity_mps2, fall.flight_s);
    }
    met.clear();
    run.geometry(states, met);
  }
  const Advance advance = advance_from(scheme, run, wrenches, fall, met, states, why);
  if (!advance.done || !advance.held) return advance.done;
  std::ranges::copy(start, states.begin());
  return advance_from(scheme, run, wrenches, FreeFall{}, contacts, states, why).done;
}

double target_velocity_mps(const ImpulseContact& contact, double restitution, double gap_m,
                           double velocity_mps, double step_s) {
  if (gap_m > contact.margin_m) return -std::numeric_limits<double>::infinity();
  const double speed = -velocity_mps;
  const double rebound =
      speed > 0.0 && speed >= contact.restitution_threshold_mps ? restitution * speed : 0.0;
  if (gap_m > 0.0 && contact.bounces_before_touch) {
    return rebound > 0.0 && speed * step_s >= gap_m ? std::max(rebound, -gap_m / step_s)
                                                    : -gap_m / step_s;
  }
  if (gap_m > 0.0) return rebound - (contact.approach_allowed ? gap_m / step_s : 0.0);
  const bool split = gap_m <= contact.split_at_gap_m;
  const double correction =
      split ? 0.0 : std::min(contact.error_reduction * -gap_m / step_s, contact.max_correction_mps);
  return contact.sum_of_targets ? rebound + correction : std::max(rebound, correction);
}

}  // namespace brickbench::exact
