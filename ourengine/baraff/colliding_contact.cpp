#include "ourengine/baraff/colliding_contact.hpp"

#include "ourengine/baraff/resting_contact.hpp"

namespace ourengine::baraff {
namespace {

// n . (I^-1 (r x n)) x r
double angular_term(const RigidBody& body, const Collision& contact) {
  const Eigen::Vector3d r = contact.location - body.position_m;
  return contact.normal.dot((body.inertia_inv * r.cross(contact.normal)).cross(r));
}

}  // namespace

ContactType collision_type(std::span<const RigidBody> bodies, const Collision& contact,
                           double threshold_mps) {
  const double velocity_mps = relative_normal_velocity(bodies, contact);
  if (velocity_mps < -threshold_mps) return ContactType::colliding;
  return velocity_mps > threshold_mps ? ContactType::separating : ContactType::resting;
}

double collision_impulse(std::span<const RigidBody> bodies, const Collision& contact,
                         double restitution) {
  const RigidBody& a = bodies[contact.obj1];
  const RigidBody& b = bodies[contact.obj2];
  const double denominator =
      a.mass_inv + b.mass_inv + angular_term(a, contact) + angular_term(b, contact);
  return -(1.0 + restitution) * relative_normal_velocity(bodies, contact) / denominator;
}

void apply_collision(std::span<RigidBody> bodies, Collision& contact, double impulse_ns) {
  apply_impulse(bodies[contact.obj1], contact.location, impulse_ns * contact.normal);
  apply_impulse(bodies[contact.obj2], contact.location, -impulse_ns * contact.normal);
  contact.impulse_ns += impulse_ns;
}

int colliding_contact(std::span<RigidBody> bodies, std::span<Collision> contacts,
                      const RestitutionTable& restitution, double threshold_mps, int max_sweeps) {
  for (int sweep = 0;; ++sweep) {
    bool had_collision = false;
    for (Collision& contact : contacts) {
      if (collision_type(bodies, contact, threshold_mps) != ContactType::colliding) continue;
      if (sweep == max_sweeps) return max_sweeps + 1;
      had_collision = true;
      const double e = restitution(bodies[contact.obj1].surface, bodies[contact.obj2].surface);
      apply_collision(bodies, contact, collision_impulse(bodies, contact, e));
    }
    if (!had_collision) return sweep;
  }
}

}  // namespace ourengine::baraff
