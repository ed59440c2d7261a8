#!/usr/bin/env bash
# check_cli.sh PROGRAM: the verb itself. What one check obtained is the reference of the next: green (0). A
# branch with other restitution or friction is red (1), by name, also in JUnit and annotations; a number without
# reference is 3, a damaged record 2 with file and line; nothing is blessed under CI; the reference stays as it was.
set -euo pipefail
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "check_cli: $*" >&2; exit 1; }
unset GITHUB_ACTIONS CI

# plan FRICTION RESTITUTION
plan() {
  cat <<PLAN
title = "Small"
analysis = "A brick slides, another is dropped."
[[experiment]]
name = "slide"
scenario = "incline"
engines = ["all"]
step_s = 0.002
duration_s = 0.4
parameters = { friction = $1 }
seeds = [1, 2, 3, 4]
perturb = { position_m = 1e-12, distribution = "uniform" }
metrics = ["displaced"]
[[experiment]]
name = "drop"
scenario = "brick_drop"
engines = ["all"]
step_s = 0.002
duration_s = 0.5
parameters = { restitution = $2 }
seeds = 24
perturb = { position_m = 1e-4, angle_rad = 0.01, velocity_mps = 0.01, distribution = "normal" }
metrics = ["displaced"]
PLAN
}
# check CODE REFERENCE [OPTION...]: into $folder/said and gate.xml
check() {
  local want=$1 reference=$2 code=0
  shift 2
  rm -rf new gate.xml
  "$program" check ./gate_small.toml --reference "$reference" --obtained new --junit gate.xml "$@" >said 2>&1 || code=$?
  [ $code -eq "$want" ] || { cat said >&2; fail "exit code $code, not $want, against $reference"; }
}

cd "$folder"
plan 0.3 0.4 >gate_small.toml
# The first check says that there is nothing yet, makes every start, and prints the command that blesses.
check 3 reference
grep -q 'no references in reference/small' said || fail "the missing folder is not said"
if grep -q '^ok .*: 0 of 0' said; then fail "nothing was run"; fi
bless=$(grep -o 'brickbench bless .*' said) || fail "the first check prints no command"
bless=${bless/brickbench/"$program"}
if [ "$(grep -c '"outcome":"ok"' new/*/drop.json)" -gt 0 ]; then
  grep '"outcome":"ok"' new/*/drop.json | grep -qv '"seeds":\[1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24\]' &&
    fail "a reference to be has not all starts"
fi
eval "${bless/"'...'"/"'a first reference'"}" >said || fail "the printed command fails: $bless"
rm -rf new
check 0 reference
[ "$(grep -c '^ok ' said)" -eq 2 ] || fail "experiments are not summed up"
! grep -q 'bless' said || fail "a green check asks for a blessing"
if ! grep -q '"outcome":"ok"' reference/*/slide.json; then exit 77; fi  # no linked engine runs it
cp -r reference kept
check 0 reference

# A branch that reads 0.285 where 0.3 is asked for: the records are the old ones under the name of the new.
cp -r reference friction && sed -i 's/friction=0.3;*\([",]\)/friction=0.285\1/' friction/*/slide.json
plan 0.285 0.4 >gate_small.toml
GITHUB_ACTIONS=1 check 1 friction
grep -q '^::error.*slide.*brick_displacement_max_m' said || { cat said >&2; fail "friction: not named"; }
! grep -q '^::error.*drop' said || fail "friction: the drop is accused"
grep -q '<failure.*slide\|slide.*<failure' gate.xml || fail "friction: no failure in JUnit"

cp -r reference restitution && sed -i 's/restitution=0.4\([",;]\)/restitution=0.45\1/' restitution/*/drop.json
plan 0.3 0.45 >gate_small.toml
GITHUB_ACTIONS=1 check 1 restitution
grep -q '^::error.*drop.*brick_displacement_max_m' said || { cat said >&2; fail "restitution: not named"; }
! grep -q '^::error.*slide' said || fail "restitution: the slide is accused"

# A setting that changed is told in one line.
plan 0.25 0.4 >gate_small.toml
check 3 reference --only slide
[ "$(grep -c '^setting changed in slide: friction 0.3 -> 0.25' said)" -eq 1 ] || { cat said >&2; fail "setting: not one line"; }
! grep -q '^missing slide' said || fail "setting: told of each number"

# What was decided early is no reference.
plan 0.3 0.45 >gate_small.toml
check 1 restitution
if [ "$(grep -c 'all-starts' said)" -eq 0 ]; then fail "a red check does not say how to accept it"; fi
cp -r restitution early
code=0
"$program" bless --from new --reference early --reason "too early" >said 2>&1 || code=$?
if grep -q '"outcome":"ok","seeds":\[1,2,3,4,5,6,7,8\]' new/*/drop.json && [ $code -ne 2 ]; then fail "8 of 24 starts were blessed"; fi

plan 0.3 0.4 >gate_small.toml
cp -r reference damaged && sed -i '2s/"kind":/"sort":/' damaged/*/drop.json
check 2 damaged
grep -q 'drop.json:2: ' said || fail "the damaged record is not named"
code=0
CI=1 "$program" bless --from new --reference damaged --reason "test" >said 2>&1 || code=$?
if [ $code -ne 2 ] || ! grep -q 'refused' said; then fail "blessed under CI"; fi
diff -r kept reference || fail "a check changed its reference"
