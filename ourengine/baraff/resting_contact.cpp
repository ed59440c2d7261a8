#include "ourengine/baraff/resting_contact.hpp"

#include <algorithm>

namespace ourengine::baraff {
namespace {

// Acceleration of the point of the body at p without contact forces (appendix D, compute_b_vector).
Eigen::Vector3d free_acceleration(const RigidBody& body, const Eigen::Vector3d& point_m) {
  if (body.is_fixed()) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d r = point_m - body.position_m;
  const Eigen::Vector3d& w = body.angular_velocity_radps;
  const Eigen::Vector3d spin_up =
      body.inertia_inv * (body.torque_nm + body.angular_momentum_nms.cross(w));
  return body.mass_inv * body.force_n + spin_up.cross(r) + w.cross(w.cross(r));
}

// Acceleration of the point of body `of` at `point_m` per newton at contact j.
Eigen::Vector3d response(std::span<const RigidBody> bodies, std::size_t of,
                         const Eigen::Vector3d& point_m, const Collision& j) {
  const double sign = of == j.obj1 ? 1.0 : of == j.obj2 ? -1.0 : 0.0;
  const RigidBody& body = bodies[of];
  if (sign == 0.0 || body.is_fixed()) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d force = sign * j.normal;
  const Eigen::Vector3d torque = (j.location - body.position_m).cross(force);
  return body.mass_inv * force + (body.inertia_inv * torque).cross(point_m - body.position_m);
}

// The points of both bodies whose distance along the normal is the gap, up to a constant: the same
// point for bricks. For a sphere its centre, and the point of the other body that the normal leads
// away from; a face leads its normal along, so any point of it will do: the one at the centre.
struct Points {
  Eigen::Vector3d on_obj1;
  Eigen::Vector3d on_obj2;
};
Points points_of(std::span<const RigidBody> bodies, const Collision& contact) {
  if (contact.ball == BallOn::none) return {contact.location, contact.location};
  const Eigen::Vector3d& centre = bodies[contact.obj1].position_m;
  if (contact.ball == BallOn::face) return {centre, centre};
  if (contact.ball == BallOn::centre) return {centre, bodies[contact.obj2].position_m};
  return {centre, contact.location};
}

// n = y / |y|, y from obj2's point to the centre, less its part along the edge where there is one.
Eigen::Vector3d ball_ndot(std::span<const RigidBody> bodies, const Collision& contact) {
  const auto [centre, anchor] = points_of(bodies, contact);
  const Eigen::Vector3d y = centre - anchor;
  Eigen::Vector3d rate = velocity_of_point_on_body(bodies[contact.obj1], centre) -
                         velocity_of_point_on_body(bodies[contact.obj2], anchor);
  if (contact.ball == BallOn::edge) {
    const Eigen::Vector3d& edge = contact.edge2;
    const Eigen::Vector3d edge_rate = bodies[contact.obj2].angular_velocity_radps.cross(edge);
    rate -= edge * (edge.dot(rate) + edge_rate.dot(y));
  }
  return (rate - contact.normal * contact.normal.dot(rate)) / y.norm();
}

}  // namespace

double relative_normal_velocity(std::span<const RigidBody> bodies, const Collision& contact) {
  return contact.normal.dot(velocity_of_point_on_body(bodies[contact.obj1], contact.location) -
                            velocity_of_point_on_body(bodies[contact.obj2], contact.location));
}

Eigen::Vector3d compute_ndot(std::span<const RigidBody> bodies, const Collision& contact) {
  const Eigen::Vector3d& w1 = bodies[contact.obj1].angular_velocity_radps;
  const Eigen::Vector3d& w2 = bodies[contact.obj2].angular_velocity_radps;
  if (contact.ball != BallOn::none && contact.ball != BallOn::face) {
    return ball_ndot(bodies, contact);
  }
  if (contact.vertex_face) return w2.cross(contact.normal);
  const Eigen::Vector3d n = contact.edge1.cross(contact.edge2);
  const double length = n.norm();
  const double sign = n.dot(contact.normal) > 0.0 ? 1.0 : -1.0;
  const Eigen::Vector3d z =
      w1.cross(contact.edge1).cross(contact.edge2) + contact.edge1.cross(w2.cross(contact.edge2));
  return sign * (z - contact.normal * contact.normal.dot(z)) / length;
}

double compute_aij(std::span<const RigidBody> bodies, const Collision& i, const Collision& j) {
  return i.normal.dot(response(bodies, i.obj1, i.location, j) -
                      response(bodies, i.obj2, i.location, j));
}

SparseMatrix compute_a_matrix(std::span<const RigidBody> bodies,
                              std::span<const Collision> contacts) {
  std::vector<std::vector<int>> of_body(bodies.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    of_body[contacts[i].obj1].push_back(static_cast<int>(i));
    of_body[contacts[i].obj2].push_back(static_cast<int>(i));
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < static_cast<int>(contacts.size()); ++i) {
    const Collision& contact = contacts[static_cast<std::size_t>(i)];
    for (const std::size_t body : {contact.obj1, contact.obj2}) {
      if (bodies[body].is_fixed()) continue;
      const double sign_i = body == contact.obj1 ? 1.0 : -1.0;
      for (const int j : of_body[body]) {
        if (j > i) continue;
        const Collision& other = contacts[static_cast<std::size_t>(j)];
        const double part =
            sign_i * contact.normal.dot(response(bodies, body, contact.location, other));
        entries.emplace_back(i, j, part);
        if (i != j) entries.emplace_back(j, i, part);
      }
    }
  }
  const auto n = static_cast<Eigen::Index>(contacts.size());
  SparseMatrix a_matrix(n, n);
  a_matrix.setFromTriplets(entries.begin(), entries.end());
  return a_matrix;
}

Eigen::VectorXd compute_b_vector(std::span<const RigidBody> bodies,
                                 std::span<const Collision> contacts) {
  Eigen::VectorXd b(static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Collision& contact = contacts[i];
    const RigidBody& one = bodies[contact.obj1];
    const RigidBody& two = bodies[contact.obj2];
    const auto [point1, point2] = points_of(bodies, contact);
    const Eigen::Vector3d slip =
        velocity_of_point_on_body(one, point1) - velocity_of_point_on_body(two, point2);
    const Eigen::Vector3d ndot = compute_ndot(bodies, contact);
    // Of (n . (p1 - p2))''; the last term is n'' . (p1 - p2), as n . n'' = -n' . n'.
    b[static_cast<Eigen::Index>(i)] =
        contact.normal.dot(free_acceleration(one, point1) - free_acceleration(two, point2)) +
        2.0 * ndot.dot(slip) - ndot.squaredNorm() * (point1 - point2).norm();
  }
  return b;
}

double term_size(std::span<const RigidBody> bodies, std::span<const Collision> contacts,
                 double per_s) {
  double largest = 0.0;
  for (const Collision& contact : contacts) {
    const auto [point1, point2] = points_of(bodies, contact);
    const auto size_at = [&](const RigidBody& body, const Eigen::Vector3d& point) {
      return free_acceleration(body, point).norm() +
             per_s * velocity_of_point_on_body(body, point).norm();
    };
    largest = std::max(
        largest, size_at(bodies[contact.obj1], point1) + size_at(bodies[contact.obj2], point2));
  }
  return largest;
}

}  // namespace ourengine::baraff
