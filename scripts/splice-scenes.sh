#!/usr/bin/env bash
# splice-scenes.sh [BRICKBENCH]: compares every scene with its images and searches the largest stable
# steps, for every engine, and puts both tables between the markers of docs/method.md.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

die() { echo "splice-scenes: $*" >&2; exit 2; }

program=${1:-build/release/brickbench}
page=docs/method.md
if [ ! -x "$program" ]; then die "there is no program $program"; fi
for name in images stable; do
  for marker in BEGIN END; do
    if [ "$(grep -c "^<!-- $marker $name" $page)" -ne 1 ]; then
      die "$page must have one line '<!-- $marker $name -->'"
    fi
  done
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Rows (scene, engine, text) become a table of scenes by engines, both in order of appearance.
pivot() {
  awk -F '\t' '
    !($1 in c) { c[$1] = 1; scenes[++n] = $1 }
    !($2 in e) { e[$2] = 1; engines[++m] = $2 }
    { text[$1, $2] = $3 }
    END {
      if (!n) exit 1
      line = "| scene |"; rule = "|---|"
      for (j = 1; j <= m; ++j) { line = line " " engines[j] " |"; rule = rule "---|" }
      print line; print rule
      for (i = 1; i <= n; ++i) {
        line = "| " scenes[i] " |"
        for (j = 1; j <= m; ++j) line = line " " text[scenes[i], engines[j]] " |"
        print line
      }
    }'
}

engines=(--engine all --engine ourengine/fast)
"$program" validate --symmetry all "${engines[@]}" >"$scratch/images" || die "--symmetry did not run"
for scene in tower standing_wall kapla_tower; do
  "$program" validate --stable-step "$scene" "${engines[@]}" || die "--stable-step did not run"
done >"$scratch/stable"

images=$(awk '
  $2 !~ "/" { next }
  {
    k = $1 "\t" $2
    if (!(k in seen)) { seen[k] = 1; order[++n] = k; worst[k] = -1 }
    if ($4 ~ /:$/) { refused[k] = substr($4, 1, length($4) - 1); next }
    if ($5 + 0 > worst[k]) { worst[k] = $5 + 0; rate[k] = $6; name[k] = $3 }
  }
  END {
    for (i = 1; i <= n; ++i) {
      k = order[i]
      print k "\t" (worst[k] < 0 ? refused[k] : worst[k] == 0 ? "0" : sprintf("%.1e (%s)", worst[k], name[k]))
    }
  }' "$scratch/images" | pivot) || die "no images were compared"
stable=$(awk '
  $2 !~ "/" { next }
  { text = $3 ~ /:$/ ? substr($3, 1, length($3) - 1) : $4 == "none" ? "all up to " $3 : $3 == "none" ? "none" : $3 }
  { print $1 "\t" $2 "\t" text }' "$scratch/stable" | pivot) || die "no stable steps were found"

made="Measured $(date -u +%Y-%m-%d), revision $(git rev-parse --short HEAD)."
new=$(mktemp docs/method.XXXXXX)
trap 'rm -rf "$scratch" "$new"' EXIT
MADE=$made IMAGES=$images STABLE=$stable awk '
  function put(text) { print; print ""; print text; print ""; print ENVIRON["MADE"]; print ""; skip = 1 }
  /^<!-- BEGIN images/ { put(ENVIRON["IMAGES"]); next }
  /^<!-- BEGIN stable/ { put(ENVIRON["STABLE"]); next }
  /^<!-- END / { skip = 0 }
  !skip' $page >"$new"
cat "$new" >$page
echo "splice-scenes: $page has the images and stable steps of $program"
