// Contacts into coloured batches: which manifold is solved where, and its rows.
#include <algorithm>
#include <bit>
#include <cmath>

#include "ourengine/fast/fast_dynamics.hpp"

namespace ourengine {
namespace {

constexpr std::uint64_t k_all_colours = ~std::uint64_t{0};

void put(Lane3& lanes, std::size_t i, const Eigen::Vector3f& v) {
  for (std::size_t k = 0; k < 3; ++k) lanes[k][i] = v[static_cast<Eigen::Index>(k)];
}

// What a row needs of one body.
struct Side {
  Eigen::Matrix3f inverse_inertia;
  float inverse_mass;
};

void put_row(SoftRow& row, std::size_t i, const Side& a, const Side& b,
             const Eigen::Vector3f& arm_a, const Eigen::Vector3f& arm_b,
             const Eigen::Vector3f& direction) {
  const Eigen::Vector3f moment_a = arm_a.cross(direction);
  const Eigen::Vector3f moment_b = arm_b.cross(direction);
  put(row.arm_a, i, moment_a);
  put(row.arm_b, i, moment_b);
  put(row.turn_a, i, a.inverse_inertia * moment_a);
  put(row.turn_b, i, b.inverse_inertia * moment_b);
}

// Entry of J M^-1 J^T between two rows of the same manifold and lane, angular part.
float coupling(const SoftRow& row, const SoftRow& other, std::size_t i) {
  float sum = 0.0F;
  for (std::size_t k = 0; k < 3; ++k) {
    sum += row.arm_a[k][i] * other.turn_a[k][i] + row.arm_b[k][i] * other.turn_b[k][i];
  }
  return sum;
}

// At most four of the manifold's points: two far apart, then the widest triangle, then the point
// that adds most area on the other side. Returns how many.
int choose_points(std::span<const ContactPoint> points, std::array<int, k_soft_points>& chosen) {
  const int count = static_cast<int>(points.size());
  if (count <= k_soft_points) {
    for (int k = 0; k < count; ++k) chosen[static_cast<std::size_t>(k)] = k;
    return count;
  }
  const auto at = [&](int k) -> const Eigen::Vector3d& {
    return points[static_cast<std::size_t>(k)].position_m;
  };
  const auto best = [&](auto score) {
    int found = 0;
    for (int k = 1; k < count; ++k) {
      if (score(k) > score(found)) found = k;
    }
    return found;
  };
  const Eigen::Vector3d& normal = points[0].normal;
  const int first = best([&](int k) { return -points[static_cast<std::size_t>(k)].gap_m; });
  const int second = best([&](int k) { return (at(k) - at(first)).squaredNorm(); });
  const auto area = [&](int k) {
    return (at(second) - at(first)).cross(at(k) - at(first)).dot(normal);
  };
  const int third = best([&](int k) { return area(k); });
  const int fourth = best([&](int k) { return -area(k); });
  chosen = {first, second, third, fourth};
  return k_soft_points;
}

}  // namespace

// Greedy colouring in the order of the pairs: the lowest colour that neither moving body has yet.
void FastDynamics::colour_manifolds() {
  slots_.clear();
  const auto points = contacts_.points();
  std::vector<std::uint64_t> used(bodies_.size(), 0);
  std::vector<int> sizes;
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin;
    while (end < points.size() && points[end].body_a == points[begin].body_a &&
           points[end].body_b == points[begin].body_b) {
      ++end;
    }
    Slot slot;
    slot.first = static_cast<int>(begin);
    slot.count = static_cast<int>(end - begin);
    slot.solved = choose_points(points.subspan(begin, end - begin), slot.chosen);
    const auto a = static_cast<std::size_t>(points[begin].body_a);
    const auto b = static_cast<std::size_t>(points[begin].body_b);
    std::uint64_t taken = (bodies_[a].fixed ? 0 : used[a]) | (bodies_[b].fixed ? 0 : used[b]);
    // More than 64 contacts on one body share the last colour: lanes of one batch must still be
    // disjoint, so each of them opens a colour of its own behind it.
    if (taken == k_all_colours) {
      slot.colour = static_cast<int>(sizes.size());
    } else {
      slot.colour = std::countr_one(taken);
      used[a] |= std::uint64_t{1} << slot.colour;
      used[b] |= std::uint64_t{1} << slot.colour;
    }
    sizes.resize(std::max(sizes.size(), static_cast<std::size_t>(slot.colour) + 1), 0);
    ++sizes[static_cast<std::size_t>(slot.colour)];
    slots_.push_back(slot);
    begin = end;
  }
  colour_begin_.assign(1, 0);
  for (const int size : sizes) {
    colour_begin_.push_back(colour_begin_.back() +
                            static_cast<std::size_t>((size + k_lanes - 1) / k_lanes));
  }
  const auto rest = static_cast<std::int32_t>(bodies_.size());
  SoftBatch empty{};
  empty.body_a.fill(rest);
  empty.body_b.fill(rest);
  batches_.assign(colour_begin_.back(), empty);
  std::vector<int> next(sizes.size(), 0);
  bouncing_ = false;
  for (Slot& slot : slots_) {
    const auto colour = static_cast<std::size_t>(slot.colour);
    const int place = next[colour]++;
    slot.batch = static_cast<int>(colour_begin_[colour]) + place / k_lanes;
    slot.lane = place % k_lanes;
    fill(slot);
  }
  report_ = {static_cast<int>(points.size()), static_cast<int>(slots_.size()),
             static_cast<int>(sizes.size())};
}

