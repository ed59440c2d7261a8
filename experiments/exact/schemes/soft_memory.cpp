// Which contacts a step of the soft map has, what they inherit from the last one, what they tell.
#include <algorithm>
#include <limits>

#include "adapters/seam/shape.hpp"
#include "experiments/exact/schemes/box_points.hpp"
#include "experiments/exact/schemes/soft_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double k_infinity = std::numeric_limits<double>::infinity();

// The deepest, the one furthest from it, and those that span most area with the two on either side.
std::vector<TouchingPoint> four_of(const std::vector<TouchingPoint>& points) {
  const auto middle_m = [](const TouchingPoint& p) -> Vector3d {
    return p.position_m - 0.5 * p.gap_m * p.normal;
  };
  const TouchingPoint& deepest = *std::ranges::min_element(points, {}, &TouchingPoint::gap_m);
  const auto away_m = [&](const TouchingPoint& p) -> Vector3d {
    return middle_m(p) - middle_m(deepest);
  };
  const TouchingPoint& furthest = *std::ranges::max_element(
      points, {}, [&](const TouchingPoint& p) { return away_m(p).squaredNorm(); });
  const auto area = [&](const TouchingPoint& p) {
    return away_m(furthest).cross(away_m(p)).dot(deepest.normal);
  };
  return {deepest, furthest, *std::ranges::max_element(points, {}, area),
          *std::ranges::min_element(points, {}, area)};
}

// The point of b that is closest to a, where one of them is a ball.
void add_ball(const World& world, std::span<const State> states, PointContact contact,
              std::vector<PointContact>& contacts) {
  const Shape& shape_a = world.bodies[contact.body_a].shape;
  const State& a = states[contact.body_a];
  const Vector3d centre = states[contact.body_b].position_m;
  const double radius_m = std::get<SphereShape>(world.bodies[contact.body_b].shape).radius_m;
  const Vector3d local = a.orientation.conjugate() * (centre - a.position_m);
  Vector3d nearest = Vector3d::Zero();
  double round_m = radius_m;
  by_shape(
      shape_a,
      [&](const BoxShape& box) {
        nearest = local.cwiseMax(-box.half_extents_m).cwiseMin(box.half_extents_m);
      },
      [&](const SphereShape& ball) { round_m += ball.radius_m; },
      [&](const PlaneShape&) { nearest = Vector3d(local.x(), local.y(), 0.0); });
  contact.normal = a.orientation * (local - nearest).normalized();
  contact.gap_m = (local - nearest).norm() - round_m;
  contact.position_m = centre - radius_m * contact.normal;
  contacts.push_back(contact);
}

}  // namespace

ContactGeometry all_pairs(const World& world) {
  for (std::size_t b = 1; b < world.bodies.size(); ++b) {
    const bool box = box_of(world.bodies[b].shape) != nullptr;
    if (is_round(world.bodies[b].shape)) continue;
    for (std::size_t a = 0; a < b; ++a) {
      const bool ball = is_round(world.bodies[a].shape);
      const bool fixed = world.bodies[a].fixed && world.bodies[b].fixed;
      if (!fixed && (ball || !box)) return nullptr;
    }
  }
  return [world](std::span<const State> states, std::vector<PointContact>& contacts) {
    for (std::size_t b = 1; b < world.bodies.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        if (world.bodies[a].fixed && world.bodies[b].fixed) continue;
        PointContact contact{.body_a = a, .body_b = b};
        if (is_round(world.bodies[b].shape)) {
          add_ball(world, states, contact, contacts);
          continue;
        }
        contacts.push_back(contact);
      }
    }
  };
}

// How far any point of the body can move in this step, gravity aside.
double SoftMap::reach_m(std::size_t body, const State& state, const Wrench& wrench) const {
  const Body& fact = run_.world.bodies[body];
  if (fact.fixed) return 0.0;
  const double h = run_.step_s;
  const double speed_mps = state.velocity_mps.norm() + h * wrench.force_n.norm() / fact.mass_kg;
  const double spin_radps =
      state.angular_velocity_radps.norm() +
      h * wrench.torque_nm.norm() * fact.inertia_kgm2.cwiseInverse().maxCoeff();
  return h * (speed_mps + spin_radps * bounding_radius_m(fact.shape));
}

double SoftMap::thinner_m(std::size_t body_a, std::size_t body_b) const {
  return std::min(thickness_m(run_.world.bodies[body_a].shape),
                  thickness_m(run_.world.bodies[body_b].shape));
}

