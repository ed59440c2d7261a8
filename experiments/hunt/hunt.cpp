#include "experiments/hunt/hunt.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <utility>

#include "experiments/hunt/dice.hpp"
#include "experiments/hunt/isolated_judge.hpp"
#include "experiments/hunt/knobs.hpp"

namespace brickbench::hunt {
namespace {

using Clock = std::chrono::steady_clock;

struct Job {
  Isolated process;
  bool shrinks = false;
  std::uint64_t number = 0;  // of the trial, or place of the find
  Trial trial;
};

// Trials are begun in order and recorded in order, whatever the order of their ends.
class Loop {
 public:
  Loop(const Quarry& quarry, const Catalogues& catalogues, const HuntOptions& options,
       const ProgressFile& progress, Record& record)
      : quarry_(quarry),
        catalogues_(catalogues),
        options_(options),
        progress_(progress),
        record_(record),
        next_(record.judged()),
        until_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                  std::chrono::duration<double>(options.budget_s))) {
    for (std::size_t i = 0; i < record.finds().size(); ++i) {
      if (options.shrinks && !record.shrunk().contains(i)) to_shrink_.push_back(i);
    }
  }

  Expected<void> run(const Tick& tick) {
    while (true) {
      if (auto ok = fill(); !ok) return ok;
      if (jobs_.empty()) break;
      if (auto ok = wait(); !ok) return ok;
      if (tick && !tick(record_, jobs_.size())) stopped_ = true;
    }
    return {};
  }

 private:
  bool may_begin() const {
    return !stopped_ && next_ < options_.most_trials && Clock::now() < until_;
  }

  // Finds are shrunk as they come, but never more than half of the workers are busy with it.
  Expected<void> fill() {
    while (jobs_.size() < options_.workers) {
      const bool shrinks =
          !to_shrink_.empty() && (!may_begin() || 2 * shrinking_ < options_.workers);
      if (!shrinks && !may_begin()) return {};
      if (auto ok = shrinks ? begin_shrink() : begin_trial(); !ok) return ok;
    }
    return {};
  }

  Expected<void> begin_shrink() {
    const std::size_t place = to_shrink_.front();
    to_shrink_.pop_front();
    const Find& find = record_.finds()[place];
    auto process = start_shrinking(find.trial, find.verdict, find.oracle, catalogues_);
    if (!process) return tl::unexpected(process.error());
    ++shrinking_;
    jobs_.push_back({std::move(*process), true, place, find.trial});
    return {};
  }

  Expected<void> begin_trial() {
    const std::uint64_t number = next_++;
    const auto trial = trial_number(quarry_, catalogues_, number, options_.limits);
    if (!trial) {
      Verdict none;
      none.outcome = "not drawn";
      return ended(number, {}, none);
    }
    auto process = start_judging(*trial, catalogues_);
    if (!process) return tl::unexpected(process.error());
    jobs_.push_back({std::move(*process), false, number, *trial});
    return {};
  }

  Expected<void> wait() {
    constexpr int k_period_ms = 20;
    std::vector<pollfd> descriptors;
    for (const Job& job : jobs_) {
      descriptors.push_back({job.process.output_descriptor(), POLLIN, 0});
    }
    (void)::poll(descriptors.data(), descriptors.size(), k_period_ms);
    for (std::size_t i = 0; i < jobs_.size();) {
      Job& job = jobs_[i];
      job.process.drain();
      job.process.check_limit();
      Ended end;
      if (!job.process.has_ended(end)) {
        ++i;
        continue;
      }
      if (auto ok = finish(job, end); !ok) return ok;
      jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return {};
  }

  Expected<void> finish(const Job& job, const Ended& end) {
    if (!job.shrinks) return ended(job.number, job.trial, verdict_of(end));
    --shrinking_;
    const Find& find = record_.finds()[job.number];
    Shrunk shrunk = shrunk_of(end, find.trial, find.verdict);
    auto ok = progress_.append(static_cast<std::size_t>(job.number), shrunk);
    record_.add(static_cast<std::size_t>(job.number), std::move(shrunk));
    return ok;
  }

  Expected<void> ended(std::uint64_t number, Trial trial, Verdict verdict) {
    early_.emplace(number, std::pair(std::move(trial), std::move(verdict)));
    while (!early_.empty() && early_.begin()->first == record_.judged()) {
      const auto& [judged, verdict_of_it] = early_.begin()->second;
      if (auto ok = progress_.append(record_.judged(), judged, verdict_of_it); !ok) return ok;
      for (const std::size_t place : record_.add(record_.judged(), judged, verdict_of_it)) {
        if (options_.shrinks) to_shrink_.push_back(place);
      }
      early_.erase(early_.begin());
    }
    return {};
  }

  const Quarry& quarry_;
  const Catalogues& catalogues_;
  const HuntOptions& options_;
  const ProgressFile& progress_;
  Record& record_;
  std::uint64_t next_;
  Clock::time_point until_;
  bool stopped_ = false;
  std::size_t shrinking_ = 0;
  std::deque<std::size_t> to_shrink_;
  std::vector<Job> jobs_;
  std::map<std::uint64_t, std::pair<Trial, Verdict>> early_;  // judged before their turn
};

}  // namespace

std::optional<Trial> trial_number(const Quarry& quarry, const Catalogues& catalogues,
                                  std::uint64_t number, const DrawLimits& limits) {
  constexpr double k_case_share = 0.2;
  const std::uint64_t case_number = number / quarry.engines.size();
  const EngineVariant& engine = quarry.engines[number % quarry.engines.size()];
  Dice dice({quarry.seed, case_number}, "source");
  if (!quarry.cases.empty() && (quarry.scenes.empty() || dice.chance(k_case_share))) {
    Trial trial = draw_case(quarry.cases, quarry.seed, case_number);
    trial.engine = engine;
    return trial;
  }
  std::vector<Scenario> scenarios;
  for (const Scenario& scenario : catalogues.scenarios) {
    if (std::ranges::find(quarry.scenes, scenario.name) != quarry.scenes.end()) {
      scenarios.push_back(scenario);
    }
  }
  auto trial = draw_scene(scenarios, quarry.seed, case_number, limits);
  if (!trial) return std::nullopt;
  trial->engine = engine;
  draw_knob(*trial, catalogues, quarry.seed, case_number);
  return trial;
}

Expected<void> run_hunt(const Quarry& quarry, const Catalogues& catalogues,
                        const HuntOptions& options, const ProgressFile& progress, Record& record,
                        const Tick& tick) {
  return Loop(quarry, catalogues, options, progress, record).run(tick);
}

}  // namespace brickbench::hunt
