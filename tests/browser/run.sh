#!/usr/bin/env bash
# run.sh MAKE_PAGE WEB_BUILD_FOLDER OUT: makes the test pages and opens them in headless Chromium.
# Exit status 77, with the reason, where something optional is missing.
set -euo pipefail
make_page=$1 web=$2 out=$3
skip() { echo "skipped: $*"; exit 77; }
command -v node >/dev/null || skip "node is not installed (scripts/install-deps.sh reports)"
chromium=$(command -v chromium || command -v chromium-browser || true)
[ -n "$chromium" ] || skip "chromium is not installed (scripts/install-deps.sh reports)"
[ -d "$web/node_modules/playwright-core" ] ||
  skip "the page's modules were not installed when the program was built"
"$make_page" "$out/pages"
mkdir -p "$out/screenshots"
exec node "$(dirname "${BASH_SOURCE[0]}")/page_test.mjs" "$chromium" "$web" "$out"
