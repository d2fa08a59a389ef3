#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what Calot is built and checked with on Debian 12 (docs/reference/dependencies.md says what for). Does nothing when all
# is there. As root, or with sudo. More packages may be named.
set -euo pipefail

packages=(
  # build
  cmake ninja-build g++ pkg-config git ca-certificates
  libeigen3-dev libxxhash-dev libhdf5-dev libsodium-dev libsqlite3-dev libsqlitecpp-dev libboost-dev
  nlohmann-json3-dev libfmt-dev libspdlog-dev libcli11-dev libpng-dev libosmesa6-dev libegl-dev
  libavcodec-dev libavformat-dev libavutil-dev libswscale-dev libapriltag-dev libfreetype-dev
  libsdl2-dev libopenigtlink-dev libspnav-dev libseccomp-dev
  qt6-base-dev qt6-charts-dev libqt6opengl6-dev libbullet-dev
  pybind11-dev python3-dev
  # run
  fonts-dejavu-core
  # tests and checks
  xvfb xauth libgtest-dev libbenchmark-dev python3 python3-h5py python3-scipy python3-pandas hdf5-tools
  clang clang-format clang-tidy libclang-rt-14-dev shellcheck reuse valgrind
  g++-aarch64-linux-gnu qemu-user nodejs
  "$@"
)

installed=$(dpkg-query --show --showformat '${Package} ${Status}\n' "${packages[@]}" 2>/dev/null || true)
missing=()
for package in "${packages[@]}"; do
  grep -qx "$package install ok installed" <<<"$installed" || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "setup: all ${#packages[@]} packages are installed"
  exit 0
fi

asRoot=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "setup: ${missing[*]} missing and no sudo here: run scripts/setup.sh as root" >&2
    exit 1
  fi
  asRoot=(sudo)
fi
echo "setup: installing ${#missing[@]} packages: ${missing[*]}"
aptGet=("${asRoot[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=400 -qq)
"${aptGet[@]}" update
"${aptGet[@]}" install --yes --no-install-recommends "${missing[@]}" >/dev/null
echo "setup: done"