bool SoftMap::still_holds(const Memory& memory, double margin_m,
                          std::span<const State> states) const {
  const Body& a = run_.world.bodies[memory.body_a];
  const Body& b = run_.world.bodies[memory.body_b];
  const double bound_m = soft_.keep_share * thinner_m(memory.body_a, memory.body_b);
  if (margin_m + 2.0 * bound_m > memory.found_within_m) return false;
  const State& at_a = states[memory.body_a];
  const State& at_b = states[memory.body_b];
  const Quaterniond to_a = at_a.orientation.conjugate();
  const Eigen::Vector4d now = (to_a * at_b.orientation).coeffs();
  const Eigen::Vector4d then = memory.b_in_a.coeffs();
  const Vector3d between_m = at_b.position_m - at_a.position_m;
  const double lever_m =
      std::min(bounding_radius_m(b.shape), between_m.norm() + bounding_radius_m(a.shape));
  const double turn_m = 2.0 * lever_m * std::min((now - then).norm(), (now + then).norm());
  return (to_a * between_m - memory.between_in_a_m).norm() + turn_m <= bound_m;
}

SoftMap::Memory SoftMap::found(Points points, double reach_m, std::span<const State> states) const {
  Memory memory;
  memory.body_a = points.front().body_a;
  memory.body_b = points.front().body_b;
  const State& a = states[memory.body_a];
  const State& b = states[memory.body_b];
  const Quaterniond to_a = a.orientation.conjugate();
  const double thin_m = thinner_m(memory.body_a, memory.body_b);
  memory.between_in_a_m = to_a * (b.position_m - a.position_m);
  memory.b_in_a = to_a * b.orientation;
  memory.found_within_m = 1.5 * soft_.margin_m + reach_m + 2.0 * soft_.keep_share * thin_m;
  const BoxShape* box_a = box_of(run_.world.bodies[memory.body_a].shape);
  const BoxShape* box_b = box_of(run_.world.bodies[memory.body_b].shape);
  std::vector<TouchingPoint> near(points.begin(), points.end());
  if (box_a != nullptr && box_b != nullptr) {
    const BoxPoints boxes =
        box_points(soft_.boxes, box_a->half_extents_m, a, box_b->half_extents_m, b);
    if (boxes.gap_m > memory.found_within_m) return memory;
    near.clear();
    for (const BoxPoint& point : boxes.points) {
      near.push_back({.position_m = point.on_b_m, .normal = boxes.normal, .gap_m = point.gap_m});
    }
  }
  if (near.empty()) return memory;
  memory.normal_in_a = to_a * near.front().normal;
  std::erase_if(near, [&](const TouchingPoint& p) { return p.gap_m > memory.found_within_m; });
  if (near.size() > k_points) near = four_of(near);
  for (const TouchingPoint& point : near) {
    const Vector3d on_a_m = point.position_m - point.gap_m * point.normal;
    memory.on_a_m[memory.count] = to_a * (on_a_m - a.position_m);
    memory.on_b_m[memory.count] = b.orientation.conjugate() * (point.position_m - b.position_m);
    ++memory.count;
  }
  return memory;
}

// Each point takes the impulse of the nearest old point that is near enough to be the same.
void SoftMap::inherit(const Memory& old, Memory& next) const {
  if (old.normal_in_a.dot(next.normal_in_a) < soft_.same_normal) return;
  const double thin_m = thinner_m(next.body_a, next.body_b);
  std::array<bool, k_points> taken{};
  for (std::size_t p = 0; p < next.count; ++p) {
    std::size_t same = k_points;
    double nearest_m = soft_.same_point_share * thin_m;
    for (std::size_t q = 0; q < old.count; ++q) {
      const double away_m = (old.on_b_m[q] - next.on_b_m[p]).norm();
      if (taken[q] || !(away_m < nearest_m)) continue;
      nearest_m = away_m;
      same = q;
    }
    if (same == k_points) continue;
    taken[same] = true;
    next.impulse_ns[p] = old.impulse_ns[same];
    next.friction_ns = old.friction_ns;
    next.twist_ns = old.twist_ns;
  }
}

// Contacts of this step with what they inherit from the last one.
bool SoftMap::remember(std::span<const Wrench> wrenches, std::span<const State> states,
                       std::string& why) {
  if (!run_.geometry) {
    why = "a box on a ball, or a plane made last, is not listed";
    return false;
  }
  const std::vector<TouchingPoint> points =
      touching_points(run_, states, k_infinity, soft_.boxes.border_share);
  std::vector<Memory> next;
  for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
    const std::size_t body_a = points[begin].body_a, body_b = points[begin].body_b;
    const auto same_pair = [&](const auto& m) { return m.body_a == body_a && m.body_b == body_b; };
    while (end < points.size() && same_pair(points[end])) ++end;
    const double reach = reach_m(body_a, states[body_a], wrenches[body_a]) +
                         reach_m(body_b, states[body_b], wrenches[body_b]);
    const auto old = std::ranges::find_if(memories_, same_pair);
    const bool known = old != memories_.end();
    if (known && still_holds(*old, soft_.margin_m + reach, states)) {
      next.push_back(*old);
      continue;
    }
    Memory memory = found(std::span(points).subspan(begin, end - begin), reach, states);
    if (memory.count == 0) continue;
    if (known) inherit(*old, memory);
    next.push_back(memory);
  }
  memories_ = std::move(next);
  return true;
}

