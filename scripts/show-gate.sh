#!/usr/bin/env bash
# show-gate.sh [WORK_FOLDER]: what `brickbench check smoke` says of a branch whose adapters are faulty. The
# committed tree is checked out beside this one, built, and checked; then once more for each fault: a few words
# changed in adapters/ode.cpp, adapters/ode_scene.hpp and adapters/ourengine_velocity.cpp. The table goes between the markers of
# docs/gate.md. Exit 1 if the sound tree is red or a fault is not. WORK_FOLDER is kept, and used again;
# default: a new one, removed at the end. Ten minutes without compiler cache; needs python3 and git.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/splice.sh
. scripts/splice.sh

page=$PWD/docs/gate.md
need_markers "$page" branches
work=${1:-}
if [ -z "$work" ]; then
  work=$(mktemp -d "${TMPDIR:-/tmp}/show-gate.XXXXXX")
  trap 'git worktree remove --force "$work/tree" 2>/dev/null; rm -rf "$work"' EXIT
fi
mkdir -p "$work"
tree=$work/tree
if [ -e "$tree/.git" ]; then
  git -C "$tree" checkout --quiet --force --detach "$(git rev-parse HEAD)"
else
  git worktree add --quiet --force --detach "$tree" HEAD
fi

# change FILE FROM TO: exactly one line of FILE must hold FROM.
change() {
  [ "$(grep -cF "$2" "$tree/$1")" -eq 1 ] || die "$1 has not one line with '$2'"
  FROM=$2 TO=$3 perl -pi -e 's/\Q$ENV{FROM}\E/$ENV{TO}/' "$tree/$1"
}
fault() {
  case $1 in
    none) ;;
    friction)
      change adapters/ode.cpp "surface.mu = law.friction" "surface.mu = 0.95 * law.friction"
      change adapters/ourengine_velocity.cpp "{law.friction, law.restitution});" "{0.95 * law.friction, law.restitution});"
      ;;
    gravity)
      change adapters/ode_scene.hpp "facts.gravity_mps2.z());" "1.01 * facts.gravity_mps2.z());"
      perl -pi -e 's/options\.gravity_mps2 = world/options.gravity_mps2 = 1.01 * world/' \
        "$tree/adapters/ourengine_velocity.cpp"
      ;;
    restitution)
      change adapters/ode.cpp "surface.bounce = law.restitution" "surface.bounce = law.restitution + 0.05"
      change adapters/ourengine_velocity.cpp "{law.friction, law.restitution});" "{law.friction, law.restitution + 0.05});"
      ;;
    iterations)
      change adapters/ode_scene.hpp 'static_cast<int>(value("iterations"))' 'static_cast<int>(value("iterations")) / 2'
      change adapters/ourengine_velocity.cpp "options.substeps = fast_substeps(settings);" \
        "options.substeps = fast_substeps(settings) / 2;"
      ;;
  esac
}

declare -A named=([none]="nothing" [friction]="friction -5 %" [gravity]="gravity +1 %"
  [restitution]="restitution +0.05" [iterations]="sweeps and sub-steps halved")
rows=$work/rows.md
wrong=0
: >"$rows"
for seeded in none friction gravity restitution iterations; do
  git -C "$tree" checkout --quiet --force .
  fault "$seeded"
  (cd "$tree" && cmake --preset release >/dev/null && cmake --build --preset release --target brickbench >"$work/build.log" 2>&1) ||
    die "the branch with '${named[$seeded]}' does not build: $work/build.log"
  echo "show-gate: checking ${named[$seeded]}" >&2
  rm -rf "$work/obtained"
  code=0
  (cd "$tree" && build/release/brickbench check smoke --obtained "$work/obtained" --json) \
    >"$work/check.json" 2>"$work/check.log" || code=$?
  if [ "$seeded" = none ]; then [ $code -eq 0 ] || wrong=1; else [ $code -eq 1 ] || wrong=1; fi
  python3 - "$work/check.json" "${named[$seeded]}" $code >>"$rows" <<'PY'
import json
import sys

path, seeded, code = sys.argv[1:]
records = json.load(open(path))["records"]
red = [r for r in records if r["finding"] in ("deviation", "missing")]
engines = {}
for r in red:
    engines.setdefault(r["engine"], r)  # worst first
def told(r):
    metric = r["metric"] or "state hash"
    if r["reference"] is None or r["got"] is None or not r["metric"]:
        return f"{r['engine']}: {r['experiment']} {metric}"
    return f"{r['engine']}: {r['experiment']} {metric} {r['reference']:.4g} -> {r['got']:.4g}"
worst = "; ".join(told(r) for r in sorted(engines.values(), key=lambda r: r["engine"])) or "-"
print(f"| {seeded} | {code} | {len(red)} of {len(records)} | {worst} |")
PY
done
git -C "$tree" checkout --quiet --force .
{
  echo "| seeded in the branch | exit | red numbers | worst of each engine: experiment, metric, reference -> got; the others are green |"
  echo "|---|---:|---:|---|"
  cat "$rows"
} | put "$page" branches
[ $wrong -eq 0 ] || die "the sound tree is red, or a fault is not; see $rows"
echo "show-gate: $page has the table"
