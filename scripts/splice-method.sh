#!/usr/bin/env bash
# splice-method.sh [BRICKBENCH]: measures thresholds and orders of convergence of every engine, runs the
# seeded faults of the tests beside the program, and puts the three tables between the markers of
# docs/method.md. Nothing is retyped.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source scripts/splice.sh

program=${1:-build/release/brickbench}
page=docs/method.md
if [ ! -x "$program" ]; then die "there is no program $program"; fi
need_markers $page thresholds orders faults
judge=$(dirname "$program")/tests/seeded_faults
if [ ! -x "$judge" ]; then die "there is no $judge: build the tests"; fi

# run OPTION...: exit 1 says that a cell failed, and the table shows it.
run() { "$program" validate "$@" 2>/dev/null || [ $? -eq 1 ] || die "validate $* did not run"; }

thresholds=$(
  for case in friction.incline_threshold friction.pull_threshold statics.leaning_slab \
              tipping.incline tipping.column tipping.overhang tipping.kick; do
    run --case "$case" --engine all --engine ourengine/fast
  done | awk '
    $1 ~ /^[a-z_]+\.[a-z0-9_]+$/ && $2 ~ "/" { id = $1; engine = $2; if ($3 == "refused") print id "\t" engine "\trefused" }
    $2 == "between" {
      exact = $0; sub(/.*exact /, "", exact)
      low = $3; high = $5; sub(/,$/, "", high)
      print id " (" $1 ")\texact\t" exact
      print id " (" $1 ")\t" engine "\t" low " .. " high
    }' | pivot case
) || die "no thresholds were found"
orders=$(
  for case in rotation.torque_free_3 rotation.symmetric_precession rotation.axis_flip \
              friction.sliding_stop; do
    run --order --case "$case" --engine all --engine mujoco/rk4 --engine ourengine/baraff
  done | awk '
    $1 ~ /^[a-z_]+\.[a-z0-9_]+$/ && $2 ~ "/" {
      print $1 "\t" $2 "\t" ($4 == "+-" ? $3 " +- " $5 : $3) }' | pivot case
) || die "no orders were fitted"

faults=$("$judge" | grep "^|") || die "$judge printed no table"

put $page faults <<<"$faults"$'\n\n'"$(measured "$program")"
put $page thresholds <<<"$thresholds"$'\n\n'"$(measured "$program")"
put $page orders <<<"$orders"$'\n\n'"$(measured "$program")"
echo "splice-method: $page has the thresholds and orders of $program"
