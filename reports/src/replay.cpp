#include "reports/src/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/src/base64.hpp"

namespace brickbench {
namespace {

// Values rounded to a lattice, one channel of all bodies: (bodies, frames).
class Planes {
 public:
  explicit Planes(std::size_t words) { words_.reserve(words); }

  void add(double lattice_point) {
    const auto now = static_cast<std::int64_t>(
        std::llround(std::clamp(lattice_point, -1073741823.0, 1073741823.0)));
    const auto step = static_cast<std::int32_t>(now - before_);
    words_.push_back((static_cast<std::uint32_t>(step) << 1) ^
                     static_cast<std::uint32_t>(step >> 31));
    before_ = now;
  }
  void restart() { before_ = 0; }

  std::vector<std::uint8_t> bytes() const {
    std::vector<std::uint8_t> out;
    out.reserve(4 * words_.size());
    for (unsigned plane = 0; plane < 4; ++plane) {
      for (const std::uint32_t word : words_) {
        out.push_back(static_cast<std::uint8_t>(word >> (8 * plane) & 255U));
      }
    }
    return out;
  }

 private:
  std::vector<std::uint32_t> words_;
  std::int64_t before_ = 0;
};

// One factor +-1 per frame that keeps a body's quaternion on one side.
std::vector<double> signs(const Replay& replay, std::size_t body) {
  const std::size_t n = replay.bodies.size();
  std::vector<double> out(replay.times_s.size(), 1.0);
  for (std::size_t f = 1; f < out.size(); ++f) {
    double dot = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      dot += replay.orientations[4 * ((f - 1) * n + body) + k] *
             replay.orientations[4 * (f * n + body) + k];
    }
    out[f] = dot < 0.0 ? -out[f - 1] : out[f - 1];
  }
  return out;
}

std::string encoded(const Replay& replay) {
  const std::size_t frames = replay.times_s.size();
  const std::size_t n = replay.bodies.size();
  Planes planes(frames * n * 8);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t b = 0; b < n; ++b) {
      planes.restart();
      for (std::size_t f = 0; f < frames; ++f) {
        planes.add(replay.positions_m[3 * (f * n + b) + k] / k_position_lattice_m);
      }
    }
  }
  for (std::size_t b = 0; b < n; ++b) {
    const std::vector<double> sign = signs(replay, b);
    for (std::size_t k = 0; k < 4; ++k) {
      planes.restart();
      for (std::size_t f = 0; f < frames; ++f) {
        planes.add(sign[f] * replay.orientations[4 * (f * n + b) + k] / k_quaternion_lattice);
      }
    }
  }
  for (std::size_t b = 0; b < n && !replay.penetrations_m.empty(); ++b) {
    planes.restart();
    for (std::size_t f = 0; f < frames; ++f) {
      planes.add(replay.penetrations_m[f * n + b] / k_penetration_lattice_m);
    }
  }
  return to_base64(deflate_raw(planes.bytes()));
}

// The points of a frame on the lattice, each once.
std::vector<std::array<double, 3>> lattice_points(const Replay& replay, std::size_t frame) {
  std::vector<std::array<double, 3>> points;
  for (std::size_t i = replay.contact_offsets[frame]; i < replay.contact_offsets[frame + 1]; ++i) {
    std::array<double, 3> point{};
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = std::round(replay.contact_points_m[3 * i + k] / k_contact_lattice_m);
    }
    points.push_back(point);
  }
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::string encoded_contacts(const Replay& replay, std::size_t stride) {
  std::vector<std::vector<std::array<double, 3>>> frames(replay.times_s.size());
  for (std::size_t f = 0; f < frames.size(); f += stride) frames[f] = lattice_points(replay, f);
  Planes planes(frames.size() + replay.contact_points_m.size() / stride);
  for (const auto& points : frames) planes.add(static_cast<double>(points.size()));
  for (std::size_t k = 0; k < 3; ++k) {
    planes.restart();
    for (const auto& points : frames) {
      for (const auto& point : points) planes.add(point[k]);
    }
  }
  return to_base64(deflate_raw(planes.bytes()));
}

}  // namespace

std::size_t frames_within_page(std::size_t bodies, std::size_t wanted) {
  const std::size_t fit = k_page_body_frames / std::max<std::size_t>(1, bodies);
  return std::min(wanted, std::max(fit, k_fewest_frames));
}

