#!/usr/bin/env bash
# sweep-throughput.sh [--splice] [PROGRAM]: measures what sweeps cost and prints a table for docs/sweeps.md;
# with --splice writes it there. PROGRAM: default build/release/brickbench.
#
# Files go to /dev/shm and to TMPDIR (default /tmp). Takes three to five minutes on an idle machine; on a
# busy one the numbers are those of a busy one, and the load stands with them.
# SWEEP_CELLS: how many finished cells to go on with and to merge (default 100000).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
splice=false
if [ "${1:-}" = --splice ]; then splice=true; shift; fi
program=$(realpath "${1:-build/release/brickbench}")
many=${SWEEP_CELLS:-100000}

disk=$(mktemp -d "${TMPDIR:-/tmp}/sweep-throughput.XXXXXX")
memory=$(mktemp -d /dev/shm/sweep-throughput.XXXXXX)
trap 'rm -rf "$disk" "$memory"' EXIT

busy=$(cut -d' ' -f1 /proc/loadavg) # before there is any load of our own

# seconds COMMAND...: wall time; output goes away, and cells that fail do not matter.
seconds() {
  local start end
  start=$(date +%s.%N)
  "$@" >/dev/null 2>&1 || [ $? -eq 1 ] || { echo "failed: $*" >&2; exit 1; }
  end=$(date +%s.%N)
  awk -v a="$start" -v b="$end" 'BEGIN { printf "%.4f", b - a }'
}
calc() { awk "BEGIN { printf \"$1\", $2 }"; }
median() { printf '%s\n' "$@" | sort -g | awk '{ a[NR] = $1 } END { print a[int((NR + 1) / 2)] }'; }
rows=()
row() { rows+=("| $1 | $2 |"); echo "$1: $2" >&2; }

# plan FILE TITLE LINE...: one experiment; each line is a setting of it.
plan() {
  local file=$1 title=$2
  shift 2
  { printf 'title = "%s"\n[[experiment]]\n' "$title"; printf '%s\n' "$@"; } >"$disk/$file.toml"
}
# sweep FILE FOLDER OPTION...: runs the plan's sweep there.
sweep() { "$program" sweep run "$disk/$1.toml" --out "$2" "${@:3}"; }

one_brick=('scenario = "free_brick"' 'engines = ["ourengine"]' 'step_s = 0.001' 'duration_s = 0.01'
  'perturb = { position_m = 1e-3 }')
plan tiny "Cells of ten steps of one brick" "${one_brick[@]}" 'seeds = 200'
plan walls "Walls" 'scenario = "brick_wall"' 'engines = ["ourengine"]' 'step_s = 0.002' 'duration_s = 0.4' \
  'parameters = { courses = 4, columns = 4 }' 'seeds = 32' 'perturb = { position_m = 1e-5 }'
# All of its cells but one are left out, so only their number counts; their results are files like any other.
plan many "Many results" "${one_brick[@]}" "seeds = $many" 'metrics = ["momentum"]' \
  'except = [{ when = "seed > 0", why = "only their number counts here" }]'
plan watched "A wall under all metrics" 'scenario = "brick_wall"' 'engines = ["all"]' 'step_s = 0.001' \
  'duration_s = 0.2' 'parameters = { courses = 10, columns = 10 }'

# ---- a cell with next to nothing in it
inside=() isolated=() on_disk=()
for round in 1 2 3; do
  inside+=("$(seconds "$program" run "$disk/tiny.toml" --out "$memory/run$round")")
  isolated+=("$(seconds sweep tiny "$memory/tiny$round" --jobs 1)")
  on_disk+=("$(seconds sweep tiny "$disk/tiny$round" --jobs 1)")
done
beyond() { calc '%.1f ms' "1000 * ($1 - $(median "${inside[@]}")) / 200"; }
row "a cell in a process of its own, start to stored result, beyond the same cell in one process; files in memory" \
  "$(beyond "$(median "${isolated[@]}")")"
row "the same, each result brought to the disk" "$(beyond "$(median "${on_disk[@]}")")"

