// A tiny engine in C++ (brickbench_engine.hpp): bodies that fall, turn and are pushed,
// semi-implicit Euler, and a refusal where they may touch. Replace it by your own.
//
//   g++ -std=c++20 -O2 your_engine.cpp -o your_engine
#include <algorithm>

#include "brickbench_engine.hpp"

namespace {

using namespace brickbench_engine;

Vector sum(const Vector& a, double factor, const Vector& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Vector& a) { return std::sqrt(dot(a, a)); }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector axis(const Quaternion& q) { return {q[1], q[2], q[3]}; }
Quaternion conjugate(const Quaternion& q) { return {q[0], -q[1], -q[2], -q[3]}; }

Quaternion product(const Quaternion& p, const Quaternion& q) {
  const Vector v = sum(sum(cross(axis(p), axis(q)), p[0], axis(q)), q[0], axis(p));
  return {p[0] * q[0] - dot(axis(p), axis(q)), v[0], v[1], v[2]};
}

Vector rotated(const Quaternion& q, const Vector& v) {
  const Vector t = cross(axis(q), v);
  return sum(sum(v, 2.0 * q[0], t), 2.0, cross(axis(q), t));
}

// The rotation by a vector, axis times angle.
Quaternion turn(const Vector& angle_rad) {
  const double angle = length(angle_rad);
  if (angle == 0.0) return {1, 0, 0, 0};
  const double share = std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), share * angle_rad[0], share * angle_rad[1], share * angle_rad[2]};
}

class FreeFlight final : public Engine {
 public:
  std::string hello() const override {
    return R"({"name": "free flight in C++", "version": "1", "shapes": ["box", "sphere", "plane"],
      "variants": [{"name": "default", "meaning": "no contact: refuses to touch",
                    "precision": "f64", "knobs": {"clearance_m": 0}}],
      "knobs": [{"name": "clearance_m", "unit": "m", "engine_default": 0, "min": 0, "max": 1000,
                 "meaning": "the step is refused where bounding spheres come closer"}]})";
  }
  std::vector<std::string> views() const override { return {"set_state", "audit"}; }

  void build(const Scenery& scenery, const Setup& setup) override {
    scenery_ = scenery;
    step_s_ = setup.step_s;
    clearance_m_ = setup.knobs.at("clearance_m");
    states_.clear();
    for (const Thing& body : scenery.bodies) states_.push_back(body.initial);
  }

  void step(std::span<const Push> pushes) override {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (!scenery_.bodies[i].fixed) advance(i, pushes.empty() ? Push{} : pushes[i]);
    }
    refuse_contact();
  }

  std::vector<BodyState> states() const override { return states_; }

  void set_state(std::span<const BodyState> states) override {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (!scenery_.bodies[i].fixed) states_[i] = states[i];
    }
  }

  // What the live engine holds: here its scenery is all that it has.
  std::string audit() const override {
    std::string bodies;
    for (const Thing& body : scenery_.bodies) {
      if (!bodies.empty()) bodies += ',';
      bodies += std::string("{\"fixed\":") + (body.fixed ? "true" : "false") +
                ",\"mass_kg\":" + number_text(body.fixed ? 0.0 : body.mass_kg) +
                ",\"inertia_kgm2\":" + vector_text(body.fixed ? Vector{} : body.inertia_kgm2) +
                ",\"shape\":" + form_text(body.form) +
                R"(,"linear_damping_hz":0,"angular_damping_hz":0,"can_sleep":false})";
    }
    return std::string("{\"gravity_mps2\":") + vector_text(scenery_.gravity_mps2) +
           ",\"bodies\":[" + bodies + R"(],"settings":[{"name":"step_s","unit":"s","value":")" +
           number_text(step_s_) + R"("},{"name":"clearance_m","unit":"m","value":")" +
           number_text(clearance_m_) + "\"}]}";
  }

  Law pair_law(std::size_t a, std::size_t b) const override { return scenery_.law_of(a, b); }

 private:
  void advance(std::size_t i, const Push& push) {
    const Thing& body = scenery_.bodies[i];
    BodyState& s = states_[i];
    const Vector acceleration = sum(scenery_.gravity_mps2, 1.0 / body.mass_kg, push.force_n);
    s.velocity_mps = sum(s.velocity_mps, step_s_, acceleration);
    s.position_m = sum(s.position_m, step_s_, s.velocity_mps);
    const Quaternion to_body = conjugate(s.orientation);
    Vector spin = rotated(to_body, s.angular_velocity_radps);
    Vector momentum = spin;
    for (std::size_t k = 0; k < 3; ++k) momentum[k] *= body.inertia_kgm2[k];
    const Vector torque = sum(rotated(to_body, push.torque_nm), -1.0, cross(spin, momentum));
    for (std::size_t k = 0; k < 3; ++k) spin[k] += step_s_ * torque[k] / body.inertia_kgm2[k];
    const Vector angle_rad = sum({}, step_s_, spin);
    s.orientation = product(s.orientation, turn(angle_rad));
    const double norm = std::sqrt(s.orientation[0] * s.orientation[0] +
                                  dot(axis(s.orientation), axis(s.orientation)));
    for (double& x : s.orientation) x /= norm;
    s.angular_velocity_radps = rotated(s.orientation, spin);
  }

  static double bounding_radius_m(const Form& form) {
    return form.kind == "box" ? length(form.half_extents_m) : form.radius_m;
  }

  double gap_m(std::size_t i, std::size_t k) const {
    const Form& form = scenery_.bodies[k].form;
    const Vector apart = sum(states_[i].position_m, -1.0, states_[k].position_m);
    const double distance_m = form.kind == "plane"
                                  ? dot(apart, rotated(states_[k].orientation, {0, 0, 1}))
                                  : length(apart) - bounding_radius_m(form);
    return distance_m - bounding_radius_m(scenery_.bodies[i].form);
  }

  void refuse_contact() const {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      for (std::size_t k = 0; k < states_.size(); ++k) {
        if (i == k || scenery_.bodies[i].fixed || gap_m(i, k) > clearance_m_) continue;
        throw Refusal("'" + scenery_.bodies[i].name + "' and '" + scenery_.bodies[k].name +
                      "' may touch, and this engine has no contact");
      }
    }
  }

  Scenery scenery_;
  double step_s_ = 0.0;
  double clearance_m_ = 0.0;
  std::vector<BodyState> states_;
};

}  // namespace

int main() {
  FreeFlight engine;
  return serve(engine);
}
