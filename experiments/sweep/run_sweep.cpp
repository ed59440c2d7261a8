#include "experiments/sweep/run_sweep.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <deque>
#include <list>
#include <set>
#include <system_error>

#include "experiments/record/file.hpp"
#include "experiments/record/trajectory.hpp"
#include "experiments/sweep/claims.hpp"
#include "experiments/sweep/inventory.hpp"

namespace brickbench {
namespace fs = std::filesystem;
namespace {

constexpr int k_tick_ms = 100;
// The answer of a cell's process begins with one of these.
constexpr char k_written = 'w';
constexpr char k_not_written = 'n';

// SIGINT, SIGTERM, SIGHUP and SIGCHLD as something to poll, while it lives.
class SignalWatch {
 public:
  SignalWatch() {
    sigset_t watched;
    sigemptyset(&watched);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&watched, signal);
    ::sigprocmask(SIG_BLOCK, &watched, &before_);
    // A write beyond the limit of file sizes must be an error, not the end.
    size_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    descriptor_ = ::signalfd(-1, &watched, SFD_NONBLOCK | SFD_CLOEXEC);
  }
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;
  ~SignalWatch() {
    ::close(descriptor_);
    (void)std::signal(SIGXFSZ, size_handler_);
    ::sigprocmask(SIG_SETMASK, &before_, nullptr);
  }

  int descriptor() const { return descriptor_; }
  // Whether one that asks to stop has come.
  bool stop_requested() const {
    signalfd_siginfo info{};
    bool stop = false;
    while (::read(descriptor_, &info, sizeof info) == static_cast<ssize_t>(sizeof info)) {
      stop = stop || info.ssi_signo != SIGCHLD;
    }
    return stop;
  }

 private:
  sigset_t before_{};
  void (*size_handler_)(int) = nullptr;
  int descriptor_ = -1;
};

// Removes what writers that were killed have left of this file.
void remove_leftovers(const fs::path& file) {
  std::error_code error;
  const std::string start = file.filename().string() + ".tmp.";
  for (const auto& entry : fs::directory_iterator(file.parent_path(), error)) {
    if (entry.path().filename().string().starts_with(start)) fs::remove(entry.path(), error);
  }
}

Expected<void> write_result(const fs::path& sweep, const CellResult& result,
                            bool with_series = false) {
  const fs::path file = result_path(sweep, result.timing.cell);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error) {
    return fail(Fault::crashed, fmt::format("cannot create folder '{}': {}",
                                            file.parent_path().string(), error.message()));
  }
  return replace_file(file, to_text(cell_file(result, with_series)));
}

struct Running {
  std::size_t cell;
  Isolated process;
};

class Pool {
 public:
  Pool(const Sweep& sweep, const std::vector<Cell>& cells, const Catalogues& catalogues,
       const Origin& origin, const SweepOptions& options, const SweepCallbacks& callbacks,
       Claims claims)
      : sweep_(sweep),
        cells_(cells),
        catalogues_(catalogues),
        origin_(origin),
        options_(options),
        callbacks_(callbacks),
        claims_(std::move(claims)),
        attempts_(cells.size(), 0) {}

  Expected<SweepSummary> run() {
    look_through();
    const auto ended = work_through();
    abandon_running();
    if (!ended) return tl::unexpected(ended.error());
    return summary_;
  }

