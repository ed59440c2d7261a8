#include "experiments/conformance/diagnosis.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <exception>

namespace brickbench::conformance {

Body turned_box(const Eigen::Vector3d& position_m) {
  State state;
  state.position_m = position_m;
  state.orientation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.9, Eigen::Vector3d(1, 2, 3).normalized()));
  return solid_body("turned box", BoxShape{{0.15, 0.1, 0.05}}, 2000.0, state);
}

Eigen::Matrix3d world_inertia_of(const Body& body, const Eigen::Quaterniond& orientation) {
  const Eigen::Matrix3d turn = orientation.toRotationMatrix();
  return turn * body.inertia_kgm2.asDiagonal() * turn.transpose();
}

Symptoms diagnose(const Subject& subject) {
  Symptoms all;
  for (const auto& kind : {motion_symptoms, push_symptoms, contact_symptoms, setting_symptoms}) {
    try {
      for (const std::string& words : kind(subject)) {
        if (std::ranges::find(all, words) == all.end()) all.push_back(words);
      }
    } catch (const Stop& stop) {
      if (stop.verdict.outcome == Outcome::failed &&
          std::ranges::find(all, stop.verdict.detail) == all.end()) {
        all.push_back(stop.verdict.detail);
      }
    } catch (const std::exception& error) {
      all.push_back(fmt::format("an exception left the engine: {}", error.what()));
    }
    // What moves or is read wrongly in free flight spoils every reading after it.
    if (kind == motion_symptoms && !all.empty()) break;
  }
  return all;
}

}  // namespace brickbench::conformance
