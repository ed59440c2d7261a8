// Bodies that passed one another between two recorded poses: docs/metrics.md, section validity.
//
// Of a body A its centre is followed, in the frame of the other body B. The ball inscribed in A, of
// radius a, belongs to A, so a centre nearer to B than a means an overlap. A has passed B if
//   * it was clear of B (no nearer than a / 2) before and after, and the straight way between the
//     two poses comes nearer than a / 4: A cannot have gone round, because the distance to a convex
//     body is convex along a line, and two poses in front of one face stay in front of it; or
//   * it was clear of B and is now deeper in B than a, so that its whole ball has passed B's
//     surface: what has sunk into the ground is on its far side.
// Both bodies of a pair take either part. Way means a straight line of the centres and a turn of B
// at constant rate; where B turns by more than a radian per step the poses do not say which way,
// and the ball inscribed in B stands for B. Bodies that slide past each other, roll over edges or
// graze corners stay clear: a quarter turn about an edge cuts it by 0.29 a.
//
// Poses are looked at whenever a body has moved by a share of the smallest inscribed radius of all
// that move, and a world at rest costs one comparison per body.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "adapters/seam/world.hpp"

namespace brickbench {

struct Passage {
  std::size_t body = 0;
  std::size_t through = 0;
};

class Passages {
 public:
  Passages(const World& world, double step_s);
  // (bodies), finite; the first call shows the initial states, the others those after each step.
  // The passages that this step completed; valid until the next call.
  const std::vector<Passage>& observe(std::span<const State> states);

 private:
  // What a body is to others: its inscribed and its circumscribed ball, and its shape.
  struct Solid {
    enum class Kind { box, sphere, plane } kind = Kind::sphere;
    Eigen::Vector3d half_m = Eigen::Vector3d::Zero();
    double inner_m = 0.0;
    double outer_m = 0.0;
    bool fixed = false;
    double gap_m(const Eigen::Vector3d& point_m, bool ball) const;
  };
  // Where a body was last seen clear of another, in the other's frame, while it no longer is.
  struct Inside {
    std::optional<Eigen::Vector3d> clear_m;  // none: the run began so
    bool told = false;
  };
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  // body, and what it may pass

  static Solid solid_of(const Body& body);
  bool has_moved(std::span<const State> states) const;
  double turn_rad(std::size_t body) const;
  void bound(std::size_t body);
  void look();
  void sweep();
  void look_at(std::uint32_t a, std::uint32_t b);
  void look_one_way(std::uint32_t a, std::uint32_t b);
  void settle(std::uint32_t a, std::uint32_t b, const Eigen::Vector3d& now_m, Inside& inside);
  bool crosses(std::uint32_t a, std::uint32_t b) const;

  double step_s_;
  std::vector<Shape> shapes_;
  std::vector<Solid> solids_;
  double least_m_ = 0.0;  // smallest inscribed radius of what moves
  std::vector<std::uint32_t> planes_;
  std::vector<std::uint32_t> order_;  // bodies but planes, along the sweep axis
  std::vector<State> seen_;           // when last looked at
  std::vector<State> now_;
  std::vector<double> spin_radps_;  // the fastest since last looked at
  // (bodies) Bounds along the world axes of the way of a body, and of that of its centre with as
  // much around it as is still clear.
  struct Bounds {
    Eigen::Vector3d low_m;
    Eigen::Vector3d high_m;
    bool meets(const Bounds& other) const;
  };
  std::vector<Bounds> ways_;
  std::vector<Bounds> centers_;
  Eigen::Index axis_ = -1;
  std::map<Pair, Inside> inside_;
  std::vector<Passage> passages_;
};

}  // namespace brickbench