 private:
  // Decides what is to be run.
  void look_through() {
    const auto states = take_inventory(sweep_, options_.shard);
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (!options_.shard.holds(i)) continue;
      ++summary_.cells;
      const CellState& state = states[i];
      if (!state.damage.empty()) {
        ++summary_.damaged;
        if (callbacks_.damaged) callbacks_.damaged(state.damage);
      }
      const bool failed = is_failure(sweep_.cells[i], state.outcome);
      const bool retry = options_.retry_failed && failed && is_retried(state.outcome);
      if (!state.is_done() || retry) {
        waiting_.push_back(i);
        if (retry) retried_.insert(i);
      } else {
        ++summary_.found;
        if (failed) ++summary_.failed;
      }
    }
    if (callbacks_.begins) callbacks_.begins(summary_.cells, summary_.found);
  }

  // Until all is done, or somebody asks to stop.
  Expected<void> work_through() {
    const SignalWatch signals;
    while (!waiting_.empty() || !left_to_others_.empty() || !running_.empty()) {
      if (auto ok = fill(); !ok) return ok;
      wait(signals);
      if (signals.stop_requested()) {
        summary_.stopped = true;
        return {};
      }
      if (auto ok = collect(); !ok) return ok;
      if (callbacks_.tick) callbacks_.tick(running_.size());
    }
    return {};
  }

  // Kills what still runs; one that was writing leaves its half behind.
  void abandon_running() {
    while (!running_.empty()) {
      const std::size_t cell = running_.front().cell;
      running_.pop_front();
      const std::string& id = sweep_.cells[cell].cell;
      remove_leftovers(result_path(sweep_.folder, id));
      if (cells_[cell].recording) remove_leftovers(trajectory_path(sweep_.folder, id));
    }
  }

  Expected<void> fill() {
    for (std::size_t looked = left_to_others_.size(); looked > 0 && waiting_.empty(); --looked) {
      waiting_.push_back(left_to_others_.front());
      left_to_others_.pop_front();
    }
    std::size_t starts = waiting_.size();
    while (running_.size() < options_.jobs && starts-- > 0) {
      const std::size_t cell = waiting_.front();
      waiting_.pop_front();
      if (!claims_.take(cell)) {
        left_to_others_.push_back(cell);
        continue;
      }
      if (attempts_[cell] == 0 && done_by_another(cell)) continue;
      if (auto ok = start(cell); !ok) return ok;
    }
    return {};
  }

  // Whether a result has appeared since the folder was looked through.
  bool done_by_another(std::size_t cell) {
    if (retried_.contains(cell)) return false;
    const auto result = find_result(sweep_, cell);
    if (!result || !*result) return false;
    claims_.give_back(cell);
    ++summary_.shared;
    report(cell, (*result)->outcome, (*result)->reason, 0.0, true);
    return true;
  }

  Expected<void> start(std::size_t number) {
    const Cell& cell = cells_[number];
    remove_leftovers(result_path(sweep_.folder, sweep_.cells[number].cell));
    if (!cell.excluded_why.empty()) {
      const CellResult result = run_cell(cell, catalogues_, origin_);
      return settle(number, result);
    }
    auto process = Isolated::start(
        [&](const StepCallback& after_step) { return work(cell, after_step); }, options_.limits);
    if (!process) return tl::unexpected(process.error());
    ++attempts_[number];
    running_.push_back({number, std::move(*process)});
    return {};
  }

  // What an earlier attempt at the cell has recorded, or left of it.
  void remove_recording(const Cell& cell) const {
    const fs::path file = trajectory_path(sweep_.folder, sweep_.cells[cell.index].cell);
    std::error_code error;
    fs::remove(file, error);
    remove_leftovers(file);
  }

  // In the cell's own process.
  std::string work(const Cell& cell, const StepCallback& after_step) const {
    if (cell.recording) remove_recording(cell);
    CellResult result = run_cell(cell, catalogues_, origin_, after_step, sweep_.folder);
    if (!result.unrecorded.empty()) return k_not_written + result.unrecorded;
    if (result.outcome == to_outcome(Fault::timed_out)) {
      // How far it came differs from run to run and stands with the timings.
      const Timing timing = result.timing;
      result = failed_cell(
          cell, catalogues_, origin_, result.outcome,
          fmt::format("not done within the limit of {} s of CPU time", cell.time_limit_s));
      result.timing = timing;
    }
    const auto written = write_result(sweep_.folder, result, cell.recording.has_value());
    if (!written) return k_not_written + written.error().reason;
    return k_written + result.outcome + '\n' + result.reason;
  }

  void wait(const SignalWatch& signals) {
    std::vector<pollfd> watched = {{signals.descriptor(), POLLIN, 0}};
    for (const Running& running : running_) {
      watched.push_back({running.process.output_descriptor(), POLLIN, 0});
    }
    (void)::poll(watched.data(), static_cast<nfds_t>(watched.size()), k_tick_ms);
  }

  Expected<void> collect() {
    for (auto it = running_.begin(); it != running_.end();) {
      it->process.drain();
      it->process.check_limit();
      Ended ended;
      if (!it->process.has_ended(ended)) {
        ++it;
        continue;
      }
      const std::size_t cell = it->cell;
      it = running_.erase(it);
      if (auto ok = conclude(cell, ended); !ok) return ok;
    }
    return {};
  }

  Expected<void> conclude(std::size_t number, Ended& ended) {
    if (ended.answered && ended.answer.starts_with(k_not_written)) {
      return fail(Fault::crashed, ended.answer.substr(1));
    }
    if (ended.answered) {
      const std::string_view answer = std::string_view(ended.answer).substr(1);
      const auto line = answer.find('\n');
      const std::string outcome(answer.substr(0, line));
      if (auto ok = keep_output(number, outcome, ended.output); !ok) return ok;
      claims_.give_back(number);
      ++summary_.ran;
      report(number, outcome, std::string(answer.substr(line + 1)), ended.wall_s, false);
      return {};
    }
    if (ended.from_outside && attempts_[number] < options_.attempts) {
      // Last in the queue, for the trouble to pass.
      waiting_.push_back(number);
      claims_.give_back(number);
      return {};
    }
    return conclude_failure(number, ended);
  }

  Expected<void> conclude_failure(std::size_t number, Ended& ended) {
    const Cell& cell = cells_[number];
    std::string reason = ended.failure.reason;
    if (ended.failure.fault != Fault::timed_out) {
      const auto steps = step_count(cell);
      const auto done = static_cast<std::uint64_t>(ended.share * static_cast<double>(steps) + 0.5);
      reason += fmt::format(" after {} of {} steps", done, steps);
    }
    if (ended.from_outside) {
      reason = fmt::format("{} in each of {} attempts; if nobody sent it, memory had run out",
                           ended.failure.reason, options_.attempts);
    }
    CellResult result = failed_cell(cell, catalogues_, origin_,
                                    std::string(to_outcome(ended.failure.fault)), reason);
    result.timing.cell_wall_s = ended.wall_s;
    if (auto ok = keep_output(number, result.outcome, ended.output); !ok) return ok;
    return settle(number, result);
  }

  // This process writes the result.
  Expected<void> settle(std::size_t number, const CellResult& result) {
    if (auto ok = write_result(sweep_.folder, result); !ok) return ok;
    claims_.give_back(number);
    ++summary_.ran;
    report(number, result.outcome, result.reason, result.timing.cell_wall_s, false);
    return {};
  }

  // Keeps what a failed cell printed; of others nothing.
  Expected<void> keep_output(std::size_t number, const std::string& outcome,
                             const std::string& output) {
    const fs::path file = log_path(sweep_.folder, sweep_.cells[number].cell);
    std::error_code error;
    if (!is_retried(outcome) || output.empty()) {
      if (options_.retry_failed) fs::remove(file, error);
      return {};
    }
    fs::create_directories(file.parent_path(), error);
    return replace_file(file, output);
  }

  void report(std::size_t number, const std::string& outcome, const std::string& reason,
              double wall_s, bool by_another) {
    CellOutcome done;
    done.cell = cells_[number];
    done.id = sweep_.cells[number].cell;
    done.outcome = outcome;
    done.reason = reason;
    done.wall_s = wall_s;
    if (is_failure(done)) ++summary_.failed;
    if (callbacks_.cell_ends) callbacks_.cell_ends(done, by_another);
  }

  const Sweep& sweep_;
  const std::vector<Cell>& cells_;
  const Catalogues& catalogues_;
  const Origin& origin_;
  const SweepOptions& options_;
  const SweepCallbacks& callbacks_;
  Claims claims_;
  std::vector<int> attempts_;
  std::set<std::size_t> retried_;  // have a result that is to be replaced
  std::deque<std::size_t> waiting_;
  std::deque<std::size_t> left_to_others_;
  std::list<Running> running_;
  SweepSummary summary_;
};

}  // namespace

Expected<SweepSummary> run_sweep(const Sweep& sweep, const std::vector<Cell>& cells,
                                 const Catalogues& catalogues, const Origin& origin,
                                 const SweepOptions& options, const SweepCallbacks& callbacks) {
  if (const std::size_t threads = thread_count(); threads != 1) {
    return fail(Fault::crashed,
                fmt::format("cells can be isolated only while the process has one thread, not {}",
                            threads));
  }
  auto claims = Claims::open(sweep.folder);
  if (!claims) return tl::unexpected(claims.error());
  return Pool(sweep, cells, catalogues, origin, options, callbacks, std::move(*claims)).run();
}

}  // namespace brickbench
