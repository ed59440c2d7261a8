#!/usr/bin/env bash
# ensembles_cli.sh PROGRAM: compare and report judge ensembles. A folder against itself is identical; with
# other restitution the drop is named different, with its runs; figures and tables are there.
set -euo pipefail
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "ensembles_cli: $*" >&2; exit 1; }

cat >"$folder/drop.toml" <<'PLAN'
title = "A brick dropped many times"
analysis = "The same brick from perturbed starts."
[[experiment]]
name = "drop"
scenario = "brick_drop"
engines = ["all"]
step_s = 0.004
duration_s = 0.6
parameters = { restitution = 0.4 }
seeds = 16
perturb = { position_m = 1e-4, angle_rad = 0.01, velocity_mps = 0.01, distribution = "normal" }
metrics = ["energy", "displaced"]
PLAN
cd "$folder"
"$program" run drop.toml --out before >/dev/null 2>&1 || [ $? -eq 1 ]
"$program" run drop.toml --set restitution=0.6 --out after >/dev/null 2>&1 || [ $? -eq 1 ]
if ! grep -q ',ok,' before/rows.csv; then exit 77; fi  # no linked engine runs it

"$program" compare before before --out same >/dev/null || fail "a folder differs from itself"
verdicts=same/figures/ensemble_verdicts.csv
[ "$(grep -c ',identical,"' $verdicts)" -eq $(($(wc -l <$verdicts) - 1)) ] || fail "not all identical"

code=0
"$program" compare before after --out changed >/dev/null || code=$?
[ $code -eq 1 ] || fail "exit code $code for a change"
verdicts=changed/figures/ensemble_verdicts.csv
grep '"energy_final_j"' $verdicts | grep -q ',16,16,0,0,0,0,different,"different: .* in after has ' ||
  fail "the change is not named"
[ "$(tail -n +2 changed/figures/ensemble_values.csv | wc -l)" -ge 32 ] || fail "values are missing"
# What else was run changes no verdict: beside another scene, or in one engine alone, each says word for word the same.
{ cat drop.toml; sed -n '/^\[\[experiment/,$p' drop.toml | sed 's/"drop"/"higher"/; s/parameters = {/& drop_height_m = 1.5,/'; } >more.toml
engine=$(grep -o ',"[a-z_]*/[a-z_]*","after","before",' $verdicts | head -n 1 | cut -d'"' -f2)
# pair NAME PLAN [OPTION...]: before and after, compared.
pair() {
  local name=$1 plan=$2
  shift 2
  "$program" run "$plan" "$@" --out "$name/before" >/dev/null 2>said || [ $? -eq 1 ] || { cat said >&2; fail "$name"; }
  "$program" run "$plan" "$@" --set restitution=0.6 --out "$name/after" >/dev/null 2>&1 || [ $? -eq 1 ]
  "$program" compare "$name/before" "$name/after" --out "$name/page" >/dev/null || [ $? -eq 1 ]
}
mkdir company alone
pair company more.toml
pair alone drop.toml --engine "$engine"
# of FILE: the verdicts on the drop in that engine, without the scene's label.
of() { grep "^\"drop[:\"].*,\"$engine\",\"after\"" "$1" | sed 's/^"[^"]*",//' | sort; }
[ "$(of $verdicts | wc -l)" -gt 3 ] || fail "no verdicts on $engine"
for other in company alone; do
  diff <(of $verdicts) <(of $other/page/figures/ensemble_verdicts.csv) >&2 || fail "$other changed a verdict"
done
for kind in spread fan; do
  ls changed/figures/$kind-*.svg changed/figures/$kind-*.csv >/dev/null || fail "no $kind figures"
done
for file in changed/index.html changed/compare.md; do
  grep -q 'pairs of ensembles' $file || fail "$file does not say what was judged"
done
