#include "experiments/sweep/slurm.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>

#include "experiments/record/file.hpp"
#include "experiments/record/provenance.hpp"

namespace brickbench {
namespace fs = std::filesystem;
namespace {

std::string header(const SlurmJob& job, const std::string& name, const std::string& log) {
  std::string text = fmt::format(
      "#!/bin/bash\n"
      "#SBATCH --job-name={}-{}\n"
      "#SBATCH --output={}\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --requeue\n",
      job.folder.filename().string(), name, (job.folder / "slurm" / log).string());
  if (!job.partition.empty()) text += fmt::format("#SBATCH --partition={}\n", job.partition);
  for (const std::string& option : job.options) text += fmt::format("#SBATCH {}\n", option);
  return text;
}

// Standard output and error of a shell command, and whether it ended well.
Expected<std::string> output_of(const std::string& command) {
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return fail(Fault::crashed, "cannot start a shell");
  std::string text;
  std::array<char, 4096> buffer;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    text.append(buffer.data(), count);
  }
  const int status = ::pclose(pipe);
  while (text.ends_with('\n')) text.pop_back();
  if (status != 0) return fail(Fault::crashed, fmt::format("{}: {}", command, text));
  return text;
}

// `sbatch --parsable` prints the job, and on some sites ";cluster".
Expected<std::string> batch(const std::string& options, const fs::path& script) {
  auto job = output_of("sbatch --parsable " + options + shell_command({script.string()}));
  if (!job) return job;
  // Warnings may stand before the number.
  const auto line = job->rfind('\n');
  std::string number = line == std::string::npos ? *job : job->substr(line + 1);
  number = number.substr(0, number.find(';'));
  if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos) {
    return fail(Fault::crashed, fmt::format("sbatch did not name a job: {}", *job));
  }
  return number;
}

}  // namespace

std::string array_script(const SlurmJob& job) {
  return header(job, "sweep", "shard-%a.log") +
         fmt::format(
             "#SBATCH --array={}\n"
             "#SBATCH --cpus-per-task={}\n"
             "status=0\n"
             "{} --shard \"$SLURM_ARRAY_TASK_ID/{}\" --jobs {} || status=$?\n"
             "# Cells that failed are results; they do not make the task fail.\n"
             "if [ $status -eq 1 ]; then status=0; fi\n"
             "exit $status\n",
             fmt::join(job.open_shards, ","), job.cpus_per_task, shell_command(job.run), job.shards,
             job.cpus_per_task);
}

std::string merge_script(const SlurmJob& job) {
  return header(job, "merge", "merge.log") + shell_command(job.merge) + '\n';
}

Expected<Submitted> submit(const SlurmJob& job) {
  const fs::path scripts = job.folder / "slurm";
  std::error_code error;
  fs::create_directories(scripts, error);
  if (auto ok = replace_file(scripts / "array.sh", array_script(job)); !ok) {
    return tl::unexpected(ok.error());
  }
  if (auto ok = replace_file(scripts / "merge.sh", merge_script(job)); !ok) {
    return tl::unexpected(ok.error());
  }
  const auto array = batch("", scripts / "array.sh");
  if (!array) return tl::unexpected(array.error());
  const auto merged = batch("--dependency=afterany:" + *array + ' ', scripts / "merge.sh");
  if (!merged) return tl::unexpected(merged.error());
  return Submitted{*array, *merged};
}

}  // namespace brickbench
