# build.sh: sourced by quickstart.sh and test.sh in the project's root.
# shellcheck shell=bash

jobs=$(nproc 2>/dev/null || getconf _NPROCESSORS_ONLN)
if command -v ccache >/dev/null 2>&1; then
  export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
  # Paths relative to the checkout: a clone elsewhere finds what another one compiled.
  export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1
  # What it asks for where headers are compiled once.
  export CCACHE_SLOPPINESS=pch_defines,time_macros
fi

step() { printf '== %s (%d s)\n' "$*" "$SECONDS"; }

# configure PRESET [CMAKE-ARGUMENT...]
configure() {
  step "configure $1"
  cmake --preset "$@"
}

# build PRESET [TARGET...]
build() {
  local preset=$1
  shift
  step "build $preset${*:+: $*}"
  cmake --build --preset "$preset" -j "$jobs" ${*:+--target "$@"}
}
