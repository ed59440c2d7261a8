#!/usr/bin/env bash
# recorded.sh BRICKBENCH WEB_BUILD_FOLDER OUT: records a small wall in every engine, reports it, looks
# at the page in headless Chromium, and renders stills and a video of it.
# Exit status 77, with the reason, where something optional is missing.
set -euo pipefail
brickbench=$1 web=$2 out=$3/recorded
skip() { echo "skipped: $*"; exit 77; }
die() { echo "FAIL $*" >&2; exit 1; }
command -v node >/dev/null || skip "node is not installed (scripts/install-deps.sh reports)"
chromium=$(command -v chromium || command -v chromium-browser || true)
[ -n "$chromium" ] || skip "chromium is not installed (scripts/install-deps.sh reports)"
[ -d "$web/node_modules/playwright-core" ] ||
  skip "the page's modules were not installed when the program was built"
rm -rf "$out"
mkdir -p "$out"
# As long as names get.
long=$(printf 'a_wall_with_a_long_name_%.0s' 1 2 3 4 5 6 7 8 9 10 | cut -c1-100)
cat >"$out/plan.toml" <<END
title = "A small wall, recorded"
[[experiment]]
name = "$long"
scenario = "brick_wall"
engines = "all"
step_s = "1/500"
duration_s = 0.4
parameters = { courses = 3, columns = 4 }
metrics = ["energy"]
[trajectory]
every = 4
contacts = true
END
status=0
"$brickbench" run "$out/plan.toml" --out "$out/results" >"$out/run.log" 2>&1 || status=$?
if grep -q "no HDF5" "$out/run.log"; then skip "the program was built without HDF5 (libhdf5-dev)"; fi
if grep -q "matches nothing in this build" "$out/run.log"; then skip "no engine is linked"; fi
[ $status -le 1 ] || { cat "$out/run.log"; die "run ended with $status"; }

"$brickbench" report "$out/results" --out "$out/report" --no-pdf >"$out/report.log"
"$brickbench" report "$out/results" --out "$out/again" --no-pdf >"$out/report.log"
cmp "$out/report/index.html" "$out/again/index.html" || die "the same results make another page"
node "$(dirname "${BASH_SOURCE[0]}")/recorded_test.mjs" "$chromium" "$web" "$out"

video=()
if command -v ffmpeg >/dev/null; then video=(--video mp4 --fps 10 --speed 0.25); fi
"$brickbench" render "$out/results" --out "$out/pictures" --view front,top --width 480 "${video[@]}" \
  >"$out/render.log"
[ "$(find "$out/pictures" -name '*.png' -size +2k | wc -l)" -eq 2 ] || die "not two pictures"
[ "$(sha256sum "$out"/pictures/*.png | cut -c1-64 | sort -u | wc -l)" -eq 2 ] ||
  die "two sides look alike"
"$brickbench" render "$out/results" --out "$out/coloured" --colour penetration --contacts --width 480 \
  --scene "$long" >"$out/render.log"
[ "$(find "$out/coloured" -name '*three-quarter.png' -size +2k | wc -l)" -eq 1 ] || die "no coloured picture"
if "$brickbench" render "$out/results" --out "$out/none" --scene nobody 2>"$out/none.err"; then
  die "a scene that is not there is drawn"
fi
grep -q "no such scene; here are: $long" "$out/none.err" || die "$(cat "$out/none.err")"
echo "ok   renders two sides, colours and contact points, and long names"
if [ ${#video[@]} -eq 0 ]; then
  echo "not tried: video (ffmpeg is not installed)"
  exit 0
fi
for file in "$out"/pictures/*.mp4; do
  frames=$(ffprobe -v error -count_frames -select_streams v:0 \
    -show_entries stream=nb_read_frames -of csv=p=0 "$file")
  # 0.4 s at a quarter of the speed and ten frames a second, and the start.
  [ "$frames" -ge 16 ] && [ "$frames" -le 17 ] || die "$frames frames in the video, not 17"
done
echo "ok   films $frames frames of each side"