// Where the points are now; whether some may close within the step.
bool SoftMap::fill_points(Row& row, std::span<const State> states) const {
  const Memory& memory = *row.memory;
  const State& a = states[memory.body_a];
  const State& b = states[memory.body_b];
  const ContactLaw law = contact_law(run_.world, memory.body_a, memory.body_b);
  const Vector3d normal = a.orientation * memory.normal_in_a;
  row.normal = normal.cast<float>();
  row.friction = static_cast<float>(law.friction);
  bool near = false;
  for (std::size_t p = 0; p < memory.count; ++p) {
    const Vector3d on_a = a.orientation * memory.on_a_m[p];
    const Vector3d on_b = b.orientation * memory.on_b_m[p] + b.position_m - a.position_m;
    const Vector3d lever_a = 0.5 * (on_a + on_b);
    const Vector3d lever_b = lever_a - (b.position_m - a.position_m);
    const double gap_m = normal.dot(on_b - on_a);
    near = near || gap_m <= soft_.margin_m + row.reach_m;
    Point point;
    point.lever_a = lever_a.cast<float>();
    point.lever_b = lever_b.cast<float>();
    point.gap_m = point.gap_now_m = static_cast<float>(gap_m);
    point.impulse_ns = point.carried_ns = memory.impulse_ns[p];
    point.view = {memory.body_a, memory.body_b, a.position_m + lever_a,
                  normal,        gap_m,         Vector3d::Zero()};
    const double speed = normal.dot(b.velocity_mps + b.angular_velocity_radps.cross(lever_b) -
                                    a.velocity_mps - a.angular_velocity_radps.cross(lever_a));
    if (speed < -soft_.resting_approach_mps) {
      point.approach_mps = -speed;
      point.bounce_mps = static_cast<float>(-law.restitution * speed);
    }
    row.points.push_back(point);
  }
  return near;
}

// Of both bodies, with the size of what pulls on them, torques with the lever of the body's radius,
// in a sub-step.
float SoftMap::weight_ns(const Memory& memory, std::span<const Wrench> wrenches) const {
  double weight_n = 0.0, load_n = 0.0;
  for (const std::size_t i : {memory.body_a, memory.body_b}) {
    const Body& body = run_.world.bodies[i];
    if (body.fixed) continue;
    weight_n += body.mass_kg * run_.world.gravity_mps2.norm();
    load_n +=
        wrenches[i].force_n.norm() + wrenches[i].torque_nm.norm() / bounding_radius_m(body.shape);
  }
  return static_cast<float>(run_.step_s / soft_.substeps *
                            (weight_n + double{static_cast<float>(load_n)}));
}

// One row per manifold that may close within the step, coloured greedily in the order of the pairs.
void SoftMap::make_rows(std::span<const Wrench> wrenches, std::span<const State> states) {
  rows_.clear();
  std::vector<std::vector<int>> taken(states.size());
  for (Memory& memory : memories_) {
    Row row;
    row.memory = &memory;
    const auto reach = [&](std::size_t body) {
      return reach_m(body, states[body], wrenches[body]);
    };
    row.reach_m = reach(memory.body_a) + reach(memory.body_b);
    if (!fill_points(row, states)) {
      memory.impulse_ns.fill(0.0F);
      memory.friction_ns.setZero();
      memory.twist_ns = 0.0F;
      continue;
    }
    row.weight_ns = weight_ns(memory, wrenches);
    row.a = side(memory.body_a, states[memory.body_a]);
    row.b = side(memory.body_b, states[memory.body_b]);
    const auto used = [&](const Side& s) {
      return !s.fixed && std::ranges::count(taken[s.body], row.colour) > 0;
    };
    while (used(row.a) || used(row.b)) ++row.colour;
    for (const Side* s : {&row.a, &row.b}) taken[s->body].push_back(row.colour);
    prepare(row);
    rows_.push_back(row);
  }
  std::ranges::stable_sort(rows_, {}, &Row::colour);
}

std::vector<Contact> SoftMap::contacts() const {
  std::vector<Contact> contacts;
  for (const Row& row : rows_) {
    const double share = 1.0 / static_cast<double>(row.points.size());
    Vector3d middle = Vector3d::Zero();
    for (const Point& point : row.points) middle += share * point.view.position_m;
    double squares = 0.0;
    for (const Point& point : row.points) {
      squares += (point.view.position_m - middle).squaredNorm();
    }
    const Vector friction =
        row.friction_total_ns[0] * row.tangent[0] + row.friction_total_ns[1] * row.tangent[1];
    const double turn = squares > 0.0 ? row.twist_total_ns / squares : 0.0;
    for (const Point& point : row.points) {
      const Vector3d normal = row.normal.cast<double>();
      Contact contact = point.view;
      contact.impulse_ns = point.total_ns * normal + share * friction.cast<double>() +
                           turn * normal.cross(contact.position_m - middle);
      contacts.push_back(contact);
    }
  }
  return contacts;
}

}  // namespace brickbench::exact
