# SPDX-License-Identifier: GPL-3.0-or-later
# Shared by the scripts here; to be sourced.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# Not another python of the path: h5py belongs to the distribution's.
export python=/usr/bin/python3
export QT_QPA_PLATFORM=${QT_QPA_PLATFORM:-offscreen}
jobs=${CALOT_JOBS:-$(nproc)}

# Options of a build tree that has what the first attempt needs, and of one that has all.
# shellcheck disable=SC2034  # used by those that source this
first=(-DCALOT_WINDOWS=OFF -DCALOT_PYTHON_MODULE=OFF -DBUILD_TESTING=OFF)
# shellcheck disable=SC2034
whole=(-DCALOT_WINDOWS=ON -DCALOT_PYTHON_MODULE=ON)

# say WORDS...: a progress line with the seconds since the script started.
say() { printf '[%4ds] %s: %s\n' "$SECONDS" "$(basename "$0" .sh)" "$*"; }

# configure PRESET [OPTION...]: build tree build/PRESET.
configure() {
  local preset=$1
  shift
  say "configure $preset"
  (cd "$root" && cmake --preset "$preset" "$@" >"$root/build/$preset.configure.log" 2>&1) || {
    cat "$root/build/$preset.configure.log" >&2
    say "configuring $preset failed" >&2
    exit 1
  }
}

# build PRESET [TARGET...]: all targets by default.
build() {
  local preset=$1
  shift
  say "build $preset ${*:-(all)}"
  local targets=()
  if [[ $# -gt 0 ]]; then targets=(--target "$@"); fi
  cmake --build "$root/build/$preset" --parallel "$jobs" "${targets[@]}" -- --quiet
}

mkdir -p "$root/build"
