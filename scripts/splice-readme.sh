#!/usr/bin/env bash
# splice-readme.sh RESULTS: puts the numbers of the first scene of RESULTS/report.md between the
# markers of README.md: one row per engine, the columns below, and what made them. Nothing is
# retyped; README.md stays as it was if the report lacks a column.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/splice.sh
columns='energy_final_j,energy_created_j,linear_momentum_error_relative,penetration_max_m,bricks_displaced,median ms'

report=${1:?usage: scripts/splice-readme.sh RESULTS-FOLDER}/report.md
if [ ! -r "$report" ]; then die "there is no $report"; fi
need_markers README.md results

table=$(awk -F '|' -v wanted="$columns" '
  function trimmed(text) { gsub(/^ +| +$/, "", text); return text }
  /^## / {
    ++section
    if (!scene && /step/) { scene = substr($0, 4); inside = section }
    cost = /^## Cost/
  }
  # What a "!" in the table means.
  /^- ! / && inside && section == inside && !($0 in told) { told[$0] = 1; flags = flags $0 "\n" }
  /^on .* revision / { made = $0 }
  /^\|/ && ((inside && section == inside) || cost) {
    if (!in_table) {
      for (i = 2; i < NF; ++i) name[i] = trimmed($i)
      in_table = 1
    } else if ($2 !~ /^-+:?$/) {
      engine = trimmed($2)
      if (!(engine in seen)) { seen[engine] = 1; order[++engines] = engine }
      for (i = 3; i < NF; ++i)
        if (!((engine, name[i]) in value)) value[engine, name[i]] = trimmed($i)
    }
    next
  }
  { in_table = 0 }
  END {
    if (!scene || !engines) exit 1
    n = split(wanted, column, ",")
    head = "| engine |"; rule = "|---|"
    for (c = 1; c <= n; ++c) { head = head " " column[c] " |"; rule = rule "---:|" }
    print scene ":\n"; print head; print rule
    for (e = 1; e <= engines; ++e) {
      line = "| " order[e] " |"
      # Costs of an engine that did not run this scene are those of another scene.
      ran = value[order[e], column[1]] ~ /[0-9]/
      for (c = 1; c <= n; ++c) {
        here = (order[e], column[c]) in value && (ran || value[order[e], column[c]] !~ /[0-9]/)
        if (here) found[column[c]] = 1
        line = line " " (here ? value[order[e], column[c]] : "-") " |"
      }
      print line
    }
    for (c = 1; c <= n; ++c) if (!(column[c] in found)) exit 1
    if (flags) printf "\n%s", flags
    print "\nBest in bold, worst in italics; measured " made
  }' "$report") || die "$report has no scene with the columns $columns"

put README.md results <<<"$table"
echo "splice-readme: README.md has the numbers of $report"
