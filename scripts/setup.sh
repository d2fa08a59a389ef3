#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# setup.sh [--list] [demo|build|test|checks|docs|all] [PACKAGE...]: installs what that takes on Debian 12
# (docs/reference/dependencies.md says what for), all by default. Does nothing when it is there. As root, or with sudo. More
# packages may be named. --list prints the packages instead.
#   demo    what scripts/demo.sh builds and runs      build   all programs and modules
#   test    build, and what scripts/test.sh runs      checks  test, and what scripts/checks.sh runs
#   docs    the site's tools
set -euo pipefail

demo=(
  cmake ninja-build g++ pkg-config git ca-certificates
  libeigen3-dev libxxhash-dev libhdf5-dev libsodium-dev libssl-dev libutf8proc-dev libsqlite3-dev libsqlitecpp-dev libboost-dev
  nlohmann-json3-dev libfmt-dev libspdlog-dev libcli11-dev libpng-dev libosmesa6-dev libegl-dev libfreetype-dev
  libseccomp-dev fonts-dejavu-core python3 python3-h5py
  # Optional, but whoever adds it later links the programs anew.
  libbullet-dev
)
build=("${demo[@]}" libavcodec-dev libavformat-dev libavutil-dev libswscale-dev libapriltag-dev libsdl2-dev libopenigtlink-dev
  libspnav-dev libcgal-dev libbenchmark-dev qt6-base-dev qt6-speech-dev qt6-declarative-dev pybind11-dev python3-dev)
test=("${build[@]}" libgtest-dev xvfb xauth python3-scipy python3-pandas python3-nacl hdf5-tools valgrind nodejs
  tmux shellcheck reuse clang-format)
docs=(mkdocs mkdocs-material doxygen)
checks=("${test[@]}" clang clang-tidy libclang-rt-14-dev g++-aarch64-linux-gnu qemu-user)

list=
if [[ ${1:-} == --list ]]; then
  list=1
  shift
fi
case ${1:-} in
  build) packages=("${build[@]}") && shift ;;
  demo) packages=("${demo[@]}") && shift ;;
  test) packages=("${test[@]}") && shift ;;
  docs) packages=("${docs[@]}") && shift ;;
  checks | all) packages=("${checks[@]}") && shift ;;
  -*)
    echo "usage: setup.sh [--list] [demo|build|test|checks|docs|all] [PACKAGE...]" >&2
    exit 2
    ;;
  *) packages=("${checks[@]}") ;;
esac
packages+=("$@")
if [[ -n $list ]]; then
  printf '%s\n' "${packages[@]}" | sort -u
  exit 0
fi

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
