#!/usr/bin/env bash
# quickstart.sh [OPTION...]: from a fresh clone to all engines on one brick wall.
#
# Installs what is missing, builds the program and runs experiments/plans/brick_wall.toml on every
# engine that is linked. Options go to `brickbench run`, for example --set duration_s=0.5.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source scripts/build.sh

scripts/install-deps.sh build engines
configure release -DBRICKBENCH_TESTS=OFF
build release brickbench
exec build/release/brickbench run experiments/plans/brick_wall.toml "$@"
