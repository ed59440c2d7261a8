#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/record/trajectory.hpp"
#include "experiments/record/trajectory_layout.hpp"

namespace brickbench {
namespace {

using namespace hdf5;
using namespace trajectory_layout;

// The place of the text in the list.
template <std::size_t n>
std::size_t index_of(const std::array<const char*, n>& names, const std::string& text,
                     const char* what) {
  const auto found = std::ranges::find(names, text);
  if (found == names.end()) throw Hdf5Error(fmt::format("no {} '{}'", what, text));
  return static_cast<std::size_t>(found - names.begin());
}

Id open_file(const std::string& path) {
  if (H5Fis_hdf5(path.c_str()) <= 0) throw Hdf5Error("not an HDF5 file, or cut off at its start");
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "damaged or cut off"};
}

TrajectoryHeader read_header(hid_t file) {
  if (H5Aexists(file, "format") <= 0 || read_text(file, "format") != k_format) {
    throw Hdf5Error("an HDF5 file, but not a trajectory");
  }
  if (const auto version = read_count(file, "schema_version"); version != k_trajectory_schema) {
    throw Hdf5Error(
        fmt::format("schema version {}, this program reads {}", version, k_trajectory_schema));
  }
  TrajectoryHeader header;
  header.cell = read_text(file, "cell");
  header.experiment = read_text(file, "experiment");
  header.scenario = read_text(file, "scenario");
  header.axes = read_text(file, "axes");
  header.engine = read_text(file, "engine");
  header.variant = read_text(file, "variant");
  header.engine_version = read_text(file, "engine_version");
  header.revision = read_text(file, "revision");
  header.step_s = read_number(file, "step_s");
  header.duration_s = read_number(file, "duration_s");
  header.seed = read_count(file, "seed");
  header.every = read_count(file, "every");
  header.precision = static_cast<TrajectoryPrecision>(
      index_of(k_precisions, read_text(file, "precision"), "precision"));
  header.contacts = read_count(file, "contacts") != 0;
  return header;
}

// A table of the group whose sizes are these.
Id open_sized(hid_t parent, const char* name, const std::vector<hsize_t>& sizes) {
  Id table = open_table(parent, name);
  if (shape_of(table) != sizes) {
    throw Hdf5Error(fmt::format("data set '{}' has other sizes than the rest", name));
  }
  return table;
}

Shape shape_from(std::size_t kind, const double* half_m) {
  static_assert(k_shapes.size() == std::variant_size_v<Shape>);
  if (kind == 0) return BoxShape{{half_m[0], half_m[1], half_m[2]}};
  if (kind == 1) return SphereShape{half_m[0]};
  return PlaneShape{};
}

std::vector<TrajectoryBody> read_bodies(hid_t file) {
  const Id group(H5Gopen2(file, "bodies", H5P_DEFAULT), H5Gclose, "no readable group 'bodies'");
  const auto names = read_texts(group, "name");
  const auto shapes = read_texts(group, "shape");
  const auto roles = read_texts(group, "role");
  const std::size_t count = names.size();
  if (shapes.size() != count || roles.size() != count) {
    throw Hdf5Error("the lists of bodies have different lengths");
  }
  std::vector<double> sizes(3 * count);
  read_rows(open_sized(group, "half_extents", {count, 3}), H5T_NATIVE_DOUBLE, 0, count,
            sizes.data());
  std::vector<double> masses(count);
  read_rows(open_sized(group, "mass", {count}), H5T_NATIVE_DOUBLE, 0, count, masses.data());
  std::vector<TrajectoryBody> bodies;
  for (std::size_t i = 0; i < count; ++i) {
    bodies.push_back({names[i], shape_from(index_of(k_shapes, shapes[i], "shape"), &sizes[3 * i]),
                      static_cast<BodyRole>(index_of(k_roles, roles[i], "role")), masses[i]});
  }
  return bodies;
}

Eigen::Vector3d vector_at(const std::vector<double>& values, std::size_t index) {
  return {values[3 * index], values[3 * index + 1], values[3 * index + 2]};
}

}  // namespace

struct Trajectory::Impl {
  std::string file;
  Id hdf5;
  std::array<Id, 4> motion;
  Id pair;
  std::array<Id, 4> contacts;
  TrajectoryHeader header;
  TrajectoryEnd end;
  std::vector<double> times_s;
  std::vector<std::uint64_t> steps;
  std::vector<std::uint64_t> offsets;

  void open() {
    hdf5 = open_file(file);
    header = read_header(hdf5);
    header.bodies = read_bodies(hdf5);
    end = {read_text(hdf5, "outcome"), read_text(hdf5, "reason")};
    const std::uint64_t frames = read_count(hdf5, "frames");
    const Id time = open_sized(hdf5, "time", {frames});
    times_s.resize(frames);
    read_rows(time, H5T_NATIVE_DOUBLE, 0, frames, times_s.data());
    const Id step = open_sized(hdf5, "step", {frames});
    steps.resize(frames);
    read_rows(step, H5T_NATIVE_UINT64, 0, frames, steps.data());
    for (std::size_t f = 1; f < frames; ++f) {
      if (!(times_s[f] > times_s[f - 1])) {
        throw Hdf5Error(fmt::format("time {} s of frame {} does not follow {} s", times_s[f], f,
                                    times_s[f - 1]));
      }
    }
    for (std::size_t k = 0; k < k_motion.size(); ++k) {
      motion[k] =
          open_sized(hdf5, k_motion[k].name, {frames, header.bodies.size(), k_motion[k].width});
    }
    if (header.contacts) open_contacts(frames);
  }

