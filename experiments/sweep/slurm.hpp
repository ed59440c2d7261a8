// Slurm: a sweep as a job array, one task per shard.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adapters/seam/failure.hpp"

namespace brickbench {

struct SlurmJob {
  std::vector<std::string> run;    // command line of `sweep run` without --shard and --jobs
  std::vector<std::string> merge;  // command line that merges
  std::filesystem::path folder;    // of the sweep, absolute, seen by all nodes
  std::size_t shards = 1;
  std::vector<std::size_t> open_shards;  // that have work left
  unsigned cpus_per_task = 1;
  std::string partition;             // empty: the default one
  std::vector<std::string> options;  // more options for sbatch, as in "--mem=4G"
};

// The script of the array: each task runs its shard, is requeued when its node fails, and appends
// to its log. Failed cells are results, so they do not make a task fail.
std::string array_script(const SlurmJob& job);

// The script that merges once the array has ended, however its tasks ended.
std::string merge_script(const SlurmJob& job);

struct Submitted {
  std::string array_job;
  std::string merge_job;
};

// Writes the scripts to slurm/ in the sweep's folder and hands them to sbatch. Fault::crashed, with
// what sbatch says, if it refuses or is not there.
Expected<Submitted> submit(const SlurmJob& job);

}  // namespace brickbench
