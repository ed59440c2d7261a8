#!/usr/bin/env bash
# install-deps.sh [--list] [GROUP...]: installs the Debian packages that brickbench needs.
#
#   GROUP   build     what compiles and links the program
#           engines   the third-party engines; each that is missing is left out of the build
#           tests     what the tests need on top
#           reports   what makes report pages interactive, and pictures and videos of them
#           slurm     a private cluster on this machine, to test sweeps on one
#           Without a group: build, engines and tests.
#   --list  print the table and change nothing
#
# Installs only what is missing, says what and why first, asks for sudo only if not root, and never
# asks anything else. A tool that is there already counts, wherever it came from. Packages that only
# widen what can be done are left out, by name, where they cannot be installed. Where there is no
# apt it installs nothing: it uses what exists and names what is missing.
# Exit status: 0 fine, 2 bad usage, 4 something needed could not be had.
set -euo pipefail
export PATH="$PATH:/usr/local/sbin:/usr/sbin:/sbin"

# group | package | why | how to see it without dpkg: commands or headers, any of which will do
table() {
  cat <<'END'
build|g++|the C++20 compiler|c++,g++,clang++
build|cmake|configures the build (3.25 or newer)|cmake
build|ninja-build|runs the build|ninja
build|pkg-config|finds Bullet and ODE|pkg-config
build|git|writes the source revision into every result|git
build|libeigen3-dev|Eigen: vectors and matrices|eigen3/Eigen/Core,Eigen/Core
build|libfmt-dev|{fmt}: text output|fmt/core.h
build|libexpected-dev|tl::expected: failures as values|tl/expected.hpp
build|libtomlplusplus-dev|toml++: reads plans|toml++/toml.h
build|libmuparser-dev|muParser: formulas in scene files|muParser.h
build|libcli11-dev|CLI11: the command line|CLI/CLI.hpp
build|nlohmann-json3-dev|nlohmann-json: --json|nlohmann/json.hpp
build|libfccp-dev|fast-cpp-csv-parser: reads rows|libfccp/csv.h,csv.h
build|libxxhash-dev|xxHash: hashes of states|xxhash.h
build|libhwy-dev|Highway: SIMD kernels of our engine|hwy/highway.h
build|zlib1g-dev|zlib: replays inside report pages|zlib.h
build|libmetis-dev|METIS: orders our engine's sparse systems|metis.h
build|libhdf5-dev|HDF5: recorded trajectories|hdf5.h,hdf5/serial/hdf5.h
build|libsqlite3-dev|SQLite: sweeps merged to a database|sqlite3.h
engines|libbullet-dev|Bullet, in double precision|bullet/btBulletDynamicsCommon.h
engines|libode-dev|Open Dynamics Engine|ode/ode.h
engines|libmujoco-dev|MuJoCo|mujoco/mujoco.h
engines|libqhull-dev|a folder that MuJoCo's CMake package insists on|libqhull_r/libqhull_r.h
engines|libopengl-dev|OpenGL, looked for by MuJoCo's CMake package|GL/gl.h
engines|libgl-dev|OpenGL, looked for by MuJoCo's CMake package|GL/gl.h
tests|libgtest-dev|GoogleTest|gtest/gtest.h
tests|libfcl-dev|FCL: a second opinion on penetration depths|fcl/fcl.h
tests|python3|an engine in another language, as users write them|python3
tests|clang-format|the format test|clang-format
tests|ccache|compiles nothing twice, also in the copies that the recipes build|ccache
reports|nodejs|bundles the script of the report page|node
reports|npm|fetches the modules of the report page by their lock file|npm
reports|chromium|opens report pages: browser tests, pictures, videos|chromium
reports|ffmpeg|videos of replays|ffmpeg
reports|gnuplot-nox|figures as PDF|gnuplot
slurm|slurm-wlm|Slurm: runs job arrays|slurmctld
slurm|munge|MUNGE: Slurm's authentication|munged
END
}

say() { printf 'install-deps: %s\n' "$*"; }

groups=()
list_only=false
for argument in "$@"; do
  case $argument in
    --list) list_only=true ;;
    build | engines | tests | reports | slurm) groups+=("$argument") ;;
    -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0"; exit 0 ;;
    *) say "unknown argument '$argument'; groups are build, engines, tests, reports, slurm" >&2; exit 2 ;;
  esac
