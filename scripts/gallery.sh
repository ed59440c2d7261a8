#!/usr/bin/env bash
# gallery.sh [RESULTS]: makes docs/images/, the pictures of docs/gallery.md and of the README, from
# recorded motion: every engine at the same moment of the same scene, side by side.
#
#   RESULTS     a results folder of the plan `gallery`; without one the plan is run first
#   BRICKBENCH  the program; default build/release/brickbench
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
brickbench=${BRICKBENCH:-build/release/brickbench}
most_bytes=150000
die() { echo "gallery: $*" >&2; exit 1; }
[ -x "$brickbench" ] || die "there is no program $brickbench; build it, or name it with BRICKBENCH="
command -v ffmpeg >/dev/null || die "ffmpeg is not installed"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
results=${1:-}
if [ -z "$results" ]; then
  results=$scratch/results
  status=0
  "$brickbench" run gallery --out "$results" >"$scratch/run.log" || status=$?
  [ $status -le 1 ] || die "the plan gallery ended with status $status"
fi
mkdir -p docs/images

# small FROM NAME: the picture as docs/images/NAME in 200 colours.
small() {
  ffmpeg -loglevel error -y -i "$1" -vf \
    "split[a][b];[a]palettegen=max_colors=200:stats_mode=full[p];[b][p]paletteuse=dither=none" \
    -frames:v 1 "docs/images/$2"
  local bytes
  bytes=$(stat -c %s "docs/images/$2")
  [ "$bytes" -le $most_bytes ] || die "docs/images/$2 has $bytes bytes, more than $most_bytes"
  echo "gallery: docs/images/$2, $bytes bytes"
}

# picture NAME SCENE TIME [RENDER-OPTION...]
picture() {
  local name=$1 scene=$2 time=$3
  shift 3
  "$brickbench" render "$results" --scene "$scene" --time "$time" --width 960 "$@" \
    --out "$scratch/$name" >"$scratch/render.log" || die "no picture of $scene"
  small "$scratch/$name/"*.png "$name.png"
}

picture hit-wall hit_wall 0.45
picture hit-wall-contacts hit_wall 0.12 --view front --contacts
picture leaning-tower leaning_tower 0.8 --view front --colour speed
picture kapla-penetration kapla 0.9 --colour penetration
picture explosion explosion 0.2 --colour speed
"$brickbench" report "$results" --out "$scratch/report" --no-pdf >"$scratch/report.log"
cp "$scratch"/report/figures/time-hit_wall-*-total_energy_j.svg docs/images/hit-wall-energy.svg
echo "gallery: docs/images/hit-wall-energy.svg, $(stat -c %s docs/images/hit-wall-energy.svg) bytes"
