#!/usr/bin/env bash
# analysis.sh BRICKBENCH PAGE: runs the examples of docs/analysis.md word for word, each where its tool is installed;
# what is not is named. The mean that each tool prints must be that of the table.
# Exit status 77, with the reason, where no engine is linked.
set -euo pipefail
brickbench=$(realpath "$1")
page=$(realpath "$2")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
die() { echo "FAIL $*" >&2; exit 1; }
cd "$folder"
# block LANGUAGE TAG: the fenced block with that head.
block() { awk -v head="\`\`\`$1 $2" '$0 == head { on = 1; next } /^```/ { on = 0 } on' "$page"; }
block toml plan >drop.toml
[ -s drop.toml ] || die "the page has no plan"
mkdir bin
ln -s "$brickbench" bin/brickbench
export PATH="$folder/bin:$PATH"
if ! brickbench run drop.toml --only drop --out drops >said 2>&1; then
  if grep -q "matches nothing in this build" said; then echo "skipped: no engine is linked"; exit 77; fi
  grep -q 'ran to their end' said || { cat said >&2; die "the plan does not run"; }
fi
awk '/^```sh$/ { on = 1; next } /^```/ { on = 0 } on && /brickbench table/' "$page" >tables.sh
[ "$(wc -l <tables.sh)" -eq 2 ] || die "the page makes $(wc -l <tables.sh) tables"
bash -e tables.sh
# The mean of the first engine at the first step and restitution, by awk from the table itself.
mean=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
  $at["outcome"] == "ok" && $at["validity"] == "" && $at["energy_final_j"] != "" {
    key = $at["engine"] "," $at["restitution"] "," $at["step_s"]
    if (first == "") first = key
    if (key == first) { sum += $at["energy_final_j"]; ++n } }
  END { if (n == 16) printf "%.10g", sum / n }' wide.csv)
[ -n "$mean" ] || die "wide.csv has no group of 16 starts"
# told TOOL FILE: whether the tool's output has that mean.
told() {
  grep -oE '[0-9]+\.[0-9]+' "$2" | awk -v mean="$mean" '($1 - mean) ^ 2 < (1e-6 * mean) ^ 2 { found = 1 } END { exit !found }' ||
    { cat "$2" >&2; die "$1 does not find the mean $mean"; }
  echo "ok   $1"
}

if command -v sqlite3 >/dev/null 2>&1; then
  block sql sqlite >query.sql
  [ -s query.sql ] || die "the page has no query"
  sqlite3 :memory: <query.sql >sqlite.out
  told SQLite sqlite.out
else
  echo "not tried: sqlite3 is not installed"
fi
if python3 -c 'import pandas, matplotlib' 2>/dev/null; then
  block python pandas >pandas_example.py
  python3 pandas_example.py >pandas.out
  told pandas pandas.out
  [ -s energy.pdf ] || die "pandas made no figure"
else
  echo "not tried: python3-pandas or python3-matplotlib is not installed"
fi
if command -v Rscript >/dev/null 2>&1; then
  block r r >example.r
  Rscript example.r >r.out
  told R r.out
  [ -s energy_r.pdf ] || die "R made no figure"
else
  echo "not tried: R is not installed"
fi
if python3 -c 'import h5py' 2>/dev/null; then
  if brickbench run drop.toml --record --out moving >said 2>&1 || grep -q 'ran to their end' said; then
    block python h5py >h5py_example.py
    python3 h5py_example.py >h5py.out
    [ "$(grep -c ' m$' h5py.out)" -ge 2 ] || die "h5py reads no heights"
    echo "ok   h5py"
  else
    echo "not tried: h5py, for the program was built without HDF5"
  fi
else
  echo "not tried: python3-h5py is not installed"
fi
