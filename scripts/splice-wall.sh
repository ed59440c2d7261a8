#!/usr/bin/env bash
# splice-wall.sh: puts the hit walls between the markers of docs/wall.md: `scatter` from
# reports/published/wall_scatter (final energy and bricks displaced per engine), `hits` from
# reports/published/hit_scatter (bricks moved per step, engine and iterations), `slow` from
# reports/published/brick_wall_slow (the engines that the README leaves out); and between the markers `blows` of
# docs/contact.md from reports/published/many_blows.
# splice-wall.sh --measure [PROGRAM [PLAN...]]: runs the plans of these names, or those named, first
# and keeps their rows there. PROGRAM: default build/release/brickbench. An hour and a half on two idle
# cores; results do not depend on the load.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source scripts/splice.sh

if [ "${1:-}" = --measure ]; then
  program=${2:-build/release/brickbench}
  plans=("${@:3}")
  if [ ${#plans[@]} -eq 0 ]; then plans=(wall_scatter hit_scatter many_blows brick_wall_slow); fi
  work=$(mktemp -d "${TMPDIR:-/tmp}/scatter.XXXXXX")
  trap 'rm -rf "$work"' EXIT
  for plan in "${plans[@]}"; do
    "$program" sweep run "experiments/plans/$plan.toml" --out "$work/$plan-cells" --time-limit 0 || [ $? -eq 1 ]
    "$program" sweep merge "$work/$plan-cells" --out "$work/$plan" || [ $? -eq 1 ]
    mkdir -p "reports/published/$plan"
    for file in rows.csv plan.toml provenance.json; do
      [ -r "$work/$plan/$file" ] || die "the merged sweep has no $file"
      # Folders of whoever ran it are nobody's business.
      sed "s|$work/||g; s|\"command\": \"[^ ]*|\"command\": \"brickbench|" "$work/$plan/$file" \
        >"reports/published/$plan/$file"
    done
  done
elif [ $# -ne 0 ]; then
  die "usage: scripts/splice-wall.sh [--measure [PROGRAM [PLAN...]]]"
fi
page=docs/wall.md
need_markers $page scatter
need_markers $page hits
need_markers $page slow
contact=docs/contact.md
need_markers $contact blows

# What the tables share: the columns by name, and whether a row tells a number that counts. Rows that do not are
# counted by their outcome, or as flagged: "!".
shared='
  function field(name) { return (name in column) ? $column[name] : "" }
  function said() { return field("validity") != "" ? "flagged (!)" : field("outcome") }
  # That a metric does not apply says nothing of the run.
  function counts(    word) {
    word = said()
    if (word == "ok") return 1
    if (word != "not_applicable" && !((word, field("cell")) in told)) { told[word, field("cell")] = 1; ++left[word] }
    return 0
  }
  function tell_left(    word, text) {
    for (word in left) text = text (text == "" ? "" : ", ") left[word] " " word
    if (text != "") printf "\nRuns that are left out: %s.\n", text
  }
  { gsub(/"[^"]*"/, "quoted") }
  NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
'

rows=reports/published/wall_scatter/rows.csv
if [ ! -r "$rows" ]; then die "there is no $rows"; fi
table=$(awk -F, "$shared"'
  !counts() { next }
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
    tell_left()
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

rows=reports/published/hit_scatter/rows.csv
if [ ! -r "$rows" ]; then die "there is no $rows"; fi
table=$(awk -F, "$shared"'
  !counts() { next }
  {
    engine = $column["engine"] "/" $column["variant"]
    if (match($column["axes"], /knob\.iterations=[0-9]+/)) {
      engine = engine ", " substr($column["axes"], RSTART + 16, RLENGTH - 16) " iterations"
    }
    who = $column["step_s"] SUBSEP engine
    if (!(who in seen)) { seen[who] = 1; order[++rows] = who }
    value = $column["value"] + 0
    if ($column["metric"] == "bricks_displaced") moved[who, ++runs[who]] = value
    if ($column["metric"] == "penetration_max_m" && value > deepest[who]) deepest[who] = value
  }
  END {
    if (!rows) exit 1
    print "| step | engine | runs | bricks moved: median | least .. most | deepest overlap, mm |"
    print "|---|---|---:|---:|---:|---:|"
    for (r = 1; r <= rows; ++r) {
      who = order[r]; n = runs[who]
      for (i = 2; i <= n; ++i) {
        for (j = i; j > 1 && moved[who, j - 1] > moved[who, j]; --j) {
          swap = moved[who, j]; moved[who, j] = moved[who, j - 1]; moved[who, j - 1] = swap
        }
      }
      median = (moved[who, int((n + 1) / 2)] + moved[who, int(n / 2) + 1]) / 2
      split(who, part, SUBSEP)
      printf "| 1/%.0f s | %s | %d | %g | %d .. %d | %.2g |\n", 1 / part[1], part[2], n, median,
             moved[who, 1], moved[who, n], 1e3 * deepest[who]
    }
    tell_left()
  }' "$rows") || die "$rows has no perturbed runs"
put $page hits <<<"$table"

rows=reports/published/brick_wall_slow/rows.csv
if [ ! -r "$rows" ]; then die "there is no $rows"; fi
table=$(awk -F, "$shared"'
  {
    engine = $column["engine"] "/" $column["variant"]
    word = said()
    if (!(engine in outcome)) { order[++engines] = engine; outcome[engine] = "ok" }
    if (word != "ok" && word != "not_applicable") outcome[engine] = word
    if ($column["value"] != "") value[engine, $column["metric"]] = $column["value"]
  }
  END {
    count = split("energy_final_j energy_created_j linear_momentum_error_relative penetration_max_m bricks_displaced", metric, " ")
    head = "| engine |"; rule = "|---|"
    for (m = 1; m <= count; ++m) { head = head " " metric[m] " |"; rule = rule "---:|" }
    print head " outcome |"; print rule "---|"
    for (e = 1; e <= engines; ++e) {
      line = "| " order[e] " |"
      for (m = 1; m <= count; ++m) {
        line = line ((order[e], metric[m]) in value ? sprintf(" %.4g |", value[order[e], metric[m]]) : " - |")
      }
      print line " " outcome[order[e]] " |"
    }
    if (!engines) exit 1
  }' "$rows") || die "$rows has no runs"
put $page slow <<<"$table"

rows=reports/published/many_blows/rows.csv
if [ ! -r "$rows" ]; then die "there is no $rows"; fi
table=$(awk -F, "$shared"'
  $column["metric"] != "penetration_max_m" { next }
  {
    axes = $column["axes"]
    match(axes, /courses=[0-9]+/); courses = substr(axes, RSTART + 8, RLENGTH - 8)
    match(axes, /speed_mps=[0-9]+/); speed = substr(axes, RSTART + 10, RLENGTH - 10)
    who = speed SUBSEP courses
    if (!(who in runs)) order[++walls] = who
    ++runs[who]
    if (said() != "ok") { ++failed[who]; next }
    deep[who, ++n[who]] = $column["value"] + 0
  }
  END {
    if (!walls) exit 1
    print "| speed of the brick, m/s | courses | blows | failed or flagged | deepest overlap, mm: median | worst |"
    print "|---:|---:|---:|---:|---:|---:|"
    for (speed = 20; speed <= 200; speed *= 10) for (w = 1; w <= walls; ++w) {
      split(order[w], part, SUBSEP)
      if (part[1] != speed) continue
      who = order[w]
      for (i = 2; i <= n[who]; ++i) {
        for (j = i; j > 1 && deep[who, j - 1] > deep[who, j]; --j) {
          swap = deep[who, j]; deep[who, j] = deep[who, j - 1]; deep[who, j - 1] = swap
        }
      }
      median = (deep[who, int((n[who] + 1) / 2)] + deep[who, int(n[who] / 2) + 1]) / 2
      printf "| %d | %d | %d | %d | %.2g | %.2g |\n", speed, part[2], runs[who], failed[who], 1e3 * median, 1e3 * deep[who, n[who]]
    }
  }' "$rows") || die "$rows has no blows"
put $contact blows <<<"$table"
echo "splice-wall: $page and $contact have the numbers of reports/published/{wall_scatter,hit_scatter,brick_wall_slow,many_blows}"
