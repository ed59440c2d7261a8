#include "experiments/scenes/bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "adapters/seam/shape.hpp"
#include "experiments/scenes/arrangement.hpp"

namespace brickbench {
namespace {

const std::vector<std::string> k_body_keys = {
    "name",          "shape",      "size_m",       "radius_m",     "fixed",
    "density_kgpm3", "mass_kg",    "inertia_kgm2", "surface",      "role",
    "position_m",    "quaternion", "turn",         "velocity_mps", "angular_velocity_radps",
    "repeat",        "when",       "grid",         "stack",        "ring"};
const std::vector<std::string> k_roles = {"brick", "projectile", "none"};
const std::vector<std::string> k_shape_words = {"box", "sphere", "plane"};

// One turn about an axis through the centre, along the world's axes.
struct Turn {
  VectorQuantity axis;
  Quantity angle;
  SourcePosition at;
};

Turn turn_of(const InputValue& table, const Scope& scope) {
  expect(table, "turn", ValueKind::table);
  reject_unknown(table, "turn", {"axis", "angle_rad"});
  const InputValue* axis = table.find("axis");
  const InputValue* angle = table.find("angle_rad");
  if (axis == nullptr || angle == nullptr) {
    reject(table.at, "turn needs axis and angle_rad: turn = { axis = [0, 0, 1], angle_rad = 0.1 }");
  }
  return {VectorQuantity(*axis, "axis", scope), Quantity(*angle, "angle_rad", scope), table.at};
}

// What one [[body]] says, its formulas ready.
class BodyEntry {
 public:
  BodyEntry(const InputValue& entry, const Scope& outer)
      : entry_(&expect(entry, "body", ValueKind::table)), scope_(outer) {
    reject_unknown(entry, "a body", k_body_keys);
    copies_.emplace(entry, scope_);
    arrangement_.emplace(entry, *copies_, scope_);
    copies_->close(entry, scope_);
    read_facts();
    read_pose();
    read_mass();
  }

  void add_to(Scene& scene, SceneOrigins& origins, std::set<std::string>& names) {
    copies_->each(scope_, [&](const Scope& scope) {
      if (scene.world.bodies.size() >= k_most_bodies) {
        reject(entry_->at, fmt::format("a scene has at most {} bodies", k_most_bodies));
      }
      Body body = body_in(scope, origins);
      if (!names.insert(body.name).second) {
        reject(name_->at(), fmt::format("two bodies are called '{}'", body.name));
      }
      const std::size_t index = scene.world.bodies.size();
      if (role_ == "brick") scene.bricks.push_back(index);
      if (role_ == "projectile") scene.projectiles.push_back(index);
      scene.world.bodies.push_back(std::move(body));
      origins.bodies.push_back(entry_->at);
    });
  }

 private:
  const InputValue& needed(const char* key, const char* why) const {
    const InputValue* value = entry_->find(key);
    if (value == nullptr) reject(entry_->at, fmt::format("{} needs the key '{}'", why, key));
    return *value;
  }

  void refuse(const char* key, const char* why) const {
    if (const InputValue* value = entry_->find(key)) {
      reject(value->at, fmt::format("{} has no {}", why, key));
    }
  }

  void read_facts() {
    const InputValue& name = needed("name", "a body");
    name_.emplace(name, "name", scope_);
    has_index_in_name_ = name.text.find('{') != std::string::npos;
    const InputValue& shape = needed("shape", "a body");
    shape_ = filled_text(shape, "shape");
    if (std::ranges::find(k_shape_words, shape_) == k_shape_words.end()) {
      reject(shape.at, fmt::format("no shape '{}'{}", shape_, known_names(shape_, k_shape_words)));
    }
    if (const InputValue* fixed = entry_->find("fixed")) {
      fixed_ = expect(*fixed, "fixed", ValueKind::boolean).number != 0.0;
    }
    if (shape_ == "plane" && !fixed_) {
      reject(shape.at, "a plane must be fixed: add fixed = true");
    }
    if (shape_ == "box") size_.emplace(needed("size_m", "a box"), "size_m", scope_);
    if (shape_ == "sphere") radius_.emplace(needed("radius_m", "a sphere"), "radius_m", scope_);
    if (shape_ != "box") refuse("size_m", ("a " + shape_).c_str());
    if (shape_ != "sphere") refuse("radius_m", ("a " + shape_).c_str());
    if (const InputValue* surface = entry_->find("surface")) {
      surface_.emplace(*surface, "surface", scope_);
    }
    role_ = fixed_ ? "none" : "brick";
    if (const InputValue* role = entry_->find("role")) {
      role_ = filled_text(*role, "role");
      if (std::ranges::find(k_roles, role_) == k_roles.end()) {
        reject(role->at, fmt::format("no role '{}'{}", role_, known_names(role_, k_roles)));
      }
      if (fixed_ && role_ != "none") reject(role->at, "a fixed body is no " + role_);
    }
  }

