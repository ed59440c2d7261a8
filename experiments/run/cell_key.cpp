#include <fmt/format.h>
#include <xxhash.h>

#include <cmath>

#include "experiments/record/row.hpp"
#include "experiments/run/cell.hpp"

namespace brickbench {
std::string text_of(const ParameterValue& value) {
  const auto* number = std::get_if<double>(&value);
  return number != nullptr ? shortest(*number) : std::get<std::string>(value);
}

std::uint64_t step_count(const Cell& cell) {
  return static_cast<std::uint64_t>(std::llround(cell.duration_s / cell.step_s));
}

std::string cell_key(const Cell& cell, const std::string& engine_version,
                     const std::string& revision) {
  std::string key = fmt::format(
      "schema={};revision={};experiment={};scenario={};engine={};variant={};version={};step_s={};"
      "duration_s={};time_limit_s={};seed={}",
      Schema<Row>::version, revision, cell.experiment, cell.scenario, cell.engine.engine,
      cell.engine.variant, engine_version, shortest(cell.step_s), shortest(cell.duration_s),
      shortest(cell.time_limit_s), cell.seed);
  if (cell.file_scene) key += fmt::format(";scene={}", cell.file_scene->hash);
  if (cell.seed != 0) {
    const Perturbation& p = cell.perturb;
    key += fmt::format(";perturb={},{},{},{},{}", p.distribution, shortest(p.position_m),
                       shortest(p.angle_rad), shortest(p.velocity_mps),
                       shortest(p.angular_velocity_radps));
  }
  for (const auto& [name, value] : cell.parameters) {
    key += fmt::format(";{}={}", name, text_of(value));
  }
  for (const auto& [name, value] : cell.knobs) {
    key += fmt::format(";knob.{}={}", name, shortest(value));
  }
  return key + fmt::format(";metrics={}", fmt::join(cell.metrics, ","));
}

std::string cell_id(const std::string& key) {
  const XXH128_hash_t hash = XXH3_128bits(key.data(), key.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace brickbench