Expected<void> check(const Replay& replay) {
  const std::size_t n = replay.bodies.size();
  const std::size_t frames = replay.times_s.size();
  const auto wrong = [&](const std::string& reason) {
    return fail(Fault::invalid,
                fmt::format("replay of {} in '{}': {}", replay.engine, replay.scene, reason));
  };
  if (n == 0 || frames == 0) return wrong("no bodies or no frames");
  if (replay.positions_m.size() != 3 * n * frames || replay.orientations.size() != 4 * n * frames ||
      (!replay.penetrations_m.empty() && replay.penetrations_m.size() != n * frames)) {
    return wrong(fmt::format("{} positions and {} orientations for {} bodies and {} frames",
                             replay.positions_m.size() / 3, replay.orientations.size() / 4, n,
                             frames));
  }
  for (std::size_t f = 1; f < frames; ++f) {
    if (!(replay.times_s[f] > replay.times_s[f - 1])) {
      return wrong(fmt::format("time {} s of frame {} does not follow {} s", replay.times_s[f], f,
                               replay.times_s[f - 1]));
    }
  }
  const auto finite = [](const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  if (!replay.contact_offsets.empty() &&
      (replay.contact_offsets.size() != frames + 1 ||
       replay.contact_points_m.size() != 3 * replay.contact_offsets.back() ||
       !std::ranges::is_sorted(replay.contact_offsets))) {
    return wrong("the lists of contact points do not fit the frames");
  }
  if (!finite(replay.contact_points_m) || !finite(replay.times_s) || !finite(replay.positions_m) ||
      !finite(replay.orientations) || !finite(replay.penetrations_m)) {
    return wrong("a number that is not finite");
  }
  return {};
}

Replay thinned(const Replay& replay, std::size_t frames) {
  const std::size_t all = replay.times_s.size();
  if (all <= frames || frames < 2) return replay;
  Replay out{.scene = replay.scene,
             .engine = replay.engine,
             .cell = replay.cell,
             .bodies = replay.bodies,
             .times_s = {},
             .positions_m = {},
             .orientations = {},
             .penetrations_m = {},
             .contact_offsets = {},
             .contact_points_m = {},
             .note = replay.note,
             .flagged_from_s = replay.flagged_from_s,
             .recorded_frames = replay.recorded_frames};
  if (!replay.contact_offsets.empty()) out.contact_offsets = {0};
  const std::size_t n = replay.bodies.size();
  const auto copy = [](const std::vector<double>& from, std::size_t at, std::size_t width,
                       std::vector<double>& to) {
    if (from.empty()) return;
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(at * width);
    to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(width));
  };
  for (std::size_t i = 0; i < frames; ++i) {
    const std::size_t f = (i * (all - 1) + (frames - 1) / 2) / (frames - 1);
    out.times_s.push_back(replay.times_s[f]);
    copy(replay.positions_m, f, 3 * n, out.positions_m);
    copy(replay.orientations, f, 4 * n, out.orientations);
    copy(replay.penetrations_m, f, n, out.penetrations_m);
    if (replay.contact_offsets.empty()) continue;
    for (std::size_t i = replay.contact_offsets[f]; i < replay.contact_offsets[f + 1]; ++i) {
      copy(replay.contact_points_m, i, 3, out.contact_points_m);
    }
    out.contact_offsets.push_back(out.contact_points_m.size() / 3);
  }
  return out;
}

nlohmann::ordered_json to_json(const Replay& replay, std::size_t contact_stride) {
  auto times = nlohmann::ordered_json::array();
  for (const double time_s : replay.times_s) {
    times.push_back(std::stod(fmt::format("{:.7g}", time_s)));
  }
  nlohmann::ordered_json json = {{"engine", replay.engine},
                                 {"cell", replay.cell},
                                 {"times", times},
                                 {"position_lattice", k_position_lattice_m},
                                 {"quaternion_lattice", k_quaternion_lattice},
                                 {"penetration_lattice", k_penetration_lattice_m},
                                 {"has_penetration", !replay.penetrations_m.empty()},
                                 {"data", encoded(replay)}};
  if (!replay.note.empty()) json["note"] = replay.note;
  if (replay.flagged_from_s) json["flagged_from"] = *replay.flagged_from_s;
  if (!replay.contact_offsets.empty()) {
    json["contact_lattice"] = k_contact_lattice_m;
    json["contact_stride"] = contact_stride;
    json["contacts"] = encoded_contacts(replay, contact_stride);
  }
  return json;
}

nlohmann::ordered_json bodies_json(const std::vector<ReplayBody>& bodies) {
  constexpr std::array shapes = {"box", "sphere", "plane"};
  constexpr std::array roles = {"brick", "projectile", "fixed"};
  auto array = nlohmann::ordered_json::array();
  for (const ReplayBody& body : bodies) {
    array.push_back({{"name", body.name},
                     {"shape", shapes[static_cast<std::size_t>(body.shape)]},
                     {"role", roles[static_cast<std::size_t>(body.role)]},
                     {"half", body.half_extents_m}});
  }
  return array;
}

}  // namespace brickbench
