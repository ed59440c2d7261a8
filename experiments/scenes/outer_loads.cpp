#include "experiments/scenes/outer_loads.hpp"

#include <fmt/format.h>

#include <limits>
#include <map>

#include "experiments/scenes/copies.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_most_times = 10000;

using BodyIndices = std::map<std::string, std::size_t, std::less<>>;

const InputValue& load_part(const InputValue& entry, const char* what, const char* key) {
  const InputValue* value = entry.find(key);
  if (value == nullptr) reject(entry.at, fmt::format("{} needs the key '{}'", what, key));
  return *value;
}

// What blows and forces have in common: copies, and the body that is meant.
class LoadEntry {
 public:
  LoadEntry(const InputValue& entry, const char* what, const Scope& outer) : scope_(outer) {
    expect(entry, what, ValueKind::table);
    copies_.emplace(entry, scope_);
    copies_->close(entry, scope_);
    body_.emplace(load_part(entry, what, "body"), "body", scope_);
  }

  const Scope& scope() const { return scope_; }

  void each(const Scene& scene, const BodyIndices& bodies,
            const std::function<void(const Scope&, std::size_t)>& visit) const {
    copies_->each(scope_, [&](const Scope& scope) {
      const std::string name = body_->in(scope);
      const auto found = bodies.find(name);
      if (found == bodies.end()) {
        std::vector<std::string> known;
        for (const Body& body : scene.world.bodies) {
          if (known.size() < 20) known.push_back(body.name);
        }
        reject(body_->at(), fmt::format("no body '{}'{}", name, known_names(name, known)));
      }
      if (scene.world.bodies[found->second].fixed) {
        reject(body_->at(), fmt::format("'{}' is fixed: nothing that acts on it shows", name));
      }
      visit(scope, found->second);
    });
  }

 private:
  Scope scope_;
  std::optional<Copies> copies_;
  std::optional<Template> body_;
};

Eigen::Vector3d or_zero(const std::optional<VectorQuantity>& quantity, const Scope& scope) {
  return quantity ? quantity->in(scope) : Eigen::Vector3d::Zero();
}

void add_blows(const InputValue& entry, const Scope& outer, const BodyIndices& bodies,
               Scene& scene) {
  expect(entry, "blow", ValueKind::table);
  reject_unknown(
      entry, "a blow",
      {"body", "time_s", "impulse_ns", "angular_impulse_nms", "lever_m", "repeat", "when"});
  const LoadEntry load(entry, "a blow", outer);
  const Scope& scope = load.scope();
  const InputValue& time = load_part(entry, "a blow", "time_s");
  const Quantity time_s(time, "time_s", scope);
  const auto impulse_ns = vector_of(entry, "impulse_ns", scope);
  const auto angular_nms = vector_of(entry, "angular_impulse_nms", scope);
  const auto lever_m = vector_of(entry, "lever_m", scope);
  if (!impulse_ns && !angular_nms) {
    reject(entry.at, "a blow needs impulse_ns or angular_impulse_nms or both");
  }
  load.each(scene, bodies, [&](const Scope& in, std::size_t body) {
    Blow blow;
    blow.body = body;
    blow.time_s = time_s.in(in);
    if (blow.time_s < 0.0)
      reject(time.at, fmt::format("time_s = {} is before the start", blow.time_s));
    blow.impulse_ns = or_zero(impulse_ns, in);
    blow.angular_impulse_nms = or_zero(angular_nms, in);
    if (lever_m) blow.angular_impulse_nms += lever_m->in(in).cross(blow.impulse_ns);
    scene.blows.push_back(blow);
  });
}

