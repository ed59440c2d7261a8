#include "experiments/exact/sketch/sketch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adapters/seam/shape.hpp"
#include "experiments/exact/sketch/sketch_view.hpp"
#include "experiments/record/markup.hpp"
#include "experiments/step/stepper.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double k_width_px = 720.0;
constexpr double k_stage_px = 230.0;  // height of the drawing; the caption is below
constexpr double k_margin_px = 46.0;
constexpr double k_arrow_px = 70.0;  // of the fastest body, the largest force, gravity
constexpr const char* k_body = "#3b82c4";
constexpr const char* k_fixed = "#8a929b";
constexpr const char* k_motion = "#d5661a";
constexpr const char* k_force = "#199a74";
constexpr const char* k_text = "#7d8590";
// Paths further away than this many times the largest body do not shrink the drawing.
constexpr double k_path_sizes = 6.0;
// With more moving bodies than this only velocities are drawn, and the fastest is named below.
constexpr int k_labelled_bodies = 5;

std::string number(double value) { return fmt::format("{:.3g}", value); }

class Drawing {
 public:
  Drawing(std::string title, bool contacts, const ExactRun& run)
      : title_(escape_markup(title)), contacts_(contacts), run_(run), view_(choose_view(run)) {
    crowded_ = std::ranges::count(run.world.bodies, false, &Body::fixed) > k_labelled_bodies;
    fit();
  }

  std::string svg() {
    defs();
    for (const Body& body : run_.world.bodies) {
      if (body.fixed) draw(body, k_fixed);
    }
    paths();
    for (const Body& body : run_.world.bodies) {
      if (!body.fixed) draw(body, k_body);
    }
    for (std::size_t i = 0; i < run_.world.bodies.size(); ++i) {
      if (!run_.world.bodies[i].fixed) arrows(i);
    }
    gravity();
    scale_bar();
    caption();
    return out_ + "</svg>\n";
  }

 private:
  template <typename... Values>
  void put(fmt::format_string<Values...> text, Values&&... values) {
    out_ += fmt::format(text, std::forward<Values>(values)...) + '\n';
  }

  std::vector<Vector3d> exact_path(std::size_t body) const {
    std::vector<Vector3d> path;
    if (!run_.trajectory) return path;
    constexpr int k_points = 120;
    std::vector<State> states;
    for (const Body& b : run_.world.bodies) states.push_back(b.initial);
    for (int k = 0; k <= k_points; ++k) {
      run_.trajectory(k * static_cast<double>(run_.steps) * run_.step_s / k_points, states);
      path.push_back(states[body].position_m);
    }
    return path;
  }

  void fit() {
    double largest = 0.0;
    Vector3d centre = Vector3d::Zero();  // of the last moving body
    for (const Body& body : run_.world.bodies) {
      if (body.fixed) continue;
      largest = std::max(largest, size_of(body.shape));
      centre = body.initial.position_m;
    }
    Vector2d low = Vector2d::Constant(1e300), high = -low;
    const auto see = [&](const Vector2d& p, double radius) {
      low = low.cwiseMin(p - Vector2d::Constant(radius));
      high = high.cwiseMax(p + Vector2d::Constant(radius));
    };
    for (std::size_t i = 0; i < run_.world.bodies.size(); ++i) {
      const Body& body = run_.world.bodies[i];
      const double size = size_of(body.shape);
      const bool backdrop = body.fixed && (size == 0.0 || size > 4.0 * largest);
      if (backdrop) {
        const Vector3d foot = nearest(body, centre);
        if ((foot - centre).norm() < 2.0 * k_path_sizes * largest) see(view_.flat(foot), 0.0);
        continue;
      }
      by_shape(
          body.shape,
          [&](const BoxShape& box) {
            for (const Vector3d& corner : corners(box, body.initial)) see(view_.flat(corner), 0.0);
          },
          [&](const SphereShape&) { see(view_.flat(body.initial.position_m), size); },
          [&](const PlaneShape&) { see(view_.flat(body.initial.position_m), size); });
      if (body.fixed) continue;
      const Vector2d start = view_.flat(body.initial.position_m);
      for (const Vector3d& at : exact_path(i)) {
        if ((view_.flat(at) - start).norm() < k_path_sizes * largest) see(view_.flat(at), size / 4);
      }
    }
    const Vector2d size = (high - low).cwiseMax(Vector2d::Constant(1e-6));
    scale_ = std::min((k_width_px - 4.0 * k_margin_px) / size.x(),
                      (k_stage_px - 2.0 * k_margin_px) / size.y());
    middle_ = 0.5 * (low + high);
  }

