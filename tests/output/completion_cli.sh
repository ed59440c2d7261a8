#!/usr/bin/env bash
# completion_cli.sh BRICKBENCH: completion for bash is tried word by word; that for zsh and the manual page are
# read by zsh and groff where these are installed. Every verb and option of the program is in all three.
set -euo pipefail
brickbench=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
die() { echo "FAIL $*" >&2; exit 1; }
for what in bash zsh man; do "$brickbench" completion $what >"$folder/$what"; done

mapfile -t verbs < <("$brickbench" list verbs | sed -n 's/^\([a-z ]*\): .*/\1/p')
mapfile -t options < <("$brickbench" list verbs | grep -o '^ *--[a-z-]*' | tr -d ' ' | sort -u)
[ ${#verbs[@]} -gt 10 ] && [ ${#options[@]} -gt 30 ] || die "only ${#verbs[@]} verbs, ${#options[@]} options"
for what in bash zsh; do
  for word in "${verbs[@]}" "${options[@]}"; do grep -qF -- "$word" "$folder/$what" || die "$what: no $word"; done
done
for word in "${options[@]}"; do grep -qF -- "${word//-/\\-}" "$folder/man" || die "man: no $word"; done

mkdir "$folder/bin"
ln -s "$brickbench" "$folder/bin/brickbench"
export PATH="$folder/bin:$PATH"
# shellcheck source=/dev/null
. "$folder/bash"
# offers WORD... : what is offered for the last of them.
offers() {
  COMP_WORDS=(brickbench "$@")
  COMP_CWORD=$#
  COMPREPLY=()
  _brickbench
  echo "${COMPREPLY[*]}"
}
# expect WANTED WORD...
expect() {
  local wanted=$1 got
  shift
  got=$(offers "$@")
  [[ " $got " == *" $wanted "* ]] || die "after '$*' not $wanted but '$got'"
}
expect render ren
expect plan sweep p
expect --retry-failed sweep run --re
expect quick_look run qui
expect side render folder --view s
expect engines list e
expect laws oracle l
expect --stride oracle laws brick_wall --st
[[ " $(offers render --r) " != *" --retry-failed "* ]] || die "an option of another verb is offered"
echo "ok   bash completes verbs, options, plans and choices"

if command -v zsh >/dev/null 2>&1; then
  zsh -n "$folder/zsh" || die "zsh cannot read its completion"
  zsh -f -c "compdef() { :; }; _describe() { print -l -- \$options; }; compadd() { :; }; _files() { :; }
    . $folder/zsh; words=(brickbench sweep run --re); CURRENT=4; _brickbench" | grep -q -- '^--retry-failed:' ||
    die "zsh does not offer --retry-failed"
  echo "ok   zsh describes the options of a verb"
else
  echo "not tried: zsh is not installed"
fi
if command -v groff >/dev/null 2>&1; then
  warnings=$(groff -man -Tascii -ww -z "$folder/man" 2>&1) || true
  [ -z "$warnings" ] || die "groff: $warnings"
  groff -man -Tascii -P -cbou "$folder/man" >"$folder/page"
  grep -q 'brickbench sweep run' "$folder/page" || die "the page lacks a verb"
  echo "ok   groff reads the manual page"
else
  echo "not tried: groff is not installed"
fi
