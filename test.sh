#!/usr/bin/env bash
# test.sh [OPTION...]: installs what is missing, builds, runs the unit tests under the address and
# undefined-behaviour sanitizers, then every test. Options go to the last ctest, for example -R Wall.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source scripts/build.sh

scripts/install-deps.sh build engines tests
configure release -DBRICKBENCH_TESTS=ON
build release
configure asan
build asan unit_tests

step "unit tests under the sanitizers"
ctest --preset asan -L '^unit$' -j "$jobs" --no-tests=error
step "all tests"
exec ctest --preset release -j "$jobs" --no-tests=error "$@"