  Vector2d px(const Vector2d& p) const {
    const Vector2d off = scale_ * (p - middle_);
    return {0.5 * k_width_px + off.x(), 0.5 * k_stage_px - off.y()};
  }
  Vector2d px(const Vector3d& p) const { return px(view_.flat(p)); }

  void defs() {
    put("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
        "height=\"{1}\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\">",
        k_width_px, k_stage_px + 40.0);
    put("<title>{}: the start, seen along {}</title>", title_, "xyz"[view_.across()]);
    put("<defs><clipPath id=\"stage\"><rect width=\"{}\" height=\"{}\"/></clipPath>", k_width_px,
        k_stage_px);
    for (const char* colour : {k_motion, k_force, k_text}) {
      put("<marker id=\"tip{}\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"7\" "
          "markerHeight=\"7\" orient=\"auto\"><path d=\"M0 0.5 L8 4 L0 7.5 z\" fill=\"{}\"/>"
          "</marker>",
          colour + 1, colour);
    }
    put("</defs>");
  }

  void draw(const Body& body, const char* colour) {
    const State& s = body.initial;
    by_shape(
        body.shape, [&](const BoxShape& box) { faces(box, s, colour); },
        [&](const SphereShape& ball) { circle(ball, s, colour); },
        [&](const PlaneShape&) { ground(s, colour); });
    if (body.fixed) return;
    const Vector2d at = px(s.position_m);
    put("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"{}\"/>", at.x(), at.y(), colour);
  }

  void circle(const SphereShape& ball, const State& state, const char* colour) {
    const Vector2d at = px(state.position_m);
    put("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\" fill-opacity=\"0.18\" "
        "stroke=\"{}\" stroke-width=\"1.5\"/>",
        at.x(), at.y(), scale_ * ball.radius_m, colour, colour);
  }

