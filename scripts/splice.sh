# splice.sh: sourced by the scripts that put measured tables into documents.
# shellcheck shell=bash

die() { echo "${0##*/}: $*" >&2; exit 2; }

# need_markers PAGE NAME...: each NAME must have one line <!-- BEGIN NAME --> and one END line.
need_markers() {
  local page=$1 name marker
  shift
  for name in "$@"; do
    for marker in BEGIN END; do
      if [ "$(grep -c "^<!-- $marker $name" "$page")" -ne 1 ]; then
        die "$page must have one line '<!-- $marker $name -->'"
      fi
    done
  done
}

# put PAGE NAME: replaces what stands between the markers of NAME by standard input.
put() {
  local page=$1 name=$2 new
  new=$(mktemp "$page.XXXXXX")
  TEXT=$(cat) NAME=$name awk '
    index($0, "<!-- BEGIN " ENVIRON["NAME"]) == 1 { print; print ""; print ENVIRON["TEXT"]; print ""; skip = 1; next }
    index($0, "<!-- END " ENVIRON["NAME"]) == 1 { skip = 0 }
    !skip' "$page" >"$new"
  cat "$new" >"$page"
  rm -f "$new"
}

# Lines of row, column and text, separated by tabs and in any order, become a table with rows and
# columns in order of appearance; $1 heads the first column. Fails without lines.
pivot() {
  awk -F '\t' -v head="$1" '
    !($1 in r) { r[$1] = 1; rows[++n] = $1 }
    !($2 in c) { c[$2] = 1; columns[++m] = $2 }
    { text[$1, $2] = $3 }
    END {
      if (!n) exit 1
      line = "| " head " |"; rule = "|---|"
      for (j = 1; j <= m; ++j) { line = line " " columns[j] " |"; rule = rule "---|" }
      print line; print rule
      for (i = 1; i <= n; ++i) {
        line = "| " rows[i] " |"
        for (j = 1; j <= m; ++j) {
          k = rows[i] SUBSEP columns[j]
          line = line " " ((k in text) ? text[k] : "-") " |"
        }
        print line
      }
    }'
}

# measured PROGRAM: when, and from which revision the numbers are.
measured() {
  local revision
  revision=$("$1" doctor --json | sed -n 's/^ *"revision": "\(.*\)",$/\1/p')
  echo "Measured $(date -u +%Y-%m-%d), revision ${revision:-unknown}."
}
