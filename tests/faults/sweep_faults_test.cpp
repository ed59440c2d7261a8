// Sweeps under attack: killed processes, a full disk, a folder that cannot be written, signals, and
// company. Whatever happens, the merged rows are those of an undisturbed sweep, or the sweep says
// why not.
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <random>

#include "tests/support/sweep_folder.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

constexpr int k_kills = 100;
constexpr std::uint64_t k_seed = 20240607;
// Exit statuses of the processes that run a sweep for the tests.
constexpr int k_complete = 0;
constexpr int k_stopped = 3;
constexpr int k_refused = 4;
constexpr int k_skipped = 77;

std::string slow_plan(int seeds) {
  return fall_plan(R"(["slow", "good", "nan"])",
                   "seeds = " + std::to_string(seeds) + "\nperturb = { position_m = 0.1 }\n");
}

class SweepFaults : public TemporaryFolder {
 protected:
  // Runs `work` in a new process; its exit status is the work's value.
  static pid_t in_background(const std::function<int()>& work) {
    std::fflush(nullptr);
    const pid_t pid = ::fork();
    if (pid == 0) ::_exit(work());
    return pid;
  }

  static int status_of(pid_t pid) {
    int status = 0;
    ::waitpid(pid, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  // Runs a sweep with two jobs; prints why it could not.
  static int sweep(const SweepOfFakes& fakes, const fs::path& folder) {
    // Near its end a sweep has few cells left, and the kills may meet the same one again and again.
    const auto summary = fakes.run(folder, {.jobs = 2, .attempts = 1000});
    if (!summary) {
      std::ofstream(folder.string() + ".reason") << summary.error().reason;
      return k_refused;
    }
    return summary->stopped ? k_stopped : (summary->missing() == 0 ? k_complete : 1);
  }

  static std::vector<pid_t> children_of(pid_t parent) {
    std::ifstream stream("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) +
                         "/children");
    std::vector<pid_t> children;
    for (pid_t child = 0; stream >> child;) children.push_back(child);
    return children;
  }

  // What writers have left under temporary names.
  std::vector<std::string> leftovers(const fs::path& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string name = fs::relative(entry.path(), folder).string();
      if (name.find(".tmp.") != std::string::npos) names.push_back(name);
    }
    return names;
  }

  std::string undisturbed(const SweepOfFakes& fakes) {
    EXPECT_EQ(sweep(fakes, folder_ / "undisturbed"), k_complete);
    return merged(folder_ / "undisturbed");
  }
};

TEST_F(SweepFaults, KilledAtAHundredRandomMoments) {
  const SweepOfFakes fakes(slow_plan(60));
  const std::string expected = undisturbed(fakes);
  std::mt19937_64 random(k_seed);
  std::uniform_int_distribution<int> pause_us(0, 25000);
  int kills = 0;
  int rounds = 0;
  int killed_workers = 0;
  const fs::path folder = folder_ / "attacked";
  // When it is complete before a hundred kills, the attack goes on with a new folder.
  while (kills < k_kills) {
    if (rounds > 0 && fs::exists(folder)) fs::remove_all(folder);
    ++rounds;
    int status = -1;
    while (status != k_complete) {
      const pid_t parent = in_background([&] { return sweep(fakes, folder); });
      while (true) {
        ::usleep(static_cast<useconds_t>(pause_us(random)));
        if (kills >= k_kills || ::waitpid(parent, &status, WNOHANG) == parent) break;
        const auto workers = children_of(parent);
        ++kills;
        if (!workers.empty() && random() % 3 != 0) {
          ::kill(workers[random() % workers.size()], SIGKILL);
          ++killed_workers;
          continue;
        }
        ::kill(parent, SIGKILL);
        break;
      }
      if (kills >= k_kills || status == -1) status = status_of(parent);
    }
    ASSERT_TRUE(merged(folder) == expected) << "after " << kills << " kills";
    EXPECT_EQ(leftovers(folder), std::vector<std::string>{});
  }
  RecordProperty("kills", kills);
  RecordProperty("killed_workers", killed_workers);
  EXPECT_GE(killed_workers, 10);
  EXPECT_GE(kills - killed_workers, 10);
}

TEST_F(SweepFaults, TwoSweepsOnOneFolderShareIt) {
  const SweepOfFakes fakes(slow_plan(20));
  const std::string expected = undisturbed(fakes);
  const fs::path folder = folder_ / "shared";
  const auto counted = [&](const char* name) {
    return in_background([&, name] {
      const auto summary = fakes.run(folder, {.jobs = 2});
      if (!summary) return k_refused;
      std::ofstream(folder_ / name) << summary->ran;
      return summary->missing() == 0 ? k_complete : 1;
    });
  };
  const pid_t first = counted("first");
  const pid_t second = counted("second");
  EXPECT_EQ(status_of(first), k_complete);
  EXPECT_EQ(status_of(second), k_complete);
  EXPECT_TRUE(merged(folder) == expected) << "the rows differ";
  std::size_t ran[2] = {};
  std::ifstream(folder_ / "first") >> ran[0];
  std::ifstream(folder_ / "second") >> ran[1];
  EXPECT_EQ(ran[0] + ran[1], fakes.cells.size()) << "a cell was run twice, or by nobody";
}

TEST_F(SweepFaults, WorkOfADeadSweepIsTakenOver) {
  SweepOfFakes fakes(fall_plan(R"(["hang", "good"])"));
  const fs::path folder = folder_ / "s";
  const pid_t first = in_background([&] { return sweep(fakes, folder); });
  while (children_of(first).empty()) ::usleep(1000);
  ::usleep(100000);
  const pid_t second = in_background([&] {
    const auto summary = fakes.run(folder, {.jobs = 2, .limits = {.wall_s = 0.2}});
    return summary && summary->missing() == 0 ? k_complete : 1;
  });
  ::usleep(100000);
  ::kill(first, SIGKILL);
  EXPECT_EQ(status_of(first), -SIGKILL);
  EXPECT_EQ(status_of(second), k_complete);
  EXPECT_NE(merged(folder).find("no result within the wall-clock limit"), std::string::npos);
}

TEST_F(SweepFaults, StopsCleanlyWhenAsked) {
  const SweepOfFakes fakes(slow_plan(200));
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const fs::path folder = folder_ / std::to_string(signal);
    const pid_t parent = in_background([&] { return sweep(fakes, folder); });
    while (children_of(parent).empty()) ::usleep(1000);
    const auto workers = children_of(parent);
    ::kill(parent, signal);
    EXPECT_EQ(status_of(parent), k_stopped);
    for (const pid_t worker : workers) EXPECT_NE(::kill(worker, 0), 0) << "a worker lives on";
    const auto stored = read_sweep(folder);
    ASSERT_TRUE(stored.has_value());
    for (const CellState& state : take_inventory(*stored)) EXPECT_EQ(state.damage, "");
  }
}

