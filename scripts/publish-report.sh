#!/usr/bin/env bash
# publish-report.sh [OUT]: runs the plan `published`, checks all exact cases in all variants of all
# engines, and makes reports/published/<today>/ of it: the page, the rows, the table of exact cases,
# pictures, videos of the hit 10x10 wall from four sides, and facts.json with the page's size, load
# time and frame rate in headless Chromium with software GL. Needs no hand. What is too large to
# commit (trajectories, series, the figures as files) stays out; the plan makes it again.
#
#   OUT         instead of reports/published/<today>; an existing folder is replaced at the end
#   BRICKBENCH  the program; default build/release/brickbench
#   WEB         the page's modules; default build/release/reports/web
#   RESULTS     a folder with an earlier run/, cases/ and orders/; these are then used, not made
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=${1:-reports/published/$(date -u +%F)}
brickbench=${BRICKBENCH:-build/release/brickbench}
web=${WEB:-$(dirname "$brickbench")/reports/web}
most_kb=8000
die() { echo "publish-report: $*" >&2; exit 1; }
note() { printf '== %s (%d s)\n' "$*" "$SECONDS" >&2; }
[ -x "$brickbench" ] || die "there is no program $brickbench; build it, or name it with BRICKBENCH="
[ -d "$web/node_modules/playwright-core" ] || die "no page modules in $web; see docs/reports.md"
chromium=$(command -v chromium || command -v chromium-browser) || die "Chromium is not installed"
command -v ffmpeg >/dev/null || die "ffmpeg is not installed"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
results=${RESULTS:-$scratch}
# A failed case or an excluded cell is what the report is there to show; a broken run is not.
shows() {
  local status=0
  "$@" >>"$scratch/log" 2>&1 || status=$?
  [ $status -le 1 ] || { tail -n 20 "$scratch/log" >&2; die "$2 ended with status $status"; }
}
if [ ! -d "$results/run" ]; then
  note "run the plan"
  shows "$brickbench" run experiments/plans/published.toml --out "$results/run"
fi
if [ ! -d "$results/cases" ]; then
  note "exact cases in all variants"
  shows "$brickbench" validate --engine '*/*' --out "$results/cases"
fi
if [ ! -d "$results/orders" ]; then
  note "orders of convergence"
  shows "$brickbench" validate --order --engine all --out "$results/orders"
fi

note "page"
shows "$brickbench" report "$results/run" "$results/cases" "$results/orders" --no-pdf \
  --out "$scratch/report"
note "pictures and facts of the page"
mkdir "$scratch/report/pictures"
node scripts/page-facts.mjs "$chromium" "$web" "$scratch/report/index.html" \
  "$scratch/report/pictures" >"$scratch/facts.json" || die "the page complains: $(cat "$scratch/facts.json")"
note "videos of the 10x10 wall"
shows "$brickbench" render "$results/run" --scene hit_10 --view front,side,top,three-quarter \
  --video mp4 --fps 20 --width 960 --out "$scratch/videos"
mkdir "$scratch/report/videos"
cp "$scratch"/videos/*.mp4 "$scratch/report/videos/"

# The figures are in the page; as files they are many, and whoever wants them has the plan.
sed -i -E -e 's#href="figures/validation.csv"#href="validation.csv"#' \
  -e 's#<a href="figures/[^"]*\.(svg|csv)">(SVG|CSV)</a> ?##g' "$scratch/report/index.html"
cp "$scratch/report/figures/validation.csv" "$scratch/"
rm -r "$scratch/report/figures"
mv "$scratch/validation.csv" "$scratch/report/"

cp "$results/run/"{plan.toml,provenance.json,rows.csv,timings.csv} "$scratch/report/"
# Folders of whoever made it are nobody's business.
sed -i -e "s#$brickbench#brickbench#g; s#$results/##g; s#$scratch/##g" \
  "$scratch/report/"{index.html,report.md,provenance.json}
kb_of() { du -sk --apparent-size "$1" | cut -f1; }
kb=$(kb_of "$scratch/report")
{
  printf '{\n"folder_kb": %d,\n"videos_kb": %d,\n"page": ' "$kb" \
    "$(kb_of "$scratch/report/videos")"
  cat "$scratch/facts.json"
  printf '}\n'
} >"$scratch/report/facts.json"
[ "$kb" -le $most_kb ] || die "the report has $kb kB, more than $most_kb"
cat >"$scratch/report/README.md" <<END
# Walls and towers, recorded on $(date -u +%F)

\`index.html\` is the page (open it from the disk), \`report.md\` the same as text. \`plan.toml\` made
the runs; \`rows.csv\` and \`timings.csv\` are their numbers, \`validation.csv\` those of the exact cases.
\`facts.json\`: the page's size, load time and frame rate in headless Chromium with software GL, on the
machine that \`provenance.json\` names. Made by \`scripts/publish-report.sh\`; the figures as SVG, PDF
and CSV are made by \`brickbench report\` from the runs, and left out here for their number.

$(cd "$scratch/report" && for video in videos/*.mp4; do echo "- [$video]($video)"; done)

![The page](pictures/desktop.jpg)
END
rm -rf "$out"
mkdir -p "$(dirname "$out")"
cp -r "$scratch/report" "$out"
note "done: $out, $kb kB"
cat "$out/facts.json"
