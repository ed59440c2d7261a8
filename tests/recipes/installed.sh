#!/usr/bin/env bash
# installed.sh BUILD SCRATCH: installs a finished build below SCRATCH and uses what is there as
# somebody outside the project would: the program on one of its plans from an empty folder, and the
# library in the example of ourengine/example. The library must also configure without the rest.
set -euo pipefail
build=$1
scratch=$2
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
fail() { echo "installed: $*" >&2; exit 1; }

rm -rf "$scratch"
mkdir -p "$scratch/empty"
prefix=$scratch/prefix
cmake --install "$build" --prefix "$prefix" --component brickbench >/dev/null
cmake --install "$build" --prefix "$prefix" --component ourengine >/dev/null

cd "$scratch/empty"
"$prefix/bin/brickbench" doctor | grep -q "plans in *.*share/brickbench/experiments/plans" ||
  fail "the installed program does not look for plans beside itself"
"$prefix/bin/brickbench" run quick_look --out results >/dev/null || fail "no plan runs by its name"
[ -s results/rows.csv ] || fail "no rows"

if grep -rlE '^#include .*(contact|linear|fast)/' "$prefix/include/ourengine"; then
  fail "public headers include what is private"
fi
cmake -S "$root/ourengine/example" -B "$scratch/example" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$scratch/example" >/dev/null
"$scratch/example/falling_brick" >falling.txt
cat falling.txt
# Both end at rest, one on the other: centres at 0.05 m and 0.15 m.
awk 'END { exit !($2 > 0.0499 && $2 < 0.0501 && $3 > 0.1499 && $3 < 0.1501 && $4 >= 8) }' falling.txt ||
  fail "the bricks do not end one on the other"

cmake -S "$root/ourengine" -B "$scratch/alone" >/dev/null || fail "ourengine does not configure alone"
rm -rf "$scratch"
