#include "experiments/scenes/scene_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "adapters/seam/shape.hpp"
#include "experiments/record/schema.hpp"

namespace brickbench {
namespace {

// Shortest text that TOML reads as the same double: whole numbers get a point, so that none is too
// large to be one, and that -0.0 keeps its sign.
std::string toml_number(double value) {
  std::string text = shortest(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_vector(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", toml_number(v.x()), toml_number(v.y()), toml_number(v.z()));
}

std::string toml_list(const std::vector<double>& list) {
  std::vector<std::string> texts;
  for (const double value : list) texts.push_back(toml_number(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

// Braces stand for themselves when doubled.
std::string toml_name(std::string_view text) {
  std::string doubled;
  for (const char c : text) {
    if (c == '{' || c == '}') doubled += c;
    doubled += c;
  }
  return toml_string(doubled);
}

// The surfaces that a law tells apart from others.
std::set<int> told_apart(const World& world) {
  std::set<int> surfaces;
  for (const PairLaw& pair : world.exceptions) {
    surfaces.insert(pair.surface_a);
    surfaces.insert(pair.surface_b);
  }
  return surfaces;
}

std::string surface_name(int surface) { return fmt::format("surface_{}", surface); }

void put_if(std::string& text, const char* key, const Eigen::Vector3d& v) {
  const bool plain_zero = (v.array() == 0.0).all() && !std::signbit(v.x()) &&
                          !std::signbit(v.y()) && !std::signbit(v.z());
  if (!plain_zero) text += fmt::format("{} = {}\n", key, toml_vector(v));
}

std::string shape_text(const Shape& shape) {
  std::string text = fmt::format("shape = \"{}\"\n", shape_word(shape));
  by_shape(
      shape,
      [&](const BoxShape& box) {
        text += fmt::format("size_m = {}\n", toml_vector(2.0 * box.half_extents_m));
      },
      [&](const SphereShape& ball) {
        text += fmt::format("radius_m = {}\n", toml_number(ball.radius_m));
      },
      [](const PlaneShape&) {});
  return text;
}

std::string body_text(const Body& body, const char* role, const std::set<int>& surfaces) {
  std::string text = fmt::format("\n[[body]]\nname = {}\n", toml_name(body.name));
  text += shape_text(body.shape);
  if (body.fixed) {
    text += "fixed = true\n";
  } else {
    text += fmt::format("role = \"{}\"\nmass_kg = {}\ninertia_kgm2 = {}\n", role,
                        toml_number(body.mass_kg), toml_vector(body.inertia_kgm2));
  }
  if (surfaces.contains(body.surface)) {
    text += fmt::format("surface = \"{}\"\n", surface_name(body.surface));
  }
  put_if(text, "position_m", body.initial.position_m);
  const Eigen::Quaterniond& q = body.initial.orientation;
  text += fmt::format("quaternion = [{}, {}, {}, {}]\n", toml_number(q.w()), toml_number(q.x()),
                      toml_number(q.y()), toml_number(q.z()));
  put_if(text, "velocity_mps", body.initial.velocity_mps);
  put_if(text, "angular_velocity_radps", body.initial.angular_velocity_radps);
  return text;
}

std::string law_text(const ContactLaw& law) {
  return fmt::format("friction = {}\nrestitution = {}\n", toml_number(law.friction),
                     toml_number(law.restitution));
}

std::string blow_text(const Blow& blow, const World& world) {
  std::string text = fmt::format("\n[[blow]]\nbody = {}\ntime_s = {}\nimpulse_ns = {}\n",
                                 toml_name(world.bodies[blow.body].name), toml_number(blow.time_s),
                                 toml_vector(blow.impulse_ns));
  put_if(text, "angular_impulse_nms", blow.angular_impulse_nms);
  return text;
}

std::string push_text(const Push& push, const World& world) {
  std::string text =
      fmt::format("\n[[force]]\nbody = {}\nforce_n = {}\n", toml_name(world.bodies[push.body].name),
                  toml_vector(push.force_n));
  put_if(text, "torque_nm", push.torque_nm);
  put_if(text, "point_m", push.point_m);
  if (push.shares != std::vector<double>{1.0, 1.0}) {
    return text + fmt::format("times_s = {}\nshares = {}\n", toml_list(push.times_s),
                              toml_list(push.shares));
  }
  text += fmt::format("from_s = {}\n", toml_number(push.times_s[0]));
  if (std::isfinite(push.times_s[1])) {
    text += fmt::format("until_s = {}\n", toml_number(push.times_s[1]));
  }
  return text;
}

Expected<void> check_sayable(const Scene& scene) {
  std::set<std::string> names;
  for (const Body& body : scene.world.bodies) {
    if (!names.insert(body.name).second) {
      return fail(Fault::invalid, fmt::format("two bodies are called '{}'", body.name));
    }
    if (body.name.empty()) return fail(Fault::invalid, "a body has no name");
  }
  if (!std::ranges::is_sorted(scene.bricks) || !std::ranges::is_sorted(scene.projectiles)) {
    return fail(Fault::invalid, "bricks and projectiles must be in the order of the bodies");
  }
  return {};
}

}  // namespace

Expected<std::string> scene_text(const Scene& scene, const SceneHead& head) {
  if (auto ok = check_sayable(scene); !ok) return tl::unexpected(ok.error());
  const World& world = scene.world;
  std::string text;
  if (!head.comment.empty()) text += fmt::format("# {}\n", head.comment);
  text += fmt::format("title = {}\nduration_s = {}\ngravity_mps2 = {}\nlength_scale_m = {}\n",
                      toml_string(head.title), toml_number(head.duration_s),
                      toml_vector(world.gravity_mps2), toml_number(scene.length_scale_m));
  // The bodies stand where the scene has them, whether they touch, part or overlap.
  text += "overlaps = \"allowed\"\n\n[law]\n" + law_text(world.law);
  for (const PairLaw& pair : world.exceptions) {
    text += fmt::format("\n[[pair]]\nsurfaces = [\"{}\", \"{}\"]\n", surface_name(pair.surface_a),
                        surface_name(pair.surface_b)) +
            law_text(pair.law);
  }
  const std::set<int> surfaces = told_apart(world);
  const auto holds = [](const std::vector<std::size_t>& list, std::size_t i) {
    return std::ranges::binary_search(list, i);
  };
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const char* role = holds(scene.bricks, i)        ? "brick"
                       : holds(scene.projectiles, i) ? "projectile"
                                                     : "none";
    text += body_text(world.bodies[i], role, surfaces);
  }
  for (const Blow& blow : scene.blows) text += blow_text(blow, world);
  for (const Push& push : scene.pushes) text += push_text(push, world);
  return text;
}

}  // namespace brickbench
