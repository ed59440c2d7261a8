#!/usr/bin/env bash
# report_cli.sh BRICKBENCH: the verbs report and compare from outside. A run compared with itself has
# no change; with gravity 1 % higher the cause is named, in the terminal, as Markdown and as a page.
# Damaged rows or motion are named, and no page is left half-written.
# Exit status 77, with the reason, where no engine is linked.
set -euo pipefail
brickbench=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
die() { echo "FAIL $*" >&2; exit 1; }
has() { grep -qF -- "$2" "$1" || { cat "$1" >&2; die "$1 does not say '$2'"; }; }
# answers STATUS NAME ARGUMENT...: the program must end so; what it says is NAME.out and NAME.err.
answers() {
  local wanted=$1 name=$2 status=0
  shift 2
  "$brickbench" "$@" >"$name.out" 2>"$name.err" || status=$?
  [ $status -eq "$wanted" ] || { cat "$name.out" "$name.err" >&2; die "$* ended with $status, not $wanted"; }
}
cat >plan.toml <<'END'
title = "A block flies apart"
[[experiment]]
name = "block"
scenario = "explosion"
engines = "all"
step_s = 0.01
duration_s = 0.2
parameters = { count_x = 2, count_y = 2, count_z = 2, gravity_mps2 = 9.81 }
metrics = ["energy", "momentum"]
END
recorded=0
{ cat plan.toml; printf '[trajectory]\nevery = 2\n'; } >recorded.toml
status=0
"$brickbench" run recorded.toml --out one >run.log 2>&1 || status=$?
if grep -q "matches nothing in this build" run.log; then echo "skipped: no engine is linked"; exit 77; fi
if [ $status -eq 0 ]; then
  recorded=1
elif grep -q "no HDF5" run.log; then
  echo "not tried: motion (the program was built without HDF5)"
  answers 0 run run plan.toml --out one
else
  cat run.log >&2
  die "run ended with $status"
fi

answers 0 same compare one one --out same
has same.out "No change: "
answers 0 same_markdown compare one one --markdown
has same_markdown.out "No change: "
has same/index.html "No change: "
echo "ok   a run compared with itself has no change"

answers 0 heavier run plan.toml --set block.gravity_mps2=9.9081 --out heavier
answers 1 changed compare one heavier --out changed
answers 1 changed_markdown compare one heavier --markdown
for text in changed.out changed_markdown.out; do
  has $text "gravity_mps2: 9.81 -> 9.9081"
  has $text "energy_final_j"
done
has changed/index.html "gravity_mps2: 9.81 -&gt; 9.9081"
has changed/compare.md "gravity_mps2: 9.81 -> 9.9081"
widest=$(awk '/^beyond noise/ { table = 1 } table && length($0) > most { most = length($0) }
  END { print most + 0 }' changed.out)
[ "$widest" -gt 40 ] && [ "$widest" -le 100 ] || die "a table of $widest columns"
echo "ok   gravity 1 % higher is found and named in terminal, Markdown and page"

cp -r one cut
head -c -20 one/rows.csv >cut/rows.csv
last=$(wc -l <one/rows.csv)
answers 2 damaged report cut --out page
has damaged.err "cut/rows.csv:$last"
[ -z "$(find . -maxdepth 1 -name 'page*')" ] || die "a page of damaged rows is left"
echo "ok   damaged rows are named with their line"
if [ $recorded -eq 0 ]; then exit 0; fi

# Bytes that nobody reads may change nothing; every other is noticed.
cp -r one flipped
motion=$(find flipped/trajectories -name '*.h5' | sort | head -n 1)
whole=one/${motion#flipped/}
size=$(stat -c %s "$whole")
answers 0 whole report one --out whole --no-pdf
refused=0
for part in 1 3 5 7 9 11 13 15; do
  at=$((size * part / 16))
  cp "$whole" "$motion"
  byte=$(od -An -tu1 -j $at -N1 "$motion")
  printf '%b' "\\x$(printf %02x $((byte ^ 85)))" |
    dd of="$motion" bs=1 seek=$at conv=notrunc status=none
  if "$brickbench" report flipped --out page --no-pdf >motion.out 2>motion.err; then
    cmp -s <(sed 's/flipped/one/g' page/index.html) whole/index.html ||
      die "byte $at of $size is wrong, and the page shows it"
    rm -r page
  else
    has motion.err "$(basename "$motion")"
    [ -z "$(find . -maxdepth 1 -name 'page*')" ] || die "a page of damaged motion is left"
    refused=$((refused + 1))
  fi
done
[ $refused -ge 2 ] || die "only $refused of 8 wrong bytes were noticed"
echo "ok   damaged motion is named with its file ($refused of 8 bytes; nobody reads the others)"