  void read_pose() {
    position_ = vector_of(*entry_, "position_m", scope_);
    velocity_ = vector_of(*entry_, "velocity_mps", scope_);
    spin_ = vector_of(*entry_, "angular_velocity_radps", scope_);
    const char* still = "a fixed body, which never moves,";
    if (fixed_) refuse("velocity_mps", still);
    if (fixed_) refuse("angular_velocity_radps", still);
    const InputValue* turn = entry_->find("turn");
    const InputValue* quaternion = entry_->find("quaternion");
    if (turn != nullptr && quaternion != nullptr) {
      reject(turn->at, "a body has one of turn and quaternion, not both");
    }
    if (turn != nullptr) {
      for (const InputValue* item : one_or_more(*turn, "turn")) {
        turns_.push_back(turn_of(*item, scope_));
      }
    }
    if (quaternion == nullptr) return;
    expect(*quaternion, "quaternion", ValueKind::array);
    if (quaternion->items.size() != 4) {
      reject(quaternion->at, fmt::format("quaternion has four numbers, w, x, y and z, not {}",
                                         quaternion->items.size()));
    }
    for (const InputValue& item : quaternion->items) {
      quaternion_.emplace_back(item, "quaternion", scope_);
    }
  }

  void read_mass() {
    density_ = quantity_of(*entry_, "density_kgpm3", scope_);
    mass_ = quantity_of(*entry_, "mass_kg", scope_);
    inertia_ = vector_of(*entry_, "inertia_kgm2", scope_);
    const char* still = "a fixed body, which never moves,";
    if (fixed_) {
      for (const char* key : {"density_kgpm3", "mass_kg", "inertia_kgm2"}) refuse(key, still);
      return;
    }
    if (density_.has_value() == mass_.has_value()) {
      reject(entry_->at, "a body that can move needs one of density_kgpm3 and mass_kg");
    }
  }

  double positive(const Quantity& quantity, const char* key, const Scope& scope) const {
    const double value = quantity.in(scope);
    if (!(value > 0.0)) {
      reject(entry_->find(key)->at, fmt::format("{} = {} must be positive", key, value));
    }
    return value;
  }

  Eigen::Vector3d positive(const VectorQuantity& quantity, const char* key,
                           const Scope& scope) const {
    const Eigen::Vector3d value = quantity.in(scope);
    if (!(value.array() > 0.0).all()) {
      reject(entry_->find(key)->at, fmt::format("{} = [{}, {}, {}] must be positive", key,
                                                value.x(), value.y(), value.z()));
    }
    return value;
  }

  Shape shape_in(const Scope& scope) const {
    if (size_) return BoxShape{0.5 * positive(*size_, "size_m", scope)};
    if (radius_) return SphereShape{positive(*radius_, "radius_m", scope)};
    return PlaneShape{};
  }

  Eigen::Quaterniond orientation_in(const Scope& scope) const {
    if (!quaternion_.empty()) {
      return {quaternion_[0].in(scope), quaternion_[1].in(scope), quaternion_[2].in(scope),
              quaternion_[3].in(scope)};
    }
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    for (const Turn& turn : turns_) {
      const Eigen::Vector3d axis = turn.axis.in(scope);
      if (!(axis.norm() > 0.0)) reject(turn.at, "turn: the axis has no direction");
      orientation = Eigen::AngleAxisd(turn.angle.in(scope), axis.normalized()) * orientation;
    }
    return orientation;
  }

  Body body_in(const Scope& scope, SceneOrigins& origins) {
    Body body;
    body.name = name_->in(scope) + (has_index_in_name_ ? "" : copies_->suffix(scope));
    body.shape = shape_in(scope);
    body.fixed = fixed_;
    if (surface_) {
      const std::string surface = surface_->in(scope);
      const int next = static_cast<int>(origins.surfaces.size()) + 1;
      body.surface = origins.surfaces.emplace(surface, next).first->second;
    }
    if (position_) body.initial.position_m = position_->in(scope);
    body.initial.orientation = orientation_in(scope);
    if (velocity_) body.initial.velocity_mps = velocity_->in(scope);
    if (spin_) body.initial.angular_velocity_radps = spin_->in(scope);
    const Eigen::Vector3d up = body.initial.orientation.conjugate() * Eigen::Vector3d::UnitZ();
    arrangement_->place(scope, reach_m(body.shape, up), body.initial);
    if (fixed_) return body;
    body.mass_kg = mass_ ? positive(*mass_, "mass_kg", scope)
                         : solid_mass_kg(body.shape, positive(*density_, "density_kgpm3", scope));
    body.inertia_kgm2 = inertia_ ? positive(*inertia_, "inertia_kgm2", scope)
                                 : solid_inertia_kgm2(body.shape, body.mass_kg);
    return body;
  }

  const InputValue* entry_;
  Scope scope_;
  std::optional<Copies> copies_;
  std::optional<Arrangement> arrangement_;
  std::optional<Template> name_;
  bool has_index_in_name_ = false;
  std::string shape_;
  bool fixed_ = false;
  std::optional<VectorQuantity> size_;
  std::optional<Quantity> radius_;
  std::optional<Template> surface_;
  std::string role_;
  std::optional<VectorQuantity> position_;
  std::optional<VectorQuantity> velocity_;
  std::optional<VectorQuantity> spin_;
  std::vector<Turn> turns_;
  std::vector<Quantity> quaternion_;
  std::optional<Quantity> density_;
  std::optional<Quantity> mass_;
  std::optional<VectorQuantity> inertia_;
};

}  // namespace

void add_bodies(const InputValue& entries, const Scope& scope, Scene& scene,
                SceneOrigins& origins) {
  std::set<std::string> names;
  if (entries.kind != ValueKind::array) {
    reject(entries.at, "body must be an array of tables: write [[body]]");
  }
  for (const InputValue& entry : entries.items) {
    BodyEntry(entry, scope).add_to(scene, origins, names);
  }
}

}  // namespace brickbench
