#!/usr/bin/env bash
# measure-page.sh: opens two test pages in headless Chromium with software GL, four walls of 400
# bricks side by side and one of 2000 bricks, and puts size, load time and frame rate between the
# markers of docs/reports.md. Run it on a machine that does nothing else.
#
#   BUILD   the build folder; default build/release
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/splice.sh
build=${BUILD:-build/release}
page=docs/reports.md
chromium=$(command -v chromium || command -v chromium-browser) || die "Chromium is not installed"
[ -x "$build/tests/browser_make_page" ] || die "there is no $build/tests/browser_make_page; build the tests"
need_markers $page "frame rate"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$build/tests/browser_make_page" "$scratch/pages"
for name in wall many; do
  node scripts/page-facts.mjs "$chromium" "$build/reports/web" "$scratch/pages/$name/index.html" \
    >"$scratch/$name.json" || die "the page $name complains: $(cat "$scratch/$name.json")"
done
{
  printf 'Measured %s on %s (%d cores), Chromium %s with SwiftShader, 1280 x 1000 px:\n\n' \
    "$(date -u +%F)" "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" "$(nproc)" \
    "$("$chromium" --version 2>/dev/null | grep -o '[0-9][0-9.]*' | head -n 1)"
  echo "| page | size, MB | to the drawn replay, ms | frames per second while playing |"
  echo "|---|---:|---:|---:|"
  for name in wall many; do
    node -e 'const f = JSON.parse(require("fs").readFileSync(process.argv[1], "utf8"));
      const r = f.replay;
      console.log(`| ${r.views} x ${r.bodies_per_view - 2} bricks | ${(f.page_bytes / 1e6).toFixed(2)} | ` +
        `${f.load_ms} | ${r.frames_per_s} |`);' "$scratch/$name.json"
  done
} >"$scratch/table"
put $page "frame rate" <"$scratch/table"
cat "$scratch/table"
