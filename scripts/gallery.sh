#!/usr/bin/env bash
# gallery.sh [RESULTS]: makes docs/images/hit-wall.png, the picture of the README, from recorded
# motion: every engine at the same moment of the hit 10x10 wall, side by side.
#
#   RESULTS     a results folder of the plan `gallery`; without one the plan is run first
#   BRICKBENCH  the program; default build/release/brickbench
#   TIME_S      the moment, s; default 0.45
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
brickbench=${BRICKBENCH:-build/release/brickbench}
most_bytes=300000
die() { echo "gallery: $*" >&2; exit 1; }
[ -x "$brickbench" ] || die "there is no program $brickbench; build it, or name it with BRICKBENCH="

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
results=${1:-}
if [ -z "$results" ]; then
  results=$scratch/results
  "$brickbench" run gallery --out "$results" >"$scratch/run.log" || die "the plan gallery failed"
fi
"$brickbench" render "$results" --out "$scratch/pictures" --view three-quarter --width 1000 \
  --time "${TIME_S:-0.45}" >"$scratch/render.log"
pictures=("$scratch"/pictures/*.png)
[ ${#pictures[@]} -eq 1 ] || die "${#pictures[@]} scenes in '$results', not one"
bytes=$(stat -c %s "${pictures[0]}")
[ "$bytes" -le $most_bytes ] || die "the picture has $bytes bytes, more than $most_bytes"
mkdir -p docs/images
cp "${pictures[0]}" docs/images/hit-wall.png
echo "gallery: docs/images/hit-wall.png, $bytes bytes"
