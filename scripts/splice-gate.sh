#!/usr/bin/env bash
# splice-gate.sh STATICS LAWS [POWER]: puts the tables of the files between the markers of docs/gate.md; what
# has no file stays as it is. The files are what these commands print:
#   brickbench oracle statics --count 200 --markdown --engine ...
#   brickbench oracle laws brick_wall --set courses=10 --set columns=10 --step 0.004166666666666667
#     --duration 0.3 --stride 12 --markdown --engine ...
#   gate_power experiments/plans/gate_smoke.toml bullet/default 40 100
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

die() { echo "splice-gate: $*" >&2; exit 2; }

page=docs/gate.md
if [ $# -ne 2 ] && [ $# -ne 3 ]; then die "usage: scripts/splice-gate.sh STATICS LAWS [POWER]"; fi
for file in "$@"; do
  if ! grep -q '^|' "$file"; then die "$file has no table"; fi
done
for name in statics laws power; do
  for marker in BEGIN END; do
    if [ "$(grep -c "^<!-- $marker $name" $page)" -ne 1 ]; then
      die "$page must have one line '<!-- $marker $name -->'"
    fi
  done
done

power=
if [ $# -eq 3 ]; then
  power=$(
    echo "| engine | seeded | red | 95 % limit | named worst most often | CPU s per trial |"
    echo "|---|---|---:|---:|---|---:|"
    grep '^|' "$3"
  )
fi
new=$(mktemp docs/gate.XXXXXX)
trap 'rm -f "$new"' EXIT
STATICS=$(cat "$1") LAWS=$(cat "$2") POWER=$power awk '
  function put(text) { print; print ""; print text; print ""; skip = 1 }
  /^<!-- BEGIN statics/ { put(ENVIRON["STATICS"]); next }
  /^<!-- BEGIN laws/ { put(ENVIRON["LAWS"]); next }
  /^<!-- BEGIN power/ && ENVIRON["POWER"] != "" { put(ENVIRON["POWER"]); next }
  /^<!-- END / { skip = 0 }
  !skip' $page >"$new"
cat "$new" >$page
echo "splice-gate: $page has the tables of $*"
