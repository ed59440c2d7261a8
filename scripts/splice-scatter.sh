#!/usr/bin/env bash
# splice-scatter.sh RESULTS: puts the spread of the perturbed walls of RESULTS/rows.csv between the
# markers of docs/wall.md: per engine the runs, the final energy and the bricks displaced.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source scripts/splice.sh

rows=${1:?usage: scripts/splice-scatter.sh RESULTS-FOLDER}/rows.csv
page=docs/wall.md
if [ ! -r "$rows" ]; then die "there is no $rows"; fi
need_markers $page scatter

table=$(awk -F, '
  { gsub(/"[^"]*"/, "quoted") }
  NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
  $column["outcome"] != "ok" { next }
  {
    engine = $column["engine"] "/" $column["variant"]
    metric = $column["metric"]; value = $column["value"] + 0
    if (!(engine in seen)) { seen[engine] = 1; order[++engines] = engine }
    k = engine SUBSEP metric
    if (!(k in n) || value < least[k]) least[k] = value
    if (!(k in n) || value > most[k]) most[k] = value
    ++n[k]; sum[k] += value; square[k] += value * value
  }
  END {
    print "| engine | runs | energy_final_j, mean | standard deviation | least .. most | bricks_displaced | penetration_max_m, worst |"
    print "|---|---:|---:|---:|---:|---:|---:|"
    for (e = 1; e <= engines; ++e) {
      k = order[e] SUBSEP "energy_final_j"; b = order[e] SUBSEP "bricks_displaced"
      p = order[e] SUBSEP "penetration_max_m"
      if (n[k] < 2) exit 1
      mean = sum[k] / n[k]; spread = sqrt((square[k] - n[k] * mean * mean) / (n[k] - 1))
      printf "| %s | %d | %.0f | %.0f | %.0f .. %.0f | %d .. %d | %.2g |\n", order[e], n[k], mean,
             spread, least[k], most[k], least[b], most[b], most[p]
    }
    if (!engines) exit 1
  }' "$rows") || die "$rows has no perturbed runs"

put $page scatter <<<"$table"
echo "splice-scatter: $page has the numbers of $rows"
