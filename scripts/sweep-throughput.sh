#!/usr/bin/env bash
# sweep-throughput.sh [--splice] [PROGRAM]: measures what sweeps cost and prints a table for docs/sweeps.md;
# with --splice writes it there. PROGRAM: default build/release/brickbench.
#
# Files go to /dev/shm and to TMPDIR (default /tmp). Takes two or three minutes on an idle machine; on a
# busy one the numbers are those of a busy one, and the load stands with them.
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

# ---- cells with next to nothing in them
cat >"$disk/tiny.toml" <<'END'
title = "Cells of ten steps of one brick"
[[experiment]]
scenario = "free_brick"
engines = ["ourengine"]
step_s = 0.001
duration_s = 0.01
seeds = 200
perturb = { position_m = 1e-3 }
END
inside=() isolated=() on_disk=()
for round in 1 2 3; do
  inside+=("$(seconds "$program" run "$disk/tiny.toml" --out "$memory/run$round")")
  isolated+=("$(seconds "$program" sweep run "$disk/tiny.toml" --out "$memory/tiny$round" --jobs 1)")
  on_disk+=("$(seconds "$program" sweep run "$disk/tiny.toml" --out "$disk/tiny$round" --jobs 1)")
done
row "a cell in a process of its own, start to stored result, beyond the same cell in one process; files in memory" \
  "$(calc '%.1f ms' "1000 * ($(median "${isolated[@]}") - $(median "${inside[@]}")) / 200")"
row "the same, each result brought to the disk" \
  "$(calc '%.1f ms' "1000 * ($(median "${on_disk[@]}") - $(median "${inside[@]}")) / 200")"

# ---- two workers against one: only where nobody else is at work
cat >"$disk/walls.toml" <<'END'
title = "Walls"
[[experiment]]
scenario = "brick_wall"
engines = ["ourengine"]
step_s = 0.002
duration_s = 0.4
parameters = { courses = 4, columns = 4 }
seeds = 16
perturb = { position_m = 1e-5 }
END
one=() two=()
if awk -v load="$busy" 'BEGIN { exit !(load < 0.5) }'; then
  for round in 1 2 3; do
    one+=("$(seconds "$program" sweep run "$disk/walls.toml" --out "$disk/one$round" --jobs 1)")
    two+=("$(seconds "$program" sweep run "$disk/walls.toml" --out "$disk/two$round" --jobs 2)")
  done
  row "two workers against one, 16 cells of $(calc '%.2f s' "$(median "${one[@]}") / 16")" \
    "$(calc '%.2f times' "$(median "${one[@]}") / $(median "${two[@]}")")"
else
  row "two workers against one" "not measured: load $busy before the start"
fi

# ---- many finished cells: a plan that leaves all of them out, whose results are files like any other
cat >"$disk/many.toml" <<END
title = "Many results"
[[experiment]]
scenario = "free_brick"
engines = ["ourengine"]
step_s = 0.001
duration_s = 0.01
seeds = $many
perturb = { position_m = 1e-3 }
metrics = ["momentum"]
except = [{ when = "seed > 0", why = "only their number counts here" }]
END
made=$(seconds "$program" sweep run "$disk/many.toml" --out "$memory/many")
size=$(stat -c %s "$(find "$memory/many/cells" -name '*.cell' | head -1)")
cp -r "$memory/many" "$disk/many"
row "resume of $many finished cells, $size bytes each, all checksums verified" \
  "$(calc '%.1f s' "$(seconds "$program" sweep run "$disk/many.toml" --out "$disk/many")")"
row "merge of $many finished cells" \
  "$(calc '%.1f s' "$(seconds "$program" sweep merge "$disk/many" --out "$disk/many.csv")")"

# ---- all default metrics against the engine alone
cat >"$disk/watched.toml" <<'END'
title = "A wall under all metrics"
[[experiment]]
scenario = "brick_wall"
engines = ["all"]
step_s = 0.001
duration_s = 0.3
parameters = { courses = 10, columns = 10 }
END
while IFS='|' read -r engine step cost; do
  row "all default metrics on a wall of 10x10, $engine ($step per step)" "$cost of the engine's own CPU time"
done < <(python3 - "$program" "$disk" <<'END'
import csv, json, os, resource, subprocess, sys
program, disk = sys.argv[1:]
engines = json.loads(subprocess.check_output([program, "list", "engines", "--json"]))
for engine in (e["id"] for e in engines):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    folder = f"{disk}/watched-{engine}"
    subprocess.run([program, "run", f"{disk}/watched.toml", "--engine", engine, "--out", folder],
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    all_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    for row in csv.DictReader(open(f"{folder}/timings.csv")):
        engine_s, steps = float(row["steps_total_cpu_s"]), int(row["steps"])
        if steps:
            rest_s = all_s - engine_s - float(row["build_cpu_s"])
            print(f'{row["engine"]}/{row["variant"]}|{1e6 * engine_s / steps:.0f} us|'
                  f'{100 * rest_s / engine_s:+.0f} %')
END
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