TEST_F(SweepFaults, LimitOfFileSizesIsNamedAndNothingHalfWritten) {
  const SweepOfFakes fakes(slow_plan(2));
  const std::string expected = undisturbed(fakes);
  const fs::path folder = folder_ / "s";
  ASSERT_TRUE(fakes.open(folder).has_value());
  const pid_t pid = in_background([&] {
    const rlimit tiny{300, 300};
    ::setrlimit(RLIMIT_FSIZE, &tiny);
    return sweep(fakes, folder);
  });
  EXPECT_EQ(status_of(pid), k_refused);
  EXPECT_NE(read_file(folder.string() + ".reason").value_or("").find("File too large"),
            std::string::npos);
  EXPECT_EQ(leftovers(folder), std::vector<std::string>{});
  EXPECT_EQ(sweep(fakes, folder), k_complete);
  EXPECT_TRUE(merged(folder) == expected) << "the rows differ";
}

// Mounts a small disk on `folder` for this process and its children alone; false if the system
// does not allow it.
bool mount_small_disk(const fs::path& folder, const char* options) {
  if (::unshare(CLONE_NEWNS) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
  if (::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return false;
  return ::mount("tmpfs", folder.c_str(), "tmpfs", 0, options) == 0;
}

TEST_F(SweepFaults, FullDiskIsNamedAndTheWorkGoesOnOnceThereIsRoom) {
  const SweepOfFakes fakes(slow_plan(20));
  const std::string expected = undisturbed(fakes);
  const fs::path disk = folder_ / "disk";
  fs::create_directories(disk);
  const pid_t pid = in_background([&] {
    if (!mount_small_disk(disk, "size=120k")) return k_skipped;
    if (sweep(fakes, disk / "s") != k_refused) return 10;
    const auto reason = read_file(disk / "s.reason");
    std::ofstream(folder_ / "reason") << reason.value_or("");
    if (!leftovers(disk).empty()) return 11;
    if (::mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, "size=30m") != 0) return 12;
    if (sweep(fakes, disk / "s") != k_complete) return 13;
    return merged(disk / "s") == expected ? 0 : 14;
  });
  const int status = status_of(pid);
  if (status == k_skipped) GTEST_SKIP() << "this system lets no test mount a small disk";
  EXPECT_EQ(status, 0);
}

TEST_F(SweepFaults, FolderThatCannotBeWrittenIsNamed) {
  const SweepOfFakes fakes(slow_plan(2));
  const fs::path disk = folder_ / "disk";
  fs::create_directories(disk);
  const pid_t pid = in_background([&] {
    if (!mount_small_disk(disk, "size=1m")) return k_skipped;
    if (!fakes.open(disk / "s")) return 10;
    if (::mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, "size=1m") != 0) return 11;
    const auto summary = fakes.run(disk / "s", {.jobs = 2});
    if (summary) return 12;
    return summary.error().reason.find("Read-only file system") != std::string::npos ? 0 : 13;
  });
  const int status = status_of(pid);
  if (status == k_skipped) GTEST_SKIP() << "this system lets no test mount a read-only disk";
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace brickbench::testing
