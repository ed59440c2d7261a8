#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "adapters/seam/shape.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/hdf5_forgiving_file.hpp"
#include "experiments/record/trajectory.hpp"
#include "experiments/record/trajectory_layout.hpp"

namespace brickbench {
namespace {

using namespace hdf5;
using namespace trajectory_layout;

constexpr std::size_t k_chunk_bytes = std::size_t{1} << 18U;
constexpr std::size_t k_most_chunk_frames = 256;
constexpr std::size_t k_contact_chunk = 4096;  // points

// Frames in a chunk: about a quarter of a megabyte of positions.
std::size_t chunk_frames(std::size_t bodies) {
  const std::size_t row = std::max<std::size_t>(1, bodies) * 3 * sizeof(double);
  return std::clamp<std::size_t>(k_chunk_bytes / row, 1, k_most_chunk_frames);
}

// A three-dimensional table (frames, bodies, width); HDF5's create_table() for rank 3.
Id create_motion(hid_t file, const Quantity& quantity, hid_t type, std::size_t bodies) {
  const std::array<hsize_t, 3> none = {0, bodies, quantity.width};
  const std::array<hsize_t, 3> most = {H5S_UNLIMITED, bodies, quantity.width};
  const std::array<hsize_t, 3> chunk = {chunk_frames(bodies), bodies, quantity.width};
  const Id space(H5Screate_simple(3, none.data(), most.data()), H5Sclose, quantity.name);
  const Id list = table_properties(3, chunk.data());
  return {H5Dcreate2(file, quantity.name, type, space, H5P_DEFAULT, list, H5P_DEFAULT), H5Dclose,
          quantity.name};
}

void describe(hid_t table, const Quantity& quantity) {
  write_attribute(table, "unit", std::string(quantity.unit));
  write_attribute(table, "meaning", std::string(quantity.meaning));
}

Id create_group(hid_t parent, const char* name) {
  const Id list(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, name);
  check(H5Pset_obj_track_times(list, false), name);
  return {H5Gcreate2(parent, name, H5P_DEFAULT, list, H5P_DEFAULT), H5Gclose, name};
}

// The newest format that HDF5 1.10 writes: its metadata carry checksums.
Id create_file(const std::string& path, int* disk_error) {
  const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file access");
  use_forgiving_file(access, disk_error);
  check(H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110), "file format");
  const Id creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "file creation");
  check(H5Pset_obj_track_times(creation, false), "file creation");
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose, "cannot create"};
}

void write_header(hid_t file, const TrajectoryHeader& header) {
  write_attribute(file, "format", std::string(k_format));
  write_attribute(file, "schema_version", std::uint64_t{k_trajectory_schema});
  write_attribute(file, "frame", std::string("world frame: right-handed, z up; SI units"));
  write_attribute(file, "cell", header.cell);
  write_attribute(file, "experiment", header.experiment);
  write_attribute(file, "scenario", header.scenario);
  write_attribute(file, "axes", header.axes);
  write_attribute(file, "engine", header.engine);
  write_attribute(file, "variant", header.variant);
  write_attribute(file, "engine_version", header.engine_version);
  write_attribute(file, "revision", header.revision);
  write_attribute(file, "step_s", header.step_s);
  write_attribute(file, "duration_s", header.duration_s);
  write_attribute(file, "seed", header.seed);
  write_attribute(file, "every", header.every);
  write_attribute(file, "precision",
                  std::string(k_precisions[static_cast<std::size_t>(header.precision)]));
  write_attribute(file, "contacts", std::uint64_t{header.contacts ? 1U : 0U});
}

// What has no end is written as 0.
Eigen::Vector3d written_half_extents_m(const Shape& shape) {
  return is_half_space(shape) ? Eigen::Vector3d::Zero().eval() : half_extents_m(shape);
}