  // The faces that look at the viewer.
  void faces(const BoxShape& box, const State& state, const char* colour) {
    const auto points = corners(box, state);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        const Vector3d normal = state.orientation * Vector3d(sign * Vector3d::Unit(axis));
        if (view_.toward() * normal[view_.across()] < 1e-9) continue;
        const std::size_t u = std::size_t{1} << ((axis + 1) % 3);
        const std::size_t v = std::size_t{1} << ((axis + 2) % 3);
        const std::size_t base = sign > 0.0 ? std::size_t{1} << axis : 0;
        std::string path;
        for (const std::size_t i : {base, base + u, base + u + v, base + v}) {
          const Vector2d p = px(points[i]);
          path += fmt::format("{}{:.1f} {:.1f} ", path.empty() ? 'M' : 'L', p.x(), p.y());
        }
        put("<path d=\"{}z\" fill=\"{}\" fill-opacity=\"0.18\" stroke=\"{}\" stroke-width=\"1.5\" "
            "stroke-linejoin=\"round\" clip-path=\"url(#stage)\"/>",
            path, colour, colour);
      }
    }
  }

  // A plane seen from its side: a line, hatched below.
  void ground(const State& state, const char* colour) {
    const Vector2d normal = view_.flat(state.orientation * Vector3d::UnitZ());
    if (normal.norm() < 0.5) return;
    const Vector2d along(normal.y(), normal.x());  // in pixels: y points down
    const Vector2d off = middle_ - view_.flat(state.position_m);
    const Vector2d on = px(Vector2d(middle_ - normal.dot(off) * normal));
    const Vector2d from = on - k_width_px * along, to = on + k_width_px * along;
    put("<g clip-path=\"url(#stage)\" stroke=\"{}\" stroke-width=\"1.5\"><line x1=\"{:.1f}\" "
        "y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>",
        colour, from.x(), from.y(), to.x(), to.y());
    std::string hatch;
    const Vector2d down(-normal.x(), normal.y());
    for (double t = -k_width_px; t < k_width_px; t += 14.0) {
      const Vector2d a = on + t * along, b = a + 9.0 * (down - along);
      hatch += fmt::format("M{:.1f} {:.1f} L{:.1f} {:.1f} ", a.x(), a.y(), b.x(), b.y());
    }
    put("<path d=\"{}\" stroke-width=\"0.7\"/></g>", hatch);
  }

  void paths() {
    for (std::size_t i = 0; i < run_.world.bodies.size(); ++i) {
      if (run_.world.bodies[i].fixed) continue;
      const auto path = exact_path(i);
      const bool moves = std::ranges::any_of(
          path, [&](const Vector3d& p) { return (px(p) - px(path.front())).norm() > 2.0; });
      if (!moves) continue;
      shows_path_ = true;
      std::string text;
      for (const Vector3d& p : path) {
        const Vector2d at = px(p);
        text += fmt::format("{}{:.1f} {:.1f} ", text.empty() ? 'M' : 'L', at.x(), at.y());
      }
      put("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.2\" stroke-dasharray=\"4 "
          "4\" clip-path=\"url(#stage)\"/>",
          text, k_body);
    }
  }

  void arrow(const Vector2d& from, const Vector2d& along_px, const char* colour,
             const std::string& text) {
    const Vector2d to = from + along_px;
    put("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
        "stroke-width=\"2\" marker-end=\"url(#tip{})\"/>",
        from.x(), from.y(), to.x(), to.y(), colour, colour + 1);
    if (std::abs(along_px.x()) >= std::abs(along_px.y())) {
      label(from + 0.5 * along_px - Vector2d(0.0, 7.0), text, colour, "middle");
    } else {
      label(from + 0.6 * along_px + Vector2d(7.0, 4.0), text, colour);
    }
  }

  void label(Vector2d at, const std::string& text, const char* colour,
             const char* anchor = "start") {
    at.y() = std::clamp(at.y(), 12.0, k_stage_px - 4.0);
    put("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\" text-anchor=\"{}\">{}</text>", at.x(), at.y(),
        colour, anchor, text);
  }

  double fastest() const {
    double speed = 0.0;
    for (const Body& body : run_.world.bodies) {
      speed = std::max(speed, view_.flat(body.initial.velocity_mps).norm());
    }
    return speed;
  }

  void arrows(std::size_t i) {
    const Body& body = run_.world.bodies[i];
    const Vector2d at = px(body.initial.position_m);
    const Vector2d v = view_.flat(body.initial.velocity_mps);
    if (v.norm() > 1e-9) {
      const double length = std::max(18.0, k_arrow_px * v.norm() / fastest());
      arrow(at, length * Vector2d(v.x(), -v.y()) / v.norm(), k_motion,
            crowded_ ? "" : number(body.initial.velocity_mps.norm()) + " m/s");
    }
    if (!crowded_)
      turn(at, size_of(body.shape), body.initial.angular_velocity_radps, k_motion, "rad/s");
    const auto [load, time_s] = shown_load(run_, i);
    const Vector2d f = view_.flat(load.force_n);
    if (f.norm() > 1e-9) {
      const Vector2d along = k_arrow_px * Vector2d(f.x(), -f.y()) / f.norm();
      arrow(at, along, k_force, "");
      if (crowded_) return;
      label(at + 1.1 * along + Vector2d(0.0, 4.0),
            fmt::format("{} N at {} s", number(load.force_n.norm()), number(time_s)), k_force,
            along.x() < -1.0 ? "end" : "start");
    }
    if (crowded_) return;
    turn(at, size_of(body.shape), load.torque_nm, k_force, "N m");
  }

  // A spin or torque: an arc where it turns in the plane of the page, else an arrow along its axis.
  void turn(const Vector2d& at, double size_m, const Vector3d& axis, const char* colour,
            const char* unit) {
    if (axis.norm() < 1e-9) return;
    const std::string text = number(axis.norm()) + ' ' + unit;
    const double out = view_.toward() * axis[view_.across()];
    const Vector2d flat = view_.flat(axis);
    if (std::abs(out) < flat.norm()) {
      arrow(at, 0.7 * k_arrow_px * Vector2d(flat.x(), -flat.y()) / flat.norm(), colour,
            text + " about this axis");
      return;
    }
    const double r = std::clamp(0.6 * scale_ * size_m, 10.0, 60.0);
    const double a = 0.75 * std::numbers::pi;
    const Vector2d left = at + r * Vector2d(std::cos(a), -std::sin(a));
    const Vector2d right = at + r * Vector2d(-std::cos(a), -std::sin(a));
    const Vector2d& from = out > 0.0 ? right : left;
    const Vector2d& to = out > 0.0 ? left : right;
    put("<path d=\"M{:.1f} {:.1f} A{:.1f} {:.1f} 0 0 {} {:.1f} {:.1f}\" fill=\"none\" "
        "stroke=\"{}\" stroke-width=\"2\" marker-end=\"url(#tip{})\"/>",
        from.x(), from.y(), r, r, out > 0.0 ? 0 : 1, to.x(), to.y(), colour, colour + 1);
    label({right.x() + 8.0, right.y() - 2.0}, text, colour);
  }

  void gravity() {
    const Vector3d& g = run_.world.gravity_mps2;
    const Vector2d flat = view_.flat(g);
    if (flat.norm() < 1e-9) return;
    const Vector2d from(k_width_px - 70.0, 14.0);
    const double tilt_deg =
        std::acos(std::clamp(-g.z() / g.norm(), -1.0, 1.0)) * 180.0 / std::numbers::pi;
    std::string text = "g";
    if (tilt_deg > 0.01) text += fmt::format(", {}° off the normal", number(tilt_deg));
    const Vector2d along = 46.0 * Vector2d(flat.x(), -flat.y()) / flat.norm();
    put("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
        "stroke-width=\"1.5\" marker-end=\"url(#tip{})\"/>",
        from.x(), from.y(), from.x() + along.x(), from.y() + along.y(), k_text, k_text + 1);
    label({from.x() - 8.0, 18.0}, text, k_text, "end");
  }

  // 1, 2 or 5 times a power of ten, some 100 pixels long.
  void scale_bar() {
    const double wanted_m = 110.0 / scale_;
    const double decade = std::pow(10.0, std::floor(std::log10(wanted_m)));
    const double lead = wanted_m / decade;
    const double bar_m = decade * (lead >= 5.0 ? 5.0 : lead >= 2.0 ? 2.0 : 1.0);
    const double y = 14.0;
    put("<path d=\"M14 {0} h{1:.1f} m0 -4 v8 M14 {2} v8\" stroke=\"{3}\" fill=\"none\"/>", y,
        bar_m * scale_, y - 4.0, k_text);
    label({14.0 + bar_m * scale_ + 6.0, y + 4.0}, number(bar_m) + " m", k_text);
  }

  static std::string describe(const Body& body) {
    std::string text = escape_markup(body.name) + ": ";
    text += by_shape(
        body.shape,
        [](const BoxShape& box) {
          const Vector3d full = 2.0 * box.half_extents_m;
          return number(full.x()) + " × " + number(full.y()) + " × " + number(full.z()) + " m";
        },
        [](const SphereShape& ball) { return "radius " + number(ball.radius_m) + " m"; },
        [](const PlaneShape&) { return std::string(); });
    if (!body.fixed) text += ", " + number(body.mass_kg) + " kg";
    return text;
  }

  void caption() {
    std::vector<const Body*> moving;
    for (const Body& body : run_.world.bodies) {
      if (!body.fixed) moving.push_back(&body);
    }
    std::string first;
    for (std::size_t i = 0; i < std::min<std::size_t>(moving.size(), 2); ++i) {
      first += (i > 0 ? "; " : "") + describe(*moving[i]);
    }
    if (moving.size() > 2) first += fmt::format("; and {} more", moving.size() - 2);
    std::string second = fmt::format("Seen along {}.", "xyz"[view_.across()]);
    if (contacts_) {
      second += fmt::format(" Friction {}, restitution {}{}.", number(run_.world.law.friction),
                            number(run_.world.law.restitution),
                            run_.world.exceptions.empty() ? "" : ", other laws for some pairs");
    }
    if (crowded_ && fastest() > 0.0) second += " Up to " + number(fastest()) + " m/s.";
    if (shows_path_) second += " Dashed: the exact path.";
    label_below(k_stage_px + 16.0, first);
    label_below(k_stage_px + 33.0, second);
  }

  void label_below(double y, const std::string& text) {
    put("<text x=\"14\" y=\"{:.1f}\" fill=\"{}\">{}</text>", y, k_text, text);
  }

  std::string title_;
  bool contacts_;
  const ExactRun& run_;
  SketchView view_;
  double scale_ = 1.0;  // pixels per metre
  Vector2d middle_ = Vector2d::Zero();
  bool shows_path_ = false;
  bool crowded_ = false;  // no room for labels at each body
  std::string out_;
};

}  // namespace

std::string sketch_svg(const ExactCase& exact_case, const ExactRun& run) {
  return Drawing(exact_case.id, exact_case.needs.contacts != Contacts::none, run).svg();
}

std::string sketch_svg(const std::string& title, double duration_s, const Scene& scene) {
  constexpr std::size_t k_steps = 1000;
  ExactRun run;
  run.world = scene.world;
  run.steps = k_steps;
  run.step_s = duration_s / static_cast<double>(k_steps);
  if (!scene.blows.empty() || !scene.pushes.empty()) {
    std::vector<State> states;
    for (const Body& body : scene.world.bodies) states.push_back(body.initial);
    run.load = [&scene, states, step_s = run.step_s](std::size_t step, double,
                                                     std::span<Wrench> wrenches) {
      add_outer_wrenches(scene, step_s, step, states, wrenches);
    };
  }
  return Drawing(title, scene.world.bodies.size() > 1, run).svg();
}

}  // namespace brickbench::exact