done
if [ ${#groups[@]} -eq 0 ]; then groups=(build engines tests); fi

# The rows of the chosen groups.
rows=()
while IFS= read -r row; do
  for group in "${groups[@]}"; do
    if [ "${row%%|*}" = "$group" ]; then rows+=("$row"); fi
  done
done < <(table)

if $list_only; then
  for row in "${rows[@]}"; do
    IFS='|' read -r group package why _ <<<"$row"
    printf '%-8s %-22s %s\n' "$group" "$package" "$why"
  done
  exit 0
fi

# Whether any item of the comma-separated list exists; with the word 'commands', only commands count.
seen() {
  local item dir
  for item in ${1//,/ }; do
    case $item in
      */* | *.h)
        if [ "${2:-}" = commands ]; then continue; fi
        for dir in /usr/include /usr/local/include /opt/homebrew/include /opt/local/include \
                   $(tr : " " <<<"${CPATH:-}"); do
          if [ -e "$dir/$item" ]; then return 0; fi
        done ;;
      *) if command -v "$item" >/dev/null 2>&1; then return 0; fi ;;
    esac
  done
  return 1
}

# Whether nothing can be built or tested without the package: needed GROUP PACKAGE.
needed() { [ "$1" = build ] || [ "$2" = libgtest-dev ]; }

# ---------------------------------------------------------------- systems without apt

if ! command -v apt-get >/dev/null 2>&1 || ! command -v dpkg-query >/dev/null 2>&1; then
  say "this system has no apt: using what exists"
  lacking=0
  for row in "${rows[@]}"; do
    IFS='|' read -r group package why probe <<<"$row"
    if seen "$probe"; then continue; fi
    say "missing: $why (in Debian the package $package)"
    if needed "$group" "$package"; then lacking=1; fi
  done
  if [ $lacking -ne 0 ]; then say "install the above by hand" >&2; exit 4; fi
  exit 0
fi

# ---------------------------------------------------------------- Debian and its kin

packages=()
for row in "${rows[@]}"; do
  IFS='|' read -r _ package _ _ <<<"$row"
  packages+=("$package")
done
installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null |
            sed -n 's/ installed$//p' || true)
missing=()
for row in "${rows[@]}"; do
  IFS='|' read -r _ package _ probe <<<"$row"
  if grep -qxF "$package" <<<"$installed" || seen "$probe" commands; then continue; fi
  missing+=("$row")
done
if [ ${#missing[@]} -eq 0 ]; then
  say "all ${#packages[@]} packages are there"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null 2>&1; then
    say "not root and no sudo: run scripts/install-deps.sh as root first" >&2
    exit 4
  fi
  as_root=(sudo)
  if [ ! -t 0 ]; then as_root=(sudo -n); fi
fi
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 \
    -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 "$@" </dev/null
}

say "refreshing the package lists${as_root[*]:+ (with sudo)}"
if ! apt update; then say "apt-get update failed; trying with the lists that are there" >&2; fi

wanted=()
essential=()
optional=()
unavailable=0
for row in "${missing[@]}"; do
  IFS='|' read -r group package why _ <<<"$row"
  policy=$(LC_ALL=C apt-cache policy "$package")
  if [[ $policy =~ Candidate:\ [^\(] ]]; then
    if [ ${#wanted[@]} -eq 0 ]; then say "installing, without recommended extras:"; fi
    printf '  %-22s %s\n' "$package" "$why"
    wanted+=("$package")
    if needed "$group" "$package"; then essential+=("$package"); else optional+=("$package"); fi
  else
    say "not offered by this system: $package ($why)"
    if needed "$group" "$package"; then unavailable=1; fi
  fi
done
if [ $unavailable -ne 0 ]; then say "cannot go on without the packages above" >&2; exit 4; fi
if [ ${#wanted[@]} -eq 0 ]; then exit 0; fi

apt_install() { apt install -y --no-install-recommends "$@" >/dev/null; }
if apt_install "${wanted[@]}"; then
  say "installed ${#wanted[@]} packages"
  exit 0
fi

# Some package does not fit this system: what is needed goes in together, the rest one by one.
say "these packages cannot be installed together; trying them apart" >&2
if [ ${#essential[@]} -gt 0 ] && ! apt_install "${essential[@]}"; then
  say "apt-get install failed" >&2
  exit 4
fi
for package in ${optional[@]+"${optional[@]}"}; do
  if ! apt_install "$package"; then
    say "left out, apt-get cannot install it: $package" >&2
  fi
done
