#!/usr/bin/env bash
# tutorial.sh BRICKBENCH: follows docs/tutorials/your-engine.md word for word, in a folder of its own.
# Exit status: 0 fine, 77 there is no python3.
set -euo pipefail
program=$(realpath "$1")
if ! command -v python3 >/dev/null 2>&1; then
  echo "tutorial: there is no python3 (Debian package python3)"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/bin" "$folder/adapters" "$folder/config"
ln -s "$program" "$folder/bin/brickbench"
cp -r adapters/starter "$folder/adapters/"
awk '/^```sh$/ { inside = 1; next } /^```$/ { inside = 0 } inside' docs/tutorials/your-engine.md \
  >"$folder/steps.sh"
if [ "$(grep -c brickbench "$folder/steps.sh")" -lt 4 ]; then
  echo "tutorial: the page has no steps"
  exit 1
fi
cd "$folder"
PATH=$folder/bin:$PATH XDG_CONFIG_HOME=$folder/config bash -euxo pipefail steps.sh