# ---- two workers against one: only where nobody else is at work. What the machine itself gives for two
# is the work of two independent runs of the same cells side by side, in the time of both.
together() {
  "$program" run "$disk/walls.toml" --out "$1-a" & local first=$!
  "$program" run "$disk/walls.toml" --out "$1-b" & local second=$!
  wait $first && wait $second
}
if awk -v load="$busy" 'BEGIN { exit !(load < 0.5) }'; then
  one=() two=() alone=() both=()
  for round in 1 2 3 4 5; do
    one+=("$(seconds sweep walls "$disk/one$round" --jobs 1)")
    two+=("$(seconds sweep walls "$disk/two$round" --jobs 2)")
    alone+=("$(seconds "$program" run "$disk/walls.toml" --out "$disk/alone$round")")
    both+=("$(seconds together "$disk/both$round")")
  done
  row "two workers against one, 32 cells of $(calc '%.2f s' "$(median "${one[@]}") / 32")" \
    "$(calc '%.2f times' "$(median "${one[@]}") / $(median "${two[@]}")")"
  row "two independent runs side by side against one run: what the machine gives" \
    "$(calc '%.2f times' "2 * $(median "${alone[@]}") / $(median "${both[@]}")")"
else
  row "two workers against one" "not measured: load $busy before the start"
fi

# ---- many finished cells
seconds sweep many "$memory/many" >/dev/null
size=$(stat -c %s "$(find "$memory/many/cells" -name '*.cell' -print -quit)")
cp -r "$memory/many" "$disk/many"
row "resume of $many finished cells, $size bytes each, all checksums verified" \
  "$(calc '%.1f s' "$(seconds sweep many "$disk/many")")"
row "merge of $many finished cells" \
  "$(calc '%.1f s' "$(seconds "$program" sweep merge "$disk/many" --out "$disk/many.csv")")"

# ---- all default metrics against the engine alone: what a longer run costs beyond a shorter one, so that
# the start of the program and the curves, which have 200 points whatever the duration, count for neither.
while IFS='|' read -r engine step cost start; do
  row "all default metrics on a wall of 10x10, $engine ($step per step)" "$cost of the engine's own CPU time"
  row "such a cell with $engine, once: start of the program, curves, files" "$start of CPU time"
done < <(python3 - "$program" "$disk" <<'END_OF_PYTHON'
import csv, json, resource, statistics, subprocess, sys
program, disk = sys.argv[1:]
rounds, shorter_s, longer_s = 3, 0.2, 0.6


def run(engine, duration_s, folder):
    """CPU time of the harness and of the engine's steps in s, number of steps, name."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "run", f"{disk}/watched.toml", "--engine", engine, "--out", folder,
                    "--set", f"duration_s={duration_s}"],
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    all_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    row = next(csv.DictReader(open(f"{folder}/timings.csv")))
    engine_s = float(row["steps_total_cpu_s"] or 0)
    rest_s = all_s - engine_s - float(row["build_cpu_s"] or 0)
    return rest_s, engine_s, int(row["steps"] or 0), f'{row["engine"]}/{row["variant"]}'


for engine in (e["id"] for e in json.loads(subprocess.check_output([program, "list", "engines", "--json"]))):
    shares, starts_s, steps_s = [], [], []
    for i in range(rounds):
        folder = f"{disk}/watched-{engine}-{i}"
        short = run(engine, shorter_s, folder + "-short")
        long = run(engine, longer_s, folder + "-long")
        steps = long[2] - short[2]
        if not steps:
            break
        rest_s, engine_s = ((long[k] - short[k]) / steps for k in (0, 1))
        shares.append(rest_s / engine_s)
        steps_s.append(engine_s)
        starts_s.append(short[0] - rest_s * short[2])
        if engine_s > 0.01:
            break  # a slow engine: one round tells enough
    if shares:
        print(f"{short[3]}|{1e6 * statistics.median(steps_s):.0f} us|{100 * statistics.median(shares):+.1f} %"
              f"|{1e3 * statistics.median(starts_s):.0f} ms")
END_OF_PYTHON
)

table=$(
  echo "Measured on $(date -u +%Y-%m-%d) on $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1)," \
    "$(nproc) cores, load $busy before the start, revision $(git rev-parse --short=12 HEAD)."
  echo
  echo "| what | cost |"
  echo "|---|---|"
  printf '%s\n' "${rows[@]}"
)
echo "$table"
if $splice; then
  TABLE=$table awk '
    /^<!-- throughput -->$/ { print; print ENVIRON["TABLE"]; skip = 1; next }
    /^<!-- \/throughput -->$/ { skip = 0 }
    !skip { print }' docs/sweeps.md >"$disk/sweeps.md"
  cp "$disk/sweeps.md" docs/sweeps.md
fi
