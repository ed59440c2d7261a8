// Bodies of the velocity-level engine: what never changes, what does, and the laws of their
// contacts. World frame, SI; quaternions body to world.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <variant>
#include <vector>

namespace ourengine {

struct BoxGeometry {
  Eigen::Vector3d half_m;
};
struct SphereGeometry {
  double radius_m;
};
// The half space z <= 0 of the body frame; only for fixed bodies.
struct PlaneGeometry {};
using Geometry = std::variant<BoxGeometry, SphereGeometry, PlaneGeometry>;

struct BodyModel {
  Geometry geometry;
  bool fixed = false;
  double mass_kg = 1.0;                                    // unused if fixed
  Eigen::Vector3d inertia_kgm2 = Eigen::Vector3d::Ones();  // principal, body axes
  int surface = 0;                                         // row and column of SurfaceLaws
};

struct Motion {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  // Spatial: R I R^T w. Stored instead of w, so that free flight keeps it exactly.
  Eigen::Vector3d angular_momentum_kgm2ps = Eigen::Vector3d::Zero();
};

struct Load {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_nm = Eigen::Vector3d::Zero();
};

struct SurfaceLaw {
  double friction = 0.0;
  double restitution = 0.0;
};

// Symmetric table of contact laws between kinds of surface.
class SurfaceLaws {
 public:
  explicit SurfaceLaws(int kinds = 1, SurfaceLaw everywhere = {})
      : kinds_(kinds), laws_(static_cast<std::size_t>(kinds * kinds), everywhere) {}
  int kinds() const { return kinds_; }
  void set(int a, int b, SurfaceLaw law) {
    at(a, b) = law;
    at(b, a) = law;
  }
  const SurfaceLaw& operator()(int a, int b) const {
    return laws_[static_cast<std::size_t>(a * kinds_ + b)];
  }

 private:
  SurfaceLaw& at(int a, int b) { return laws_[static_cast<std::size_t>(a * kinds_ + b)]; }
  int kinds_;
  std::vector<SurfaceLaw> laws_;
};

}  // namespace ourengine
