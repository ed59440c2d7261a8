#!/usr/bin/env bash
# sweep-interrupted.sh [PROGRAM]: a sweep of 2000 cells, interrupted ten times by SIGTERM and SIGKILL in turn, must
# merge to the same bytes as one that is left alone. PROGRAM: default build/release/brickbench.
# Exit status: 0 the same, 1 not. About a minute.
set -euo pipefail
program=$(realpath "${1:-build/release/brickbench}")
folder=$(mktemp -d "${TMPDIR:-/tmp}/sweep-interrupted.XXXXXX")
trap 'rm -rf "$folder"' EXIT

cat >"$folder/plan.toml" <<'END'
title = "Two thousand short cells"
[[experiment]]
scenario = "free_brick"
engines = ["ourengine"]
step_s = [0.002, 0.001]
duration_s = 0.05
seeds = 1000
perturb = { position_m = 1e-3, angle_rad = 1e-3 }
END

sweep() { "$program" sweep run "$folder/plan.toml" --out "$folder/$1" >/dev/null 2>&1; }
merge() { "$program" sweep merge "$folder/$1" --out "$folder/$1.csv"; }

sweep alone
merge alone
for round in 1 2 3 4 5 6 7 8 9 10; do
  signal=TERM
  if [ $((round % 2)) -eq 0 ]; then signal=KILL; fi
  "$program" sweep run "$folder/plan.toml" --out "$folder/interrupted" >/dev/null 2>&1 &
  sleep "1.$round"
  kill -$signal $! 2>/dev/null || true
  wait $! || true
  echo "SIG$signal: $(find "$folder/interrupted" -name '*.cell' | wc -l) cells done"
done
sweep interrupted
merge interrupted
if ! cmp "$folder/alone.csv" "$folder/interrupted.csv"; then exit 1; fi
echo "the same $(wc -c <"$folder/alone.csv") bytes"
