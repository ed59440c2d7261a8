#!/usr/bin/env bash
# splice-performance.sh: puts the recorded timings of reports/published/performance/*.json between
# the markers of docs/performance.md, one table per marker. Nothing is retyped. Needs jq.
#
# Record them first, each on a machine as quiet as can be had:
#   build/cli/brickbench bench --plan experiments/plans/performance.toml --json \
#     | scripts/splice-performance.sh --record performance
# Several runs (--only EXPERIMENT each) may follow each other on standard input.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
page=docs/performance.md
folder=reports/published/performance

die() { echo "splice-performance: $*" >&2; exit 2; }
command -v jq >/dev/null || die "needs jq (Debian package jq)"

if [ "${1:-}" = --record ]; then
  name=${2:?usage: splice-performance.sh --record NAME <bench.json}
  mkdir -p "$folder"
  # Folders of whoever ran it are nobody's business.
  jq -s '.[0] + {entries: map(.entries) | add} | .provenance.plan |= (split("/") | last)
         | .provenance.command |= (sub("^[^ ]+"; "brickbench") | gsub(" [/.][^ ]*/"; " "))' >"$folder/$name.json.new" ||
    die "standard input is not the output of brickbench bench --json"
  mv "$folder/$name.json.new" "$folder/$name.json"
  echo "splice-performance: recorded $folder/$name.json"
  exit 0
fi

# Numbers with three digits, times in ms.
program='
  def digits: if . == null then "-" elif . == 0 then "0"
    else pow(10; 2 - (fabs | log10 | floor)) as $scale | (. * $scale | round) / $scale | tostring end;
  def value($name): .accuracy[$name] | digits;
  def knobs: if (.knobs | length) == 0 then "" else
    " (" + ([.knobs | to_entries[] | "\(.key) \(.value)"] | join(", ")) + ")" end;
  def spread: if . == null then "-" else
    "\(.median | digits) (\(.least | digits)..\(.most | digits))" end;
  def milliseconds: if . == null then "-" else .median * 1000 | digits end;
  "| experiment | engine | ms per step | over \(.base) | moved furthest, m | deepest overlap, m | overlap at the end, m | rms speed at the end, m/s | bricks moved | rounds | outcome |",
  "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---|",
  (.entries[] | "| \(.experiment) | `\(.engine)`\(knobs)\(if .is_base then ", base" else "" end) | \(.step_cpu_s | milliseconds) | \(.ratio_to_base | spread) | \(value("brick_displacement_max_m")) | \(value("penetration_max_m")) | \(value("penetration_final_m")) | \(value("brick_speed_rms_mps")) | \(value("bricks_displaced")) | \(.rounds) | \(.outcome)\(if .repeatable then "" else ", not repeatable" end) |"),
  "",
  "Medians over the rounds, CPU time of the stepping thread; (least..most) of the ratios. \(.provenance.machine | "\(.cpu), \(.cores) cores, revision \(.revision | .[0:12])"), \(.provenance.date_utc)."'

for record in "$folder"/*.json; do
  name=$(basename "$record" .json)
  for marker in BEGIN END; do
    [ "$(grep -c "^<!-- $marker $name " "$page")" -eq 1 ] ||
      die "$page must have one line '<!-- $marker $name -->'"
  done
  table=$(jq -r "$program" "$record") || die "$record is not the output of brickbench bench --json"
  new=$(mktemp "$page.XXXXXX")
  TABLE=$table NAME=$name awk '
    $0 ~ "^<!-- BEGIN " ENVIRON["NAME"] " " { print; print ""; print ENVIRON["TABLE"]; print ""; skip = 1; next }
    $0 ~ "^<!-- END " ENVIRON["NAME"] " " { skip = 0 }
    !skip' "$page" >"$new"
  mv "$new" "$page"
  echo "splice-performance: $page has the numbers of $record"
done