  void open_contacts(std::uint64_t frames) {
    const Id group(H5Gopen2(hdf5, "contacts", H5P_DEFAULT), H5Gclose,
                   "no readable group 'contacts'");
    const Id offset = open_sized(group, "offset", {frames + 1});
    offsets.resize(frames + 1);
    read_rows(offset, H5T_NATIVE_UINT64, 0, frames + 1, offsets.data());
    if (offsets.front() != 0 || !std::ranges::is_sorted(offsets)) {
      throw Hdf5Error("the offsets of the contacts do not ascend from 0");
    }
    const std::uint64_t points = offsets.back();
    pair = open_sized(group, "body", {points, 2});
    for (std::size_t k = 0; k < k_contacts.size(); ++k) {
      const std::size_t width = k_contacts[k].width;
      const std::vector<hsize_t> sizes =
          width == 0 ? std::vector<hsize_t>{points} : std::vector<hsize_t>{points, width};
      contacts[k] = open_sized(group, k_contacts[k].name, sizes);
    }
  }

  void read_states(std::size_t frame, TrajectoryFrame& out) const {
    const std::size_t count = header.bodies.size();
    std::array<std::vector<double>, 4> values;
    for (std::size_t k = 0; k < motion.size(); ++k) {
      values[k].resize(count * k_motion[k].width);
      read_rows(motion[k], H5T_NATIVE_DOUBLE, frame, 1, values[k].data());
    }
    out.states.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      State& state = out.states[i];
      state.position_m = vector_at(values[0], i);
      state.orientation = Eigen::Quaterniond(values[1][4 * i], values[1][4 * i + 1],
                                             values[1][4 * i + 2], values[1][4 * i + 3]);
      state.velocity_mps = vector_at(values[2], i);
      state.angular_velocity_radps = vector_at(values[3], i);
    }
  }

  void read_contacts(std::size_t frame, TrajectoryFrame& out) const {
    const std::uint64_t start = offsets[frame];
    const std::uint64_t count = offsets[frame + 1] - start;
    std::vector<std::uint32_t> pairs(2 * count);
    read_rows(pair, H5T_NATIVE_UINT32, start, count, pairs.data());
    std::array<std::vector<double>, 4> values;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      values[k].resize(count * std::max<std::size_t>(1, k_contacts[k].width));
      read_rows(contacts[k], H5T_NATIVE_DOUBLE, start, count, values[k].data());
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (std::max(pairs[2 * i], pairs[2 * i + 1]) >= header.bodies.size()) {
        throw Hdf5Error(fmt::format("a contact of frame {} names body {} of {}", frame,
                                    std::max(pairs[2 * i], pairs[2 * i + 1]),
                                    header.bodies.size()));
      }
      out.contacts.push_back({pairs[2 * i], pairs[2 * i + 1], vector_at(values[0], i),
                              vector_at(values[1], i), values[2][i], vector_at(values[3], i)});
    }
  }

  Expected<void> guarded(const auto& call) const {
    const Silence silence;
    try {
      call();
      return {};
    } catch (const std::exception& error) {
      return fail(Fault::invalid,
                  fmt::format("{}: not a readable trajectory: {}", file, error.what()));
    }
  }
};

Trajectory::Trajectory(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Trajectory::Trajectory(Trajectory&&) noexcept = default;
Trajectory& Trajectory::operator=(Trajectory&&) noexcept = default;
Trajectory::~Trajectory() = default;

Expected<Trajectory> Trajectory::open(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) {
    return fail(Fault::invalid, fmt::format("{}: there is no such file", file.string()));
  }
  auto impl = std::make_unique<Impl>();
  impl->file = file.string();
  if (auto ok = impl->guarded([&] { impl->open(); }); !ok) return tl::unexpected(ok.error());
  return Trajectory(std::move(impl));
}

const TrajectoryHeader& Trajectory::header() const { return impl_->header; }
const TrajectoryEnd& Trajectory::end() const { return impl_->end; }
const std::vector<double>& Trajectory::times_s() const { return impl_->times_s; }
const std::vector<std::uint64_t>& Trajectory::steps() const { return impl_->steps; }

Expected<TrajectoryFrame> Trajectory::read(std::size_t frame) const {
  TrajectoryFrame out;
  out.step = impl_->steps[frame];
  out.time_s = impl_->times_s[frame];
  const auto done = impl_->guarded([&] {
    impl_->read_states(frame, out);
    if (impl_->header.contacts) impl_->read_contacts(frame, out);
  });
  if (!done) return tl::unexpected(done.error());
  return out;
}

}  // namespace brickbench
