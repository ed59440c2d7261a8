#!/usr/bin/env bash
# splice-performance.sh: puts the recorded measurements of reports/published/performance/*.json
# between the markers of docs/performance.md. Nothing is retyped. Needs python3.
#
# splice-performance.sh --measure [BUILD_DIR [PART...]]: measures first, all parts or those named: contact,
# engine, kapla, performance, standing_walls. BUILD_DIR: default build/release; what is missing there is
# built. About ten minutes on an idle machine of two cores; on a busy one the numbers are those of a busy one,
# and the load stands with them.
#
# PERFORMANCE_TRY=1: everything much shorter, into a folder of its own and a copy of the page, to see
# that it works.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/splice.sh

folder=reports/published/performance
page=docs/performance.md
try=()
repetitions=3
if [ -n "${PERFORMANCE_TRY:-}" ]; then
  folder=$(mktemp -d "${TMPDIR:-/tmp}/performance-try.XXXXXX")
  cp $page "$folder/performance.md"
  page=$folder/performance.md
  try=(--repeat 1 --set duration_s=0.1)
  repetitions=1
fi

# The parts; each prints JSON.
benchmark() {
  echo "$build/ourengine_$1_benchmark" "--benchmark_filter=$2" --benchmark_format=json \
    --benchmark_repetitions=$repetitions --benchmark_enable_random_interleaving=true
}
bench() {
  echo "$program" bench --plan "experiments/plans/$1.toml" --json --out "$results/$1-${*: -1}" "${@:2}" "${try[@]}"
}
our_walls() { # the largest is left to the soft steps: the others need many minutes for it
  echo "$(bench standing_walls --engine ourengine/fast --engine ourengine/exact --only "$1") --and"
}
command_of() {
  case $1 in
    contact) benchmark contact '^(frictionless.*seed1|friction_at_rest|slipping_impact.*to[36]digits)/' ;;
    engine) benchmark engine '^(torque_free|separate|fast_step)' ;;
    kapla) bench kapla --only sixty_thousand_steps ;;
    performance) bench performance ;;
    standing_walls)
      echo "$(our_walls standing_10) $(our_walls standing_20) $(our_walls standing_30)" \
        "$(bench standing_walls --engine ourengine/fast --only standing_50)"
      ;;
    *) die "no part $1: contact, engine, kapla, performance, standing_walls" ;;
  esac
}

if [ "${1:-}" = --measure ]; then
  build=${2:-build/release}
  parts=("${@:3}")
  if [ ${#parts[@]} -eq 0 ]; then parts=(contact engine kapla performance standing_walls); fi
  load=$(cut -d' ' -f1 /proc/loadavg) # before there is any load of our own
  program=$build/brickbench
  cmake --build "$build" --target brickbench benchmarks >&2 ||
    die "$build cannot build brickbench and benchmarks (Debian package libbenchmark-dev)"
  results=$(mktemp -d "${TMPDIR:-/tmp}/performance-results.XXXXXX")
  trap 'rm -rf "$results"' EXIT
  mkdir -p "$folder"
  for part in "${parts[@]}"; do
    command_of "$part" >/dev/null
  done
  for part in "${parts[@]}"; do
    echo "== $part ($SECONDS s)" >&2
    read -ra words < <(command_of "$part")
    python3 scripts/performance_page.py measure "$folder/$part.json" "$load" "$program" "${words[@]}" >&2
  done
  echo "== all measured ($SECONDS s)" >&2
elif [ $# -ne 0 ]; then
  die "usage: scripts/splice-performance.sh [--measure [BUILD_DIR [PART...]]]"
fi
python3 scripts/performance_page.py splice "$folder" "$page"
