#include "ourengine/baraff/face_contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace ourengine::baraff {
namespace {

constexpr double k_parallel = 1e-3;  // sine of the angle between two sides that do not cross
constexpr double k_same_side = 0.5;  // least cosine between an edge-edge normal and the face's

using Corners = std::array<Eigen::Vector3d, 4>;

// A face as four corners in order, with its outward normal.
struct Face {
  Corners corners;
  Eigen::Vector3d normal;
};

Face face_of(const RigidBody& body, Eigen::Index axis, double sign) {
  const Eigen::Vector3d& half = std::get<Box>(body.solid).half_m;
  const Eigen::Index s = (axis + 1) % 3;
  const Eigen::Index t = (axis + 2) % 3;
  const Eigen::Vector3d normal = sign * body.rotation.col(axis);
  const Eigen::Vector3d centre = body.position_m + half[axis] * normal;
  const Eigen::Vector3d u = half[s] * body.rotation.col(s);
  const Eigen::Vector3d v = half[t] * body.rotation.col(t);
  return {{centre + u + v, centre - u + v, centre - u - v, centre + u - v}, normal};
}

Face opposed_face(const RigidBody& body, const Eigen::Vector3d& outward) {
  const Eigen::Vector3d local = body.rotation.transpose() * outward;
  Eigen::Index axis = 0;
  local.cwiseAbs().maxCoeff(&axis);
  return face_of(body, axis, local[axis] > 0.0 ? -1.0 : 1.0);
}

// Whether `point`, seen along `along`, lies in the face, or outside by at most `slack_m`.
bool covers(const Face& face, const Eigen::Vector3d& point, const Eigen::Vector3d& along,
            double slack_m) {
  double lowest = HUGE_VAL;
  double highest = -HUGE_VAL;
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d side = face.corners[(k + 1) % 4] - face.corners[k];
    const Eigen::Vector3d inward = along.cross(side).normalized();
    const double distance = inward.dot(point - face.corners[k]);
    lowest = std::min(lowest, distance);
    highest = std::max(highest, distance);
  }
  // The corners may run either way around: inside, all distances have one sign.
  return lowest >= -slack_m || highest <= slack_m;
}

// Contacts of one pair of faces, each location once.
class Patch {
 public:
  Patch(std::vector<Collision>& collisions, double tolerance_m, double slack_m)
      : collisions_(collisions),
        first_(collisions.size()),
        tolerance_m_(tolerance_m),
        slack_m_(slack_m) {}

  bool empty() const { return collisions_.size() == first_; }
  void add(const Collision& made) {
    if (made.gap_m > tolerance_m_) return;
    for (std::size_t k = first_; k < collisions_.size(); ++k) {
      const Eigen::Vector3d between = collisions_[k].location - made.location;
      const double along = between.dot(made.normal);
      if (between.squaredNorm() - along * along <= 4.0 * slack_m_ * slack_m_) return;
    }
    collisions_.push_back(made);
  }

 private:
  std::vector<Collision>& collisions_;
  std::size_t first_;
  double tolerance_m_;
  double slack_m_;
};

// Corners of `face` of body `vertex_body` that lie over `other` of body `face_body`.
void add_corners(std::size_t vertex_body, const Face& face, std::size_t face_body,
                 const Face& other, const Eigen::Vector3d& along, double slack_m, Patch& patch) {
  for (const Eigen::Vector3d& corner : face.corners) {
    if (!covers(other, corner, along, slack_m)) continue;
    patch.add({.obj1 = vertex_body,
               .obj2 = face_body,
               .location = corner,
               .normal = other.normal,
               .gap_m = other.normal.dot(corner - other.corners[0])});
  }
}

// Crossings of the sides of two faces, seen along `outward` of the face of obj2.
void add_crossings(std::size_t obj1, const Face& one, std::size_t obj2, const Face& two,
                   const Eigen::Vector3d& outward, double slack_m, Patch& patch) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p = one.corners[i];
    const Eigen::Vector3d side1 = one.corners[(i + 1) % 4] - p;
    const double length1 = side1.norm();
    const Eigen::Vector3d d = side1 / length1;
    for (std::size_t j = 0; j < 4; ++j) {
      const Eigen::Vector3d q = two.corners[j];
      const Eigen::Vector3d side2 = two.corners[(j + 1) % 4] - q;
      const double length2 = side2.norm();
      const Eigen::Vector3d e = side2 / length2;
      Eigen::Vector3d normal = d.cross(e);
      const double sine = normal.norm();
      if (sine < k_parallel) continue;
      normal *= (normal.dot(outward) > 0.0 ? 1.0 : -1.0) / sine;
      if (normal.dot(outward) < k_same_side) continue;
      const Eigen::Vector3d between = q - p;
      const double s = between.cross(e).dot(d.cross(e)) / (sine * sine);
      const double t = between.cross(d).dot(d.cross(e)) / (sine * sine);
      if (s <= slack_m || s >= length1 - slack_m || t <= slack_m || t >= length2 - slack_m)
        continue;
      const Eigen::Vector3d on1 = p + s * d;
      const Eigen::Vector3d on2 = q + t * e;
      patch.add({.obj1 = obj1,
                 .obj2 = obj2,
                 .location = 0.5 * (on1 + on2),
                 .normal = normal,
                 .edge1 = d,
                 .edge2 = e,
                 .vertex_face = false,
                 .gap_m = normal.dot(on1 - on2)});
    }
  }
}

}  // namespace

void add_face_contacts(std::span<const RigidBody> bodies, std::size_t reference, int face,
                       const Eigen::Vector3d& outward, std::size_t incident, double tolerance_m,
                       std::vector<Collision>& collisions) {
  const RigidBody& owner = bodies[reference];
  const double sign = owner.rotation.col(face).dot(outward) > 0.0 ? 1.0 : -1.0;
  const Face own = face_of(owner, face, sign);
  const Face other = opposed_face(bodies[incident], outward);
  const double slack_m =
      k_border_share * std::min(std::get<Box>(owner.solid).half_m.minCoeff(),
                                std::get<Box>(bodies[incident].solid).half_m.minCoeff());
  Patch patch(collisions, tolerance_m, slack_m);
  add_corners(incident, other, reference, own, outward, slack_m, patch);
  add_corners(reference, own, incident, other, outward, slack_m, patch);
  add_crossings(incident, other, reference, own, outward, slack_m, patch);
  if (!patch.empty()) return;
  // The deepest corner lies beside the reference face: it is the contact all the same.
  const auto deepest = std::ranges::min_element(
      other.corners, {}, [&](const Eigen::Vector3d& corner) { return outward.dot(corner); });
  patch.add({.obj1 = incident,
             .obj2 = reference,
             .location = *deepest,
             .normal = own.normal,
             .gap_m = own.normal.dot(*deepest - own.corners[0])});
}

}  // namespace ourengine::baraff
