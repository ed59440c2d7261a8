#include "experiments/hunt/isolated_judge.hpp"

#include <sys/resource.h>

#include "experiments/hunt/codec.hpp"

namespace brickbench::hunt {
namespace {

// On a loaded machine CPU time passes slowly; this only ends what waits for ever.
constexpr double k_trial_wall_s = 600.0;
constexpr double k_shrink_wall_s = 1800.0;
constexpr std::uint64_t k_memory_mb = 2000;

void limit_cpu() {
  const rlimit limit{k_trial_cpu_s, k_trial_cpu_s + 1};
  (void)::setrlimit(RLIMIT_CPU, &limit);
}

}  // namespace

Expected<Isolated> start_judging(const Trial& trial, const Catalogues& catalogues) {
  const auto work = [&](const Isolated::Progress&) {
    limit_cpu();
    return to_json(judge(trial, catalogues)).dump();
  };
  return Isolated::start(work, {.wall_s = k_trial_wall_s, .memory_mb = k_memory_mb});
}

Expected<Isolated> start_shrinking(const Trial& trial, const Verdict& verdict,
                                   const std::string& oracle, const Catalogues& catalogues) {
  const auto work = [&](const Isolated::Progress&) {
    const Judge probe = [&](const Trial& candidate) {
      return judge_isolated(candidate, catalogues);
    };
    return to_json(shrink(trial, verdict, oracle, catalogues, probe, k_shrink_probes)).dump();
  };
  return Isolated::start(work, {.wall_s = k_shrink_wall_s, .memory_mb = 0});
}

Verdict verdict_of(const Ended& ended) {
  if (ended.answered) {
    try {
      return verdict_of(Json::parse(ended.answer));
    } catch (const Json::exception&) {
      return judge_crash("the verdict was cut short");
    }
  }
  const bool ran_away = ended.failure.fault == Fault::timed_out || ended.from_outside ||
                        ended.failure.reason.find("SIGXCPU") != std::string::npos ||
                        ended.failure.reason.find("SIGKILL") != std::string::npos;
  if (!ran_away) return judge_crash(ended.failure.reason);
  Verdict verdict;
  verdict.outcome = to_outcome(Fault::timed_out);
  verdict.reason = ended.failure.reason;
  return verdict;
}

Shrunk shrunk_of(const Ended& ended, const Trial& trial, const Verdict& verdict) {
  if (ended.answered) {
    try {
      return shrunk_of(Json::parse(ended.answer));
    } catch (const Json::exception&) {
    }
  }
  return {trial, verdict, 0};
}

Verdict judge_isolated(const Trial& trial, const Catalogues& catalogues) {
  auto process = start_judging(trial, catalogues);
  if (!process) return judge_crash(process.error().reason);
  return verdict_of(process->wait());
}

}  // namespace brickbench::hunt
