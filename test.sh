#!/usr/bin/env bash
# test.sh [OPTION...]: installs what is missing, builds, runs every test; the unit tests named below
# also under the address and undefined-behaviour sanitizers, and all of them with SANITIZE=all in the
# environment. Options go to the last ctest, for example -R Wall.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source scripts/build.sh

sanitized=(unit_seam unit_scenarios unit_run unit_ourengine_dynamics unit_ourengine_baraff)
if [ "${SANITIZE:-}" = all ]; then sanitized=(unit_tests); fi

scripts/install-deps.sh build engines tests
configure release -DBRICKBENCH_TESTS=ON
build release
configure asan
build asan "${sanitized[@]}"

step "unit tests under the sanitizers"
if [ "${SANITIZE:-}" = all ]; then chosen='^unit_'; else chosen="^($(IFS='|'; echo "${sanitized[*]}"))\\."; fi
ctest --preset asan -L '^unit$' -R "$chosen" -j "$jobs" --no-tests=error
step "all tests"
exec ctest --preset release -j "$jobs" --no-tests=error "$@"
