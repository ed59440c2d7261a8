#!/usr/bin/env bash
# splice-cli.sh [BRICKBENCH]: puts the verbs and options of the program between the markers of docs/cli.md, as
# `brickbench list verbs` tells them. Nothing is retyped.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source scripts/splice.sh

program=${1:-build/release/brickbench}
page=docs/cli.md
if [ ! -x "$program" ]; then die "there is no program $program"; fi
need_markers $page verbs

# "verb: meaning", "  options", "    --name KIND: meaning".
"$program" list verbs | awk '
  /^[a-z]/ {
    name = $0; sub(/: .*/, "", name); meaning = $0; sub(/^[^:]*: /, "", meaning)
    if (seen) print ""
    seen = 1
    print "### " name "\n\n" meaning "."; fresh = 1; next
  }
  /^    / {
    if (fresh) { print "\n| option | meaning |\n|---|---|"; fresh = 0 }
    at = index($0, ": ")
    option = substr($0, 1, at - 1); sub(/^ */, "", option)
    meaning = substr($0, at + 2); gsub(/\|/, "\\|", meaning)
    print "| `" option "` | " meaning " |"
  }' | put $page verbs
echo "splice-cli: $page has $(grep -c '^### ' $page) verbs"