// The course of a force over time, from from_s and until_s or from times_s and shares.
class Course {
 public:
  Course(const InputValue& entry, const Scope& scope) : entry_(&entry) {
    const InputValue* times = entry.find("times_s");
    const InputValue* shares = entry.find("shares");
    if ((times == nullptr) != (shares == nullptr)) {
      reject(entry.at, "times_s and shares go together");
    }
    from_ = quantity_of(entry, "from_s", scope);
    until_ = quantity_of(entry, "until_s", scope);
    if (times == nullptr) return;
    if (from_ || until_) reject(entry.at, "a force has times_s, or from_s and until_s, not both");
    read(*times, "times_s", scope, times_);
    read(*shares, "shares", scope, shares_);
    if (times_.size() != shares_.size() || times_.size() < 2) {
      reject(shares->at, fmt::format("times_s and shares have equally many numbers, two or more, "
                                     "not {} and {}",
                                     times_.size(), shares_.size()));
    }
  }

  void set(Push& push, const Scope& scope) const {
    if (times_.empty()) {
      push.times_s = {from_ ? from_->in(scope) : 0.0,
                      until_ ? until_->in(scope) : std::numeric_limits<double>::infinity()};
      push.shares = {1.0, 1.0};
    }
    for (const Quantity& time : times_) push.times_s.push_back(time.in(scope));
    for (const Quantity& share : shares_) push.shares.push_back(share.in(scope));
    for (std::size_t i = 0; i + 1 < push.times_s.size(); ++i) {
      if (push.times_s[i] <= push.times_s[i + 1]) continue;
      reject(entry_->at, fmt::format("times must ascend: {} s comes after {} s",
                                     push.times_s[i + 1], push.times_s[i]));
    }
  }

 private:
  static void read(const InputValue& list, const char* key, const Scope& scope,
                   std::vector<Quantity>& out) {
    expect(list, key, ValueKind::array);
    if (list.items.size() > k_most_times) {
      reject(list.at, fmt::format("{} has at most {} numbers", key, k_most_times));
    }
    for (const InputValue& item : list.items) out.emplace_back(item, key, scope);
  }

  const InputValue* entry_;
  std::optional<Quantity> from_;
  std::optional<Quantity> until_;
  std::vector<Quantity> times_;
  std::vector<Quantity> shares_;
};

void add_pushes(const InputValue& entry, const Scope& outer, const BodyIndices& bodies,
                Scene& scene) {
  expect(entry, "force", ValueKind::table);
  reject_unknown(entry, "a force",
                 {"body", "force_n", "torque_nm", "point_m", "from_s", "until_s", "times_s",
                  "shares", "repeat", "when"});
  const LoadEntry load(entry, "a force", outer);
  const Scope& scope = load.scope();
  const auto force_n = vector_of(entry, "force_n", scope);
  const auto torque_nm = vector_of(entry, "torque_nm", scope);
  const auto point_m = vector_of(entry, "point_m", scope);
  if (!force_n && !torque_nm) reject(entry.at, "a force needs force_n or torque_nm or both");
  const Course course(entry, scope);
  load.each(scene, bodies, [&](const Scope& in, std::size_t body) {
    Push push;
    push.body = body;
    push.force_n = or_zero(force_n, in);
    push.torque_nm = or_zero(torque_nm, in);
    push.point_m = or_zero(point_m, in);
    course.set(push, in);
    scene.pushes.push_back(std::move(push));
  });
}

const InputValue* entries_of(const InputValue& file, const char* key) {
  const InputValue* list = file.find(key);
  if (list != nullptr && list->kind != ValueKind::array) {
    reject(list->at, fmt::format("{0} must be an array of tables: write [[{0}]]", key));
  }
  return list;
}

}  // namespace

void add_outer_loads(const InputValue& file, const Scope& scope, Scene& scene) {
  const InputValue* blows = entries_of(file, "blow");
  const InputValue* forces = entries_of(file, "force");
  BodyIndices bodies;
  for (std::size_t i = 0; i < scene.world.bodies.size(); ++i) {
    bodies.emplace(scene.world.bodies[i].name, i);
  }
  if (blows != nullptr) {
    for (const InputValue& entry : blows->items) add_blows(entry, scope, bodies, scene);
  }
  if (forces != nullptr) {
    for (const InputValue& entry : forces->items) add_pushes(entry, scope, bodies, scene);
  }
}

}  // namespace brickbench
