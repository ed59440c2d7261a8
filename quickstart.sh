#!/usr/bin/env bash
# quickstart.sh [OPTION...]: from a fresh clone to all engines on one brick wall.
#
# Installs what is missing, builds the program, runs experiments/plans/quick_look.toml in every
# engine that is linked, and makes a page of it. Options go to `brickbench run`, for example
# --set projectile_speed_mps=15. Results are kept below results/, each run in a folder of its own.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source scripts/build.sh

scripts/install-deps.sh build engines
configure release -DBRICKBENCH_TESTS=OFF
build release brickbench
program=build/release/brickbench
results=results/quickstart-$(date +%Y%m%d-%H%M%S)
step "throw a brick at a wall in every engine"
$program run quick_look --out "$results" "$@"
step "make a page of it"
$program report "$results" --out "$results/page" >/dev/null
cat <<END

Open $results/page/index.html in a browser: the wall, the table, who is right.
Next:
  $program run brick_wall                  the large wall, some minutes
  $program validate                        every engine against cases with a known answer
  $program list plans                      what else there is to run
END
if ! command -v node >/dev/null 2>&1; then
  echo "  scripts/install-deps.sh reports && ./quickstart.sh    the page with the motion in 3D (needs Node)"
fi
