#include "ourengine/baraff/joint_collision.hpp"

#include <algorithm>
#include <optional>

#include "ourengine/baraff/resting_contact.hpp"

namespace ourengine::baraff {
namespace {

struct Group {
  double restitution = 0.0;
  std::vector<std::size_t> members;       // places in the list of contacts
  std::optional<SparseMatrix> responses;  // A, once it was needed
};

bool is_pair(const Collision& a, const Collision& b) {
  return a.obj1 == b.obj1 ? a.obj2 == b.obj2 : a.obj1 == b.obj2 && a.obj2 == b.obj1;
}

// The contacts are in the order of the pairs.
std::vector<Group> groups_of(std::span<const RigidBody> bodies, std::span<const Collision> contacts,
                             const RestitutionTable& restitution) {
  std::vector<Group> groups(1);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Collision& contact = contacts[i];
    const double e = restitution(bodies[contact.obj1].surface, bodies[contact.obj2].surface);
    if (e == 0.0) {
      groups.front().members.push_back(i);
    } else if (groups.size() > 1 && is_pair(contacts[groups.back().members.back()], contact)) {
      groups.back().members.push_back(i);
    } else {
      groups.push_back({.restitution = e, .members = {i}, .responses = std::nullopt});
    }
  }
  return groups;
}

void hit_each(std::span<RigidBody> bodies, std::span<Collision> contacts, const Group& group,
              double threshold_mps) {
  for (const std::size_t i : group.members) {
    if (collision_type(bodies, contacts[i], threshold_mps) != ContactType::colliding) continue;
    apply_collision(bodies, contacts[i], collision_impulse(bodies, contacts[i], group.restitution));
  }
}

void hit_at_once(std::span<RigidBody> bodies, std::span<Collision> contacts, Group& group,
                 double threshold_mps) {
  if (group.members.size() == 1) return hit_each(bodies, contacts, group, threshold_mps);
  std::vector<Collision> members;
  for (const std::size_t i : group.members) members.push_back(contacts[i]);
  if (!group.responses) group.responses = compute_a_matrix(bodies, members);
  Eigen::VectorXd wanted_mps(static_cast<Eigen::Index>(members.size()));
  double fastest_mps = 0.0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const Collision& contact = members[i];
    wanted_mps[static_cast<Eigen::Index>(i)] =
        (1.0 + group.restitution) * relative_normal_velocity(bodies, contact);
    for (const std::size_t body : {contact.obj1, contact.obj2}) {
      fastest_mps =
          std::max(fastest_mps, velocity_of_point_on_body(bodies[body], contact.location).norm());
    }
  }
  const QpResult solved = qp_solve(*group.responses, wanted_mps, fastest_mps);
  if (solved.failed) return hit_each(bodies, contacts, group, threshold_mps);
  for (std::size_t i = 0; i < members.size(); ++i) {
    apply_collision(bodies, contacts[group.members[i]], solved.force[static_cast<Eigen::Index>(i)]);
  }
}

}  // namespace

int collide_in_groups(std::span<RigidBody> bodies, std::span<Collision> contacts,
                      const RestitutionTable& restitution, double threshold_mps, int max_sweeps) {
  std::vector<Group> groups = groups_of(bodies, contacts, restitution);
  for (int sweep = 0;; ++sweep) {
    bool had_collision = false;
    for (Group& group : groups) {
      const bool collides = std::ranges::any_of(group.members, [&](std::size_t i) {
        return collision_type(bodies, contacts[i], threshold_mps) == ContactType::colliding;
      });
      if (!collides) continue;
      if (sweep == max_sweeps) return max_sweeps + 1;
      had_collision = true;
      hit_at_once(bodies, contacts, group, threshold_mps);
    }
    if (!had_collision) return sweep;
  }
}

}  // namespace ourengine::baraff
