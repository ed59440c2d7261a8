#!/usr/bin/env bash
# splice-scenes.sh [BRICKBENCH]: compares every scene with its images and searches the largest stable
# steps, for every engine, and puts both tables between the markers of docs/method.md.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source scripts/splice.sh

program=${1:-build/release/brickbench}
page=docs/method.md
if [ ! -x "$program" ]; then die "there is no program $program"; fi
need_markers $page images stable
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

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
  }' "$scratch/images" | pivot scene) || die "no images were compared"
stable=$(awk '
  $2 !~ "/" { next }
  { text = $3 ~ /:$/ ? substr($3, 1, length($3) - 1) : $4 == "none" ? "all up to " $3 : $3 == "none" ? "none" : $3 }
  { print $1 "\t" $2 "\t" text }' "$scratch/stable" | pivot scene) || die "no stable steps were found"

put $page images <<<"$images"$'\n\n'"$(measured "$program")"
put $page stable <<<"$stable"$'\n\n'"$(measured "$program")"
echo "splice-scenes: $page has the images and stable steps of $program"
