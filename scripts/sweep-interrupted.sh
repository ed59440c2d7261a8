#!/usr/bin/env bash
# sweep-interrupted.sh [PROGRAM [CELLS]]: a sweep of 2000 cells, interrupted ten times by SIGTERM and SIGKILL in
# turn, must merge to the same bytes as one that is left alone. PROGRAM: default build/release/brickbench.
# Exit status: 0 the same, 1 not, or it was done before the tenth interruption. Less than a minute.
set -euo pipefail
program=$(realpath "${1:-build/release/brickbench}")
cells=${2:-2000}
folder=$(mktemp -d "${TMPDIR:-/tmp}/sweep-interrupted.XXXXXX")
trap 'rm -rf "$folder"' EXIT

cat >"$folder/plan.toml" <<END
title = "Short cells"
[[experiment]]
scenario = "free_brick"
engines = ["ourengine"]
step_s = [0.002, 0.001]
duration_s = 0.05
seeds = $((cells / 2))
perturb = { position_m = 1e-3, angle_rad = 1e-3 }
END

sweep() { "$program" sweep run "$folder/plan.toml" --out "$folder/$1" >/dev/null 2>&1; }
merge() { "$program" sweep merge "$folder/$1" --out "$folder/$1.csv"; }
finished() { find "$folder/interrupted" -name '*.cell' | wc -l; }

start=$(date +%s.%N)
sweep alone
# Ten interruptions must find it at work, whatever the start of each run costs.
pause=$(awk -v from="$start" -v to="$(date +%s.%N)" 'BEGIN { printf "%.2f", (to - from) / 20 + 0.1 }')
merge alone
for round in 1 2 3 4 5 6 7 8 9 10; do
  signal=TERM
  if [ $((round % 2)) -eq 0 ]; then signal=KILL; fi
  "$program" sweep run "$folder/plan.toml" --out "$folder/interrupted" >/dev/null 2>&1 &
  sleep "$pause"
  kill -$signal $! 2>/dev/null || { echo "done before interruption $round"; exit 1; }
  { wait $!; } 2>/dev/null || true
  echo "SIG$signal: $(finished) of $cells cells done"
done
sweep interrupted
merge interrupted
if ! cmp "$folder/alone.csv" "$folder/interrupted.csv"; then exit 1; fi
echo "the same $(wc -c <"$folder/alone.csv") bytes"
