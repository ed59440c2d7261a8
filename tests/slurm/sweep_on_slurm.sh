#!/usr/bin/env bash
# sweep_on_slurm.sh PROGRAM: a sweep as an array on a private two-node Slurm. In the middle one task is
# killed and the node of another is lost; the sweep is submitted again; its merged rows must be the
# bytes of a local run. Exit status: 0 fine, 1 not so, 77 Slurm is not here or does not run here.
set -euo pipefail
program=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export PATH="$PATH:/usr/sbin:/sbin"

for tool in sbatch squeue sinfo scontrol slurmctld slurmd munged; do
  if ! command -v $tool >/dev/null; then
    echo "SKIP: $tool is not installed (scripts/install-deps.sh slurm)"
    exit 77
  fi
done

root=$(mktemp -d /tmp/bbslurm.XXXXXX) # short: the names of sockets are limited
source "$here/mini_cluster.sh"
clean_up() {
  local status=$?
  scancel --user="$(id -un)" >/dev/null 2>&1 || true
  cluster_stop
  if [ $status -ne 0 ]; then tail -n 20 "$root"/log/*.log "$root"/sweep/slurm/*.log || true; fi
  rm -rf "$root"
}
trap clean_up EXIT

plan=$root/plan.toml
cat >"$plan.seeds" <<'PLAN'
title = "Many short cells"
[[experiment]]
scenario = "free_brick"
engines = ["all"]
step_s = [0.004, 0.002, 0.001]
duration_s = 2.0
seeds = SEEDS
perturb = { position_m = 1e-3, angle_rad = 1e-3 }
PLAN
# As many cells whatever engines are linked.
engines=$("$program" list engines --json | grep -c '"precision"')
seeds=${SWEEP_SEEDS:-$((160 / engines))}
shards=4

fail() { echo "FAILED: $*"; exit 1; }
say() { echo "[$SECONDS s] $*"; }

if ! cluster_start; then
  # A machine on which Slurm's own daemons give up, for one without a mounted /sys/fs/cgroup.
  if grep -hE 'slurmd initialization failed|fatal:' "$root"/log/*.log; then
    echo "SKIP: Slurm's daemons do not run here; their reason follows"
    exit 77
  fi
  fail "the private cluster does not start"
fi
say "cluster is up"

run_here() {
  sed "s/SEEDS/$seeds/" "$plan.seeds" >"$plan"
  local started=$SECONDS
  "$program" sweep run "$plan" --out "$root/local" >/dev/null 2>&1 || [ $? -eq 1 ]
  took=$((SECONDS - started))
}
run_here
# The array must last long enough to lose a task: with fast engines alone it takes more cells.
if [ $took -lt 10 ]; then
  seeds=$((seeds * 12 / (took + 1)))
  rm -rf "$root/local"
  run_here
fi
"$program" sweep merge "$root/local" --out "$root/local.csv" >/dev/null || [ $? -eq 1 ]
say "local run of $seeds seeds done in $took s: $(wc -l <"$root/local.csv") lines"

submit() { "$program" sweep submit --slurm "$plan" --out "$root/sweep" --shards $shards --partition main; }
results() { find "$root/sweep/cells" -name '*.cell' 2>/dev/null | wc -l; }
at_least() { [ "$(results)" -ge "$1" ]; }
queue_is_empty() { scontrol ping >/dev/null && [ -z "$(squeue -h)" ]; }
# The array index of the task that runs on a node.
task_on() { squeue -h -r -t R -w "$1" -o %K | grep -E '^[0-9]+$' | head -1; }
total=$(grep -c . "$root"/local/cells.*.csv)
total=$((total - 1))

submit
wait_until 60 at_least $((total / 10)) || fail "the array does not run"
# The process that runs shard $1, not those of its cells, whose command lines are the same.
process_of_shard() {
  local process command parent
  for process in /proc/[0-9]*; do
    command=$({ tr "\0" " " <"$process/cmdline"; } 2>/dev/null) || continue
    case $command in
      *"sweep run"*"--out $root/sweep"*"--shard $1/$shards"*) ;;
      *) continue ;;
    esac
    parent=$({ sed 's/.*) . \([0-9]*\) .*/\1/' "$process/stat"; } 2>/dev/null) || continue
    if grep -qaF -- "--shard" "/proc/$parent/cmdline" 2>/dev/null; then continue; fi
    echo "${process#/proc/}"
    return
  done
}
# Both nodes at work, and the process of the task on n2 found; tasks may end while one looks.
victim=""
choose_victim() {
  lost=$(task_on n1)
  killed=$(task_on n2)
  if [ -z "$lost" ] || [ -z "$killed" ]; then return 1; fi
  victim=$(process_of_shard "$killed")
  [ -n "$victim" ]
}
wait_until 30 choose_victim || fail "no task to kill ($(results) results)"
before=$(results)
kill -KILL "$victim"
scontrol update nodename=n1 state=down reason=test
node_stop n1
say "killed task $killed (process $victim), took down n1 with task $lost, at $before of $total results"

wait_until 120 queue_is_empty || fail "the array does not end: $(squeue -h -r)"
after=$(results)
say "first array ended with $after of $total results"
[ "$before" -lt "$total" ] || fail "the sweep was over before anything happened to it"
[ "$after" -lt "$total" ] || fail "the killed task left nothing undone"
if [ -e "$root/sweep/rows.csv" ]; then fail "an incomplete sweep was merged"; fi
grep -q "incomplete" "$root/sweep/slurm/merge.log" || fail "the merge does not say what is missing"

node_start n1
submit
wait_until 120 queue_is_empty || fail "the second array does not end: $(squeue -h -r)"
[ "$(results)" -eq "$total" ] || fail "$(results) of $total results after the second array"
[ "$(find "$root/sweep" -name '*.tmp.*' | wc -l)" -eq 0 ] || fail "temporary files are left"
cmp "$root/local.csv" "$root/sweep/rows.csv" || fail "the rows differ from those of the local run"
submit | grep -q "nothing to submit" || fail "a complete sweep is submitted again"
say "merged rows are those of the local run, byte for byte"