void FastDynamics::fill(const Slot& slot) {
  SoftBatch& batch = batches_[static_cast<std::size_t>(slot.batch)];
  const auto i = static_cast<std::size_t>(slot.lane);
  const auto points = contacts_.points().subspan(static_cast<std::size_t>(slot.first),
                                                 static_cast<std::size_t>(slot.count));
  const auto a = static_cast<std::size_t>(points[0].body_a);
  const auto b = static_cast<std::size_t>(points[0].body_b);
  const auto side = [&](std::size_t body) {
    return Side{inverse_inertia_[body].cast<float>(),
                bodies_[body].fixed ? 0.0F : static_cast<float>(1.0 / bodies_[body].mass_kg)};
  };
  const Side side_a = side(a);
  const Side side_b = side(b);
  const auto rest = static_cast<std::int32_t>(bodies_.size());
  batch.body_a[i] = bodies_[a].fixed ? rest : points[0].body_a;
  batch.body_b[i] = bodies_[b].fixed ? rest : points[0].body_b;
  batch.inverse_mass_a[i] = side_a.inverse_mass;
  batch.inverse_mass_b[i] = side_b.inverse_mass;
  const float inverse_mass = side_a.inverse_mass + side_b.inverse_mass;

  const Eigen::Vector3d& normal = points[0].normal;
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Eigen::Vector3d t1 = normal.cross(Eigen::Vector3d::Unit(axis)).normalized();
  const Eigen::Vector3d t2 = normal.cross(t1);
  put(batch.normal, i, normal.cast<float>());
  put(batch.tangent[0], i, t1.cast<float>());
  put(batch.tangent[1], i, t2.cast<float>());
  batch.points = std::max(batch.points, slot.solved);

  const SurfaceLaw& law = laws_(bodies_[a].surface, bodies_[b].surface);
  batch.friction[i] = static_cast<float>(law.friction);
  const double per_substep = 1.0 / options_.substeps;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();
  for (int p = 0; p < slot.solved; ++p) {
    const ContactPoint& from =
        points[static_cast<std::size_t>(slot.chosen[static_cast<std::size_t>(p)])];
    SoftPoint& point = batch.point[static_cast<std::size_t>(p)];
    const Eigen::Vector3d arm_a = from.position_m - motions_[a].position_m;
    const Eigen::Vector3d arm_b = from.position_m - motions_[b].position_m;
    put_row(point.row, i, side_a, side_b, arm_a.cast<float>(), arm_b.cast<float>(),
            normal.cast<float>());
    point.mass[i] = 1.0F / (inverse_mass + coupling(point.row, point.row, i));
    point.gap[i] = static_cast<float>(from.gap_m);
    point.impulse[i] = static_cast<float>(std::max(0.0, per_substep * normal.dot(from.impulse_ns)));
    if (law.restitution > 0.0) {
      const double approach = normal.dot(velocity_at(b, from) - velocity_at(a, from));
      if (approach < -options_.resting_approach_mps) {
        point.bounce[i] = static_cast<float>(-law.restitution * approach);
        bouncing_ = true;
      }
    }
    centre += from.position_m / slot.solved;
    friction += per_substep * (from.impulse_ns - normal.dot(from.impulse_ns) * normal);
  }

  double arm_sum = 0.0;
  double twist = 0.0;
  for (int p = 0; p < slot.solved; ++p) {
    const ContactPoint& from =
        points[static_cast<std::size_t>(slot.chosen[static_cast<std::size_t>(p)])];
    const Eigen::Vector3d arm = from.position_m - centre;
    arm_sum += arm.norm();
    twist += per_substep * normal.dot(arm.cross(from.impulse_ns));
  }
  batch.twist_arm[i] = static_cast<float>(arm_sum / slot.solved);
  batch.twist_impulse[i] = static_cast<float>(twist);
  batch.friction_impulse[0][i] = static_cast<float>(t1.dot(friction));
  batch.friction_impulse[1][i] = static_cast<float>(t2.dot(friction));

  const Eigen::Vector3f arm_a = (centre - motions_[a].position_m).cast<float>();
  const Eigen::Vector3f arm_b = (centre - motions_[b].position_m).cast<float>();
  put_row(batch.friction_row[0], i, side_a, side_b, arm_a, arm_b, t1.cast<float>());
  put_row(batch.friction_row[1], i, side_a, side_b, arm_a, arm_b, t2.cast<float>());
  const SoftRow& row1 = batch.friction_row[0];
  const SoftRow& row2 = batch.friction_row[1];
  const float k11 = inverse_mass + coupling(row1, row1, i);
  const float k22 = inverse_mass + coupling(row2, row2, i);
  const float k12 = coupling(row1, row2, i);
  const float determinant = k11 * k22 - k12 * k12;
  batch.friction_mass_11[i] = k22 / determinant;
  batch.friction_mass_22[i] = k11 / determinant;
  batch.friction_mass_12[i] = -k12 / determinant;
  const Eigen::Vector3f n = normal.cast<float>();
  const Eigen::Vector3f twist_a = side_a.inverse_inertia * n;
  const Eigen::Vector3f twist_b = side_b.inverse_inertia * n;
  put(batch.twist_a, i, twist_a);
  put(batch.twist_b, i, twist_b);
  batch.twist_mass[i] = 1.0F / n.dot(twist_a + twist_b);
}

}  // namespace ourengine