void write_bodies(hid_t file, const std::vector<TrajectoryBody>& bodies) {
  const Id group = create_group(file, "bodies");
  std::vector<std::string> names;
  std::vector<std::string> shapes;
  std::vector<std::string> roles;
  std::vector<double> sizes;
  std::vector<double> masses;
  std::vector<std::uint8_t> fixed;
  for (const TrajectoryBody& body : bodies) {
    names.push_back(body.name);
    shapes.emplace_back(shape_word(body.shape));
    roles.emplace_back(k_roles[static_cast<std::size_t>(body.role)]);
    for (const double half_m : written_half_extents_m(body.shape)) sizes.push_back(half_m);
    masses.push_back(body.mass_kg);
    fixed.push_back(body.role == BodyRole::fixed ? 1 : 0);
  }
  write_texts(group, "name", names);
  write_texts(group, "shape", shapes);
  write_texts(group, "role", roles);
  const std::size_t rows = std::clamp<std::size_t>(bodies.size(), 1, 1024);
  const auto put = [&](const char* name, hid_t file_type, hid_t type, std::size_t width,
                       const void* values, const char* unit, const char* meaning) {
    const Id table = create_table(group, name, file_type, width, rows);
    describe(table, {name, width, unit, meaning});
    append_rows(table, type, 0, bodies.size(), values);
  };
  put("half_extents", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 3, sizes.data(), "m",
      "box: along the body axes; sphere: its radius three times; plane: zeros");
  put("mass", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 0, masses.data(), "kg", "0 for fixed bodies");
  put("fixed", H5T_STD_U8LE, H5T_NATIVE_UINT8, 0, fixed.data(), "1", "1: never moves");
}

template <std::size_t n>
void push(std::vector<double>& to, const Eigen::Matrix<double, n, 1>& from) {
  to.insert(to.end(), from.data(), from.data() + n);
}

}  // namespace

struct TrajectoryWriter::Impl {
  std::filesystem::path file;
  std::filesystem::path temporary;
  TrajectoryHeader header;
  std::size_t chunk = 1;
  Id hdf5;
  Id time;
  Id step;
  std::array<Id, 4> motion;
  Id offset;
  Id pair;
  std::array<Id, 4> contacts;
  bool failed = false;
  int disk_error = 0;  // errno; outlives `hdf5`

  std::uint64_t frames = 0;  // on their way to the disk
  std::uint64_t points = 0;
  std::vector<double> times_s;  // from here on: waiting
  std::vector<std::uint64_t> steps;
  std::array<std::vector<double>, 4> moving;
  std::vector<std::uint64_t> offsets = {0};
  std::uint64_t offsets_done = 0;
  std::vector<std::uint32_t> pairs;
  std::array<std::vector<double>, 4> touching;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    const Silence silence;
    close();
    std::error_code ignored;
    if (!temporary.empty()) std::filesystem::remove(temporary, ignored);
  }

  bool close() {
    herr_t worst = 0;
    for (Id& id : motion) worst = std::min(worst, id.close());
    for (Id& id : contacts) worst = std::min(worst, id.close());
    for (Id* id : {&time, &step, &offset, &pair}) worst = std::min(worst, id->close());
    return std::min(worst, hdf5.close()) >= 0;
  }

  void open() {
    const hid_t real =
        header.precision == TrajectoryPrecision::f32 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
    chunk = chunk_frames(header.bodies.size());
    hdf5 = create_file(temporary.string(), &disk_error);
    write_header(hdf5, header);
    write_bodies(hdf5, header.bodies);
    time = create_table(hdf5, "time", H5T_IEEE_F64LE, 0, k_most_chunk_frames);
    describe(time, {"time", 0, "s", "simulated time of the frame"});
    step = create_table(hdf5, "step", H5T_STD_U64LE, 0, k_most_chunk_frames);
    describe(step, {"step", 0, "1", "steps done; 0: the initial state"});
    for (std::size_t k = 0; k < k_motion.size(); ++k) {
      motion[k] = create_motion(hdf5, k_motion[k], real, header.bodies.size());
      describe(motion[k], k_motion[k]);
    }
    if (header.contacts) open_contacts(real);
  }

  void open_contacts(hid_t real) {
    const Id group = create_group(hdf5, "contacts");
    offset = create_table(group, "offset", H5T_STD_U64LE, 0, k_most_chunk_frames);
    describe(offset, {"offset", 0, "1", "frame f has the points offset[f] .. offset[f + 1] - 1"});
    pair = create_table(group, "body", H5T_STD_U32LE, 2, k_contact_chunk);
    describe(pair, {"body", 2, "1", "first and second body, from 0"});
    for (std::size_t k = 0; k < k_contacts.size(); ++k) {
      contacts[k] =
          create_table(group, k_contacts[k].name, real, k_contacts[k].width, k_contact_chunk);
      describe(contacts[k], k_contacts[k]);
    }
  }

  void keep(const std::vector<Contact>& list) {
    for (const Contact& contact : list) {
      pairs.push_back(static_cast<std::uint32_t>(contact.body_a));
      pairs.push_back(static_cast<std::uint32_t>(contact.body_b));
      push<3>(touching[0], contact.position_m);
      push<3>(touching[1], contact.normal);
      touching[2].push_back(contact.gap_m);
      push<3>(touching[3], contact.impulse_ns);
    }
  }

  void flush() {
    append_rows(time, H5T_NATIVE_DOUBLE, frames, times_s.size(), times_s.data());
    append_rows(step, H5T_NATIVE_UINT64, frames, steps.size(), steps.data());
    for (std::size_t k = 0; k < motion.size(); ++k) {
      append_rows(motion[k], H5T_NATIVE_DOUBLE, frames, times_s.size(), moving[k].data());
      moving[k].clear();
    }
    frames += times_s.size();
    times_s.clear();
    steps.clear();
    if (header.contacts) flush_contacts();
  }

  void flush_contacts() {
    append_rows(offset, H5T_NATIVE_UINT64, offsets_done, offsets.size(), offsets.data());
    offsets_done += offsets.size();
    offsets.clear();
    const std::uint64_t more = pairs.size() / 2;
    append_rows(pair, H5T_NATIVE_UINT32, points, more, pairs.data());
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      append_rows(contacts[k], H5T_NATIVE_DOUBLE, points, more, touching[k].data());
      touching[k].clear();
    }
    points += more;
    pairs.clear();
  }

  Expected<void> guarded(const auto& call) {
    const Silence silence;
    try {
      if (failed) throw Hdf5Error("an earlier write failed");
      call();
      if (disk_error != 0) throw Hdf5Error(std::generic_category().message(disk_error));
      return {};
    } catch (const std::exception& error) {
      failed = true;
      return fail(Fault::crashed,
                  fmt::format("cannot write '{}': {}", file.string(), error.what()));
    }
  }
};

