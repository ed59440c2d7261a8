#!/usr/bin/env bash
# format.sh [--check]: formats every C++ file of ours; --check only names what is not formatted.
# Exit status: 0 fine, 1 not formatted, 77 there is no clang-format.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if ! command -v clang-format >/dev/null 2>&1; then
  echo "format: there is no clang-format (Debian package clang-format)"
  exit 77
fi
how=(-i)
if [ "${1:-}" = --check ]; then how=(--dry-run -Werror); fi
mapfile -t files < <(
  if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    git ls-files '*.cpp' '*.hpp'
  else
    find adapters cli experiments ourengine reports tests -name '*.[ch]pp'
  fi)
existing=()
for file in "${files[@]}"; do
  if [ -e "$file" ]; then existing+=("$file"); fi
done
echo "format: ${#existing[@]} files, $(clang-format --version)"
if ! clang-format "${how[@]}" "${existing[@]}"; then
  echo "format: run scripts/format.sh"
  exit 1
fi
