#!/usr/bin/env bash
# follow.sh RECIPE SCRATCH: does what CONTRIBUTING.md says, word for word, in a copy of the project.
# A recipe is all code blocks that begin with ```sh RECIPE, in their order, run by one bash that
# stops at the first command that fails.
set -euo pipefail
recipe=$1
scratch=$2
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

commands=$(awk -v fence="\`\`\`sh $recipe" \
  '$0 == fence { inside = 1; next } /^```/ { inside = 0 } inside' "$root/CONTRIBUTING.md")
if [ -z "$commands" ]; then
  echo "follow: CONTRIBUTING.md has no code block '\`\`\`sh $recipe'" >&2
  exit 1
fi

rm -rf "$scratch"
mkdir -p "$scratch"
tar -C "$root" --exclude=./.git --exclude=./build --exclude=./results -c . | tar -C "$scratch" -x
cd "$scratch"
# Whatever build runs this test must not speak to the builds inside it.
unset CTEST_OUTPUT_ON_FAILURE CTEST_PARALLEL_LEVEL MAKEFLAGS
bash -euxo pipefail -c "$commands"
rm -rf "$scratch"
