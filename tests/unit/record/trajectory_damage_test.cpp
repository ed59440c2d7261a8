// Damage is found and named: cut files, flipped bytes, foreign files, disks that are full.
#include <sys/resource.h>
#include <sys/wait.h>

#include <bit>
#include <csignal>
#include <fstream>
#include <random>

#include "experiments/record/file.hpp"
#include "tests/unit/record/sample.hpp"

namespace brickbench::testing {
namespace {

void put(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

// The reason why the file cannot be read to its end, or "".
std::string complaint(const fs::path& file) {
  const auto opened = Trajectory::open(file);
  if (!opened) return opened.error().reason;
  for (std::size_t f = 0; f < opened->times_s().size(); ++f) {
    if (const auto frame = opened->read(f); !frame) return frame.error().reason;
  }
  return "";
}

// Everything that a reader gets, as one text.
std::string digest(const fs::path& file) {
  const auto opened = Trajectory::open(file);
  if (!opened) return "";
  std::string text = opened->header().cell + opened->header().experiment + opened->end().outcome;
  for (const TrajectoryBody& body : opened->header().bodies) text += body.name + '/';
  for (std::size_t f = 0; f < opened->times_s().size(); ++f) {
    const auto frame = opened->read(f);
    if (!frame) return "";
    text += std::to_string(hash_states(frame->states)) + ' ' + std::to_string(frame->time_s) + ' ';
    for (const Contact& c : frame->contacts) text += std::to_string(c.gap_m) + ' ';
  }
  return text;
}

class DamagedTrajectories : public Trajectories {
 protected:
  void SetUp() override {
    Trajectories::SetUp();
    if (IsSkipped()) return;
    TrajectoryHeader header = sample_header();
    header.contacts = true;
    ASSERT_TRUE(write_sample(folder_ / "whole.h5", header, 20).has_value());
    whole_ = *read_file(folder_ / "whole.h5");
    ASSERT_EQ(complaint(folder_ / "whole.h5"), "");
  }
  std::string whole_;
};

TEST_F(DamagedTrajectories, AreNamedWhenCutOff) {
  const fs::path file = folder_ / "cut.h5";
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{47},
        std::size_t{200}, whole_.size() / 4, whole_.size() / 2, whole_.size() - 1}) {
    put(file, whole_.substr(0, length));
    const std::string reason = complaint(file);
    EXPECT_NE(reason.find("cut.h5: "), std::string::npos) << length << ": " << reason;
    EXPECT_NE(reason.find("not a readable trajectory"), std::string::npos) << reason;
  }
}

// A flipped byte either is found, or lies where nothing is stored and changes nothing.
TEST_F(DamagedTrajectories, NeverPassForWholeWithAByteFlipped) {
  const fs::path file = folder_ / "flipped.h5";
  const std::string expected = digest(folder_ / "whole.h5");
  std::mt19937 random(1);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < 300; ++i) places.push_back(i);  // superblock and root
  for (int i = 0; i < 200; ++i) places.push_back(random() % whole_.size());
  std::size_t found = 0;
  for (const std::size_t place : places) {
    std::string bytes = whole_;
    bytes[place] = static_cast<char>(bytes[place] ^ (1 << (place % 8)));
    put(file, bytes);
    const std::string reason = complaint(file);
    if (!reason.empty()) {
      ++found;
      EXPECT_NE(reason.find("flipped.h5"), std::string::npos) << reason;
    } else {
      EXPECT_EQ(digest(file), expected) << "byte " << place << " changed what is read";
    }
  }
  EXPECT_GT(found, places.size() / 4);
}

// What gzip cannot make smaller is stored as it is, without gzip's own checksum.
TEST_F(DamagedTrajectories, AreFoundWhereNothingCompresses) {
  const fs::path file = folder_ / "random.h5";
  std::mt19937_64 random(2);
  // Any finite double; the shuffled bytes are as random as its bits.
  const auto number = [&] { return std::bit_cast<double>(random() & ~(std::uint64_t{1} << 62U)); };
  TrajectoryHeader header = sample_header();
  header.bodies.resize(1);
  auto writer = TrajectoryWriter::create(file, header);
  ASSERT_TRUE(writer.has_value()) << writer.error().reason;
  for (std::size_t f = 0; f < 256; ++f) {
    State state;
    for (double* value = state.position_m.data(); value < state.position_m.data() + 3; ++value) {
      *value = number();
    }
    const std::vector<State> states = {state};
    ASSERT_TRUE(writer->append(f, static_cast<double>(f), states, nullptr).has_value());
  }
  ASSERT_TRUE(writer->commit().has_value());
  const std::string bytes = *read_file(file);
  const std::string expected = digest(file);
  ASSERT_NE(expected, "");
  std::size_t found = 0;
  for (std::size_t place = 0; place < bytes.size(); place += bytes.size() / 50) {
    std::string flipped = bytes;
    flipped[place] = static_cast<char>(flipped[place] ^ 1);
    put(file, flipped);
    if (complaint(file).empty()) {
      EXPECT_EQ(digest(file), expected) << "byte " << place << " changed what is read";
    } else {
      ++found;
    }
  }
  EXPECT_GT(found, 10U);
}

TEST_F(DamagedTrajectories, AreToldFromForeignFiles) {
  const fs::path file = folder_ / "foreign.h5";
  EXPECT_NE(complaint(folder_ / "absent.h5").find("no such file"), std::string::npos);
  for (const std::string& text : {std::string("experiment,cell\n"), std::string(5000, 'x')}) {
    put(file, text);
    EXPECT_NE(complaint(file).find("not an HDF5 file"), std::string::npos) << complaint(file);
  }
  EXPECT_NE(complaint(folder_).find("not a readable trajectory"), std::string::npos);
}

// In a child, since the limit cannot be taken back.
TEST_F(DamagedTrajectories, AreNotLeftOnAFullDisk) {
  for (const rlim_t limit : {rlim_t{100}, rlim_t{20'000}, rlim_t{60'000}}) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      (void)std::signal(SIGXFSZ, SIG_IGN);
      const rlimit most = {limit, limit};
      ::setrlimit(RLIMIT_FSIZE, &most);
      int code = 0;
      {
        const auto written = write_sample(folder_ / "full.h5", sample_header(), 3000);
        if (written.has_value()) code = 1;
        if (!written && written.error().fault != Fault::crashed) code = 2;
        if (!written && written.error().reason.find("full.h5") == std::string::npos) code = 3;
      }
      ::exit(code);  // with HDF5's own end, which must not hang or crash
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0) << "with a limit of " << limit << " bytes";
    EXPECT_EQ(files(), 1U) << "something is left beside whole.h5";
  }
}

}  // namespace
}  // namespace brickbench::testing
