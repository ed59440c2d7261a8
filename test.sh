#!/usr/bin/env bash
# test.sh [OPTION...]: installs what is missing, builds, runs the unit tests under the address and
# undefined-behaviour sanitizers, and all others as released. Options go to both, for example -R Wall.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source scripts/build.sh

scripts/install-deps.sh build engines tests
configure release -DBRICKBENCH_TESTS=ON -DBRICKBENCH_UNIT_TESTS=OFF
build release
configure asan
build asan unit_tests

# Chosen tests may all be of one kind; all tests are never none.
strict=()
if [ $# -eq 0 ]; then strict=(--no-tests=error); fi
step "unit tests under the sanitizers"
ctest --preset asan -L '^unit$' -j "$jobs" "${strict[@]}" "$@"
step "all other tests"
exec ctest --preset release -j "$jobs" "${strict[@]}" "$@"
