#!/usr/bin/env bash
# splice-found.sh [BRICKBENCH]: hunts every engine that is not ours with a fixed seed, for TRIALS trials (4000), keeps
# the plans of the findings in reference_data/found, and puts their table between the markers of docs/found.md.
# HUNT names a folder with an earlier part of the same hunt, which is gone on with.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source scripts/splice.sh

program=${1:-build/release/brickbench}
page=docs/found.md
seed=14
trials=${TRIALS:-4000}
kept=reference_data/found
if [ ! -x "$program" ]; then die "there is no program $program"; fi
need_markers $page found
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

listed=$("$program" list engines --json)
choice=()
for engine in bullet ode mujoco; do
  if grep -q "\"$engine\"" <<<"$listed"; then choice+=(--engine "$engine/*"); fi
done
if [ ${#choice[@]} -eq 0 ]; then die "no engine of others is linked"; fi
code=0
again=()
if [ -n "${HUNT:-}" ]; then
  cp -r "$HUNT" "$scratch/hunt"
  again=(--resume)
fi
"$program" hunt "${choice[@]}" --seed $seed --trials "$trials" --budget 24h "${again[@]}" --out "$scratch/hunt" >"$scratch/text" || code=$?
if [ $code -gt 1 ]; then die "the hunt did not run"; fi
mkdir -p $kept
rm -f $kept/*.toml
for plan in "$scratch"/hunt/*.toml; do
  if [ -e "$plan" ]; then sed "s|$scratch/hunt/|$kept/|" "$plan" >"$kept/${plan##*/}"; fi
done
made="Made by \`TRIALS=$trials scripts/splice-found.sh\`."
put $page found <<<"$(sed "s|(\./|(../$kept/|" "$scratch/hunt/findings.md")"$'\n\n'"$made $(measured "$program")"
echo "splice-found: $page has $(find $kept -name '*.toml' | wc -l) findings"
