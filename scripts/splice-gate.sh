#!/usr/bin/env bash
# splice-gate.sh STATICS LAWS POWER ALARMS: puts the tables of the files between the markers of docs/gate.md; "-"
# leaves a table as it is. The files are what these commands print, those of several engines one after the
# other; gate_power is built beside the tests:
#   brickbench oracle statics --count 200 --markdown --engine '*/*'
#   brickbench oracle laws brick_wall --set courses=10 --set columns=10 --step 0.004166666666666667
#     --duration 0.3 --stride 4 --markdown --engine ...
#   gate_power faults experiments/plans/gate_smoke.toml ENGINE 30 SEED
#   gate_power alarms experiments/plans/gate_smoke.toml ENGINE STARTS TRIALS SEED
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/splice.sh
. scripts/splice.sh

page=docs/gate.md
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
