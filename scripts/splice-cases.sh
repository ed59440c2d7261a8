#!/usr/bin/env bash
# splice-cases.sh [BRICKBENCH [SELECTOR...]]: runs the exact cases and puts each case's table into its
# section of docs/cases.md, and who was measured when between that page's markers. Without selectors:
# every engine's default variant and the other laws of ourengine. Each case also gets a drawing of its start,
# docs/figures/cases/ID.start.svg, and a figure of the same numbers, ID.svg. Nothing is retyped.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source scripts/splice.sh

program=${1:-build/release/brickbench}
shift || true
selectors=("$@")
if [ ${#selectors[@]} -eq 0 ]; then selectors=(all ourengine/fast ourengine/baraff); fi
page=docs/cases.md
if [ ! -x "$program" ]; then die "there is no program $program"; fi
need_markers $page measured

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
options=()
for selector in "${selectors[@]}"; do options+=(--engine "$selector"); done
"$program" validate "${options[@]}" >"$scratch/table" 2>/dev/null || [ $? -eq 1 ] ||
  die "validate did not run"
versions=$("$program" list engines | sed -n 's/^\([a-z]*\): \(.*\)$/\1 \2/p' | paste -sd ';' | sed 's/;/; /g')

# A line of the table: case, engine, verdict, error, explained, unexplained, how to run it again.
# ok: follows its scheme; open: nothing predicts it; beyond: an open question.
awk '$1 ~ /^[a-z_]+\.[a-z0-9_]+$/ && $2 ~ "/" {
       printf "%s\t| %s | %s | %s | %s | %s |\n", $1, $2, $3, $4, $5, $6 }' \
  "$scratch/table" >"$scratch/lines"
if [ ! -s "$scratch/lines" ]; then die "validate printed no cases"; fi

awk -F '\t' '
  FNR == NR { lines[$1] = lines[$1] $2 "\n"; next }
  /^## [a-z_]+\.[a-z0-9_]+:/ {
    id = $0; sub(/^## /, "", id); sub(/:.*/, "", id)
    print; print "\n![" id " at its start](figures/cases/" id ".start.svg)"; next
  }
  /^!\[.* at its start\]\(figures\/cases\// { getline; next }
  /^\| engine \| / && id != "" {
    if (!(id in lines)) { print "no measurement of " id > "/dev/stderr"; exit 1 }
    print "| engine | verdict | error | explained | unexplained |"
    print "|---|---|---:|---:|---:|"
    printf "%s", lines[id]
    done_with[id] = 1; shown = id; id = ""; table = 1; next
  }
  table && /^\|/ { next }
  table { print ""; print "![" shown "](figures/cases/" shown ".svg)"; table = 0; print; next }
  /^!\[.*\]\(figures\/cases\// { getline; next }
  { print }
  END {
    if (table) print "\n![" shown "](figures/cases/" shown ".svg)"
    for (id in lines) if (!(id in done_with)) { print "no section for " id > "/dev/stderr"; exit 1 }
  }
' "$scratch/lines" $page >"$scratch/page" || die "$page and the catalogue differ"
cat "$scratch/page" >$page

figures=docs/figures/cases
mkdir -p $figures
"$program" validate --figures "$scratch/starts" || die "the cases were not drawn"
for start in "$scratch"/starts/*.svg; do
  cp "$start" "$figures/$(basename "${start%.svg}").start.svg"
done
cut -f 1 "$scratch/lines" | sort -u | while read -r id; do
  awk -F '\t' -v id="$id" '$1 == id { print $2 }' "$scratch/lines" | sed 's/^| //; s/ |$//; s/ | /\t/g' |
    awk -v id="$id" -f scripts/case-figure.awk >"$figures/$id.svg"
done
put $page measured <<<"$(measured "$program") $versions."
echo "splice-cases: $page has $(wc -l <"$scratch/lines") measured cells"