bool has_trajectories() { return true; }

TrajectoryWriter::TrajectoryWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TrajectoryWriter::TrajectoryWriter(TrajectoryWriter&&) noexcept = default;
TrajectoryWriter::~TrajectoryWriter() = default;

Expected<TrajectoryWriter> TrajectoryWriter::create(const std::filesystem::path& file,
                                                    const TrajectoryHeader& header) {
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  if (error) {
    return fail(Fault::crashed, fmt::format("cannot create folder '{}': {}",
                                            file.parent_path().string(), error.message()));
  }
  auto temporary = temporary_beside(file);
  if (!temporary) return tl::unexpected(temporary.error());
  auto impl = std::make_unique<Impl>();
  impl->file = file;
  impl->temporary = std::move(*temporary);
  impl->header = header;
  if (auto ok = impl->guarded([&] { impl->open(); }); !ok) return tl::unexpected(ok.error());
  return TrajectoryWriter(std::move(impl));
}

Expected<void> TrajectoryWriter::append(std::uint64_t step, double time_s,
                                        std::span<const State> states,
                                        const std::vector<Contact>* contacts) {
  Impl& to = *impl_;
  return to.guarded([&] {
    if (states.size() != to.header.bodies.size()) throw Hdf5Error("the number of bodies differs");
    to.times_s.push_back(time_s);
    to.steps.push_back(step);
    for (const State& state : states) {
      push<3>(to.moving[0], state.position_m);
      to.moving[1].insert(to.moving[1].end(), {state.orientation.w(), state.orientation.x(),
                                               state.orientation.y(), state.orientation.z()});
      push<3>(to.moving[2], state.velocity_mps);
      push<3>(to.moving[3], state.angular_velocity_radps);
    }
    if (to.header.contacts) {
      if (contacts != nullptr) to.keep(*contacts);
      to.offsets.push_back(to.points + to.pairs.size() / 2);
    }
    if (to.times_s.size() >= to.chunk) to.flush();
  });
}

Expected<void> TrajectoryWriter::commit(const TrajectoryEnd& end) {
  Impl& to = *impl_;
  auto written = to.guarded([&] {
    to.flush();
    write_attribute(to.hdf5, "outcome", end.outcome);
    write_attribute(to.hdf5, "reason", end.reason);
    write_attribute(to.hdf5, "frames", to.frames);
    check(H5Fflush(to.hdf5, H5F_SCOPE_GLOBAL), "the last data are not written");
    if (!to.close()) throw Hdf5Error("the last data are not written");
  });
  if (!written) return written;
  to.failed = true;  // nothing may follow
  return publish(std::exchange(to.temporary, {}), to.file);
}

}  // namespace brickbench
