#!/usr/bin/env bash
# splice-readme.sh RESULTS: puts the first table of RESULTS/report.md between the markers of
# README.md, with the command that made it. README.md changes only if the report has a table.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
report=${1:?usage: scripts/splice-readme.sh RESULTS-FOLDER}/report.md
if [ ! -r "$report" ]; then
  echo "splice-readme: there is no $report" >&2
  exit 2
fi
table=$(awk '/^\|/ { print; found = 1; next } found { exit }' "$report")
if [ -z "$table" ]; then
  echo "splice-readme: $report has no table" >&2
  exit 2
fi
for marker in BEGIN END; do
  if [ "$(grep -c "^<!-- $marker results" README.md)" -ne 1 ]; then
    echo "splice-readme: README.md must have one line '<!-- $marker results -->'" >&2
    exit 2
  fi
done
new=$(mktemp README.XXXXXX)
trap 'rm -f "$new"' EXIT
TABLE=$table awk '
  /^<!-- BEGIN results/ { print; print ""; print ENVIRON["TABLE"]; print ""; skip = 1; next }
  /^<!-- END results/ { skip = 0 }
  !skip' README.md >"$new"
cat "$new" >README.md
echo "splice-readme: README.md has the table of $report"
