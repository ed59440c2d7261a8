#!/usr/bin/env bash
# splice-method.sh [BRICKBENCH]: measures thresholds and orders of convergence of every engine and puts
# both tables between the markers of docs/method.md. Nothing is retyped.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

die() { echo "splice-method: $*" >&2; exit 2; }

program=${1:-build/release/brickbench}
page=docs/method.md
if [ ! -x "$program" ]; then die "there is no program $program"; fi
for name in thresholds orders; do
  for marker in BEGIN END; do
    if [ "$(grep -c "^<!-- $marker $name" $page)" -ne 1 ]; then
      die "$page must have one line '<!-- $marker $name -->'"
    fi
  done
done

# run OPTION...: exit 1 says that a cell failed, and the table shows it.
run() { "$program" validate "$@" 2>/dev/null || [ $? -eq 1 ] || die "validate $* did not run"; }

# Rows (case, engine, text) in any order become a table of cases by engines, both in order of
# appearance; $1 heads the first column.
pivot() {
  awk -F '\t' -v head="$1" '
    !($1 in c) { c[$1] = 1; cases[++n] = $1 }
    !($2 in e) { e[$2] = 1; engines[++m] = $2 }
    { text[$1, $2] = $3 }
    END {
      if (!n) exit 1
      line = "| " head " |"; rule = "|---|"
      for (j = 1; j <= m; ++j) { line = line " " engines[j] " |"; rule = rule "---|" }
      print line; print rule
      for (i = 1; i <= n; ++i) {
        line = "| " cases[i] " |"
        for (j = 1; j <= m; ++j) {
          k = cases[i] SUBSEP engines[j]
          line = line " " ((k in text) ? text[k] : "-") " |"
        }
        print line
      }
    }'
}

made="Measured $(date -u +%Y-%m-%d), revision $(git rev-parse --short HEAD)."
thresholds=$(
  for case in friction.incline_threshold friction.pull_threshold statics.leaning_slab \
              tipping.incline tipping.column tipping.overhang tipping.kick; do
    run --case "$case" --engine all --engine ourengine/fast
  done | awk '
    $1 ~ /^[a-z_]+\.[a-z0-9_]+$/ && $2 ~ "/" { id = $1; engine = $2; if ($3 == "refused") print id "\t" engine "\trefused" }
    $2 == "between" {
      exact = $0; sub(/.*exact /, "", exact)
      low = $3; high = $5
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

new=$(mktemp docs/method.XXXXXX)
trap 'rm -f "$new"' EXIT
MADE=$made THRESHOLDS=$thresholds ORDERS=$orders awk '
  function put(text) { print; print ""; print text; print ""; print ENVIRON["MADE"]; print ""; skip = 1 }
  /^<!-- BEGIN thresholds/ { put(ENVIRON["THRESHOLDS"]); next }
  /^<!-- BEGIN orders/ { put(ENVIRON["ORDERS"]); next }
  /^<!-- END / { skip = 0 }
  !skip' $page >"$new"
cat "$new" >$page
echo "splice-method: $page has the thresholds and orders of $program"
