#!/usr/bin/env bash
# tidy.sh [FILE...]: clang-tidy over the given sources, or over all of ours. Not part of the tests:
# a file takes seconds to tens of seconds. Needs a configured build/dev or build/release.
# Exit status: 0 clean, 1 findings, 4 no clang-tidy or no build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if ! command -v clang-tidy >/dev/null 2>&1; then
  echo "tidy: there is no clang-tidy (Debian package clang-tidy)" >&2
  exit 4
fi
for build in build/dev build/release; do
  if [ -e "$build/compile_commands.json" ]; then break; fi
done
if [ ! -e "$build/compile_commands.json" ]; then
  echo "tidy: configure first: cmake --preset dev" >&2
  exit 4
fi
if [ $# -gt 0 ]; then files=("$@"); else mapfile -t files < <(git ls-files '*.cpp'); fi
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy --quiet -p "$build" || exit 1
