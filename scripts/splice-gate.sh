#!/usr/bin/env bash
# splice-gate.sh STATICS LAWS POWER ALARMS: puts the tables of the files between the markers of docs/gate.md; "-"
# leaves a table as it is. The files are what these commands print, those of several engines one after the
# other; gate_power is built beside the tests:
#   brickbench oracle statics --count 200 --markdown --engine '*/*'
#   brickbench oracle laws brick_wall --set courses=10 --set columns=10 --step 0.004166666666666667
#     --duration 0.3 --stride 4 --markdown --engine ...
#   gate_power faults experiments/plans/gate_smoke.toml ENGINE 30 SEED
#   gate_power alarms experiments/plans/gate_smoke.toml ENGINE STARTS TRIALS SEED
# splice-gate.sh --cost PROGRAM: runs the suites, as they decide and with all starts, and puts there what they took.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/splice.sh
. scripts/splice.sh

page=docs/gate.md
if [ "${1:-}" = --cost ] && [ $# -eq 2 ]; then
  need_markers $page cost
  work=$(mktemp -d "${TMPDIR:-/tmp}/splice-gate.XXXXXX")
  trap 'rm -rf "$work"' EXIT
  # seconds SUITE [OPTION...]: CPU time; the summary is left in $work/out.
  seconds() {
    local TIMEFORMAT='%U %S'
    { time "$program" check "$@" --obtained "$work/$1$#" >"$work/out" 2>"$work/log"; } 2>"$work/times" ||
      die "check $* is red: $(tail -n 3 "$work/log")"
    awk '{ printf "%.3g", $1 + $2 }' "$work/times"
  }
  program=$2
  table=$(
    echo "| suite | numbers | runs when nothing changed | CPU s | runs in all | CPU s |"
    echo "|---|---:|---:|---:|---:|---:|"
    for suite in smoke full; do
      few=$(seconds $suite)
      summary='s/^\([0-9]*\) numbers, .* \([0-9]*\) cells run, \([0-9]*\) spared.*/\1 \2 \3/p'
      read -r numbers runs spared < <(cat "$work/out" "$work/log" | sed -n "$summary")
      all=$(seconds $suite --all-starts)
      echo "| $suite | $numbers | $runs | $few | $((runs + spared)) | $all |"
    done
  )
  put $page cost <<<"$table"
  echo "splice-gate: $page has what the suites of $program take"
  exit
fi
[ $# -eq 4 ] || die "usage: scripts/splice-gate.sh STATICS LAWS POWER ALARMS"
need_markers $page statics laws power alarms
for file in "$@"; do
  [ "$file" = - ] || grep -q '^|' "$file" || die "$file has no table"
done

# The text before the first table, one head, and the rows of all tables.
one_table() {
  awk '
    /^\| engine / { if (!head++) print; next }
    /^\|---/ { if (!rule++) print; next }
    /^\|/ { print; next }
    !head { print }' "$1"
}

if [ "$1" != - ]; then one_table "$1" | put $page statics; fi
if [ "$2" != - ]; then one_table "$2" | put $page laws; fi
if [ "$3" != - ]; then
  {
    echo "| engine | seeded | red | 95 % limit | named worst most often | CPU s per trial |"
    echo "|---|---|---:|---:|---|---:|"
    grep '^|' "$3"
  } | put $page power
fi
if [ "$4" != - ]; then
  {
    echo "| engines | numbers | recorded starts | alarms | 95 % limit | named | CPU s, recording + trials |"
    echo "|---|---:|---:|---:|---:|---|---:|"
    grep '^|' "$4"
  } | put $page alarms
fi
echo "splice-gate: $page has the tables of $*"
