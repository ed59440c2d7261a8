#!/usr/bin/env bash
# splice-scatter.sh RESULTS: puts the spread of the perturbed walls of RESULTS/rows.csv between the
# markers of docs/wall.md: per engine the runs, the final energy and the bricks displaced.
# splice-scatter.sh --measure [PROGRAM]: runs experiments/plans/wall_scatter.toml first and keeps its rows in
# reports/published/wall_scatter. PROGRAM: default build/release/brickbench. Five to ten minutes on two idle
# cores; results do not depend on the load.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source scripts/splice.sh

results=${1:?usage: scripts/splice-scatter.sh RESULTS-FOLDER or --measure [PROGRAM]}
if [ "$results" = --measure ]; then
  program=${2:-build/release/brickbench}
  results=reports/published/wall_scatter
  work=$(mktemp -d "${TMPDIR:-/tmp}/wall-scatter.XXXXXX")
  trap 'rm -rf "$work"' EXIT
  "$program" sweep run experiments/plans/wall_scatter.toml --out "$work/cells"
  "$program" sweep merge "$work/cells" --out "$work/merged"
  for file in rows.csv plan.toml provenance.json; do
    [ -r "$work/merged/$file" ] || die "the merged sweep has no $file"
    # Folders of whoever ran it are nobody's business.
    sed "s|$work/||g; s|\"command\": \"[^ ]*|\"command\": \"brickbench|" "$work/merged/$file" >"$results/$file"
  done
fi
rows=$results/rows.csv
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
    # Welch: the difference of two means beside its standard error.
    a = "ourengine/fast" SUBSEP "energy_final_j"; b = "ourengine/exact" SUBSEP "energy_final_j"
    if (n[a] > 1 && n[b] > 1) {
      difference = sum[a] / n[a] - sum[b] / n[b]
      error = sqrt((square[a] - sum[a] ^ 2 / n[a]) / (n[a] - 1) / n[a] + (square[b] - sum[b] ^ 2 / n[b]) / (n[b] - 1) / n[b])
      printf "\nFinal energy of `ourengine/fast` less that of `ourengine/exact`: %.0f J, with a standard error of %.0f J: %s.\n",
             difference, error, (difference ^ 2 > 9 * error ^ 2) ? "a difference" : "less than three standard errors, so no difference is shown"
    }
  }' "$rows") || die "$rows has no perturbed runs"

put $page scatter <<<"$table"
echo "splice-scatter: $page has the numbers of $rows"
