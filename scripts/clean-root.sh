#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tries the packages where nothing else is: a new Debian 12 with what they depend on and nothing of a build tree. There the packages are
# installed, do the main job as a user without rights, answer by manual, completion and a double click, and are purged; then no file may be
# left that was not there before. As root (or with sudo). The packages: those of scripts/package.sh, or those in a folder that is named.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

packages=$(realpath "${1:-$root/build/packages}")
if [[ $(id -u) -ne 0 ]]; then exec sudo "$0" "$packages"; fi
"$root/scripts/setup.sh" mmdebstrap
shopt -s nullglob
debs=("$packages"/*.deb)
if [[ ${#debs[@]} -eq 0 ]]; then
  echo "clean-root: $packages: there is no package: run scripts/package.sh" >&2
  exit 4
fi

work=$(mktemp --directory)
trap 'rm -rf "$work"' EXIT
there=$work/root

# Depends alone, the first of alternatives, without our own: a dependency that is missing there is missing here.
own=$(for deb in "${debs[@]}"; do dpkg-deb --field "$deb" Package; done)
needed=$(for deb in "${debs[@]}"; do dpkg-deb --field "$deb" Depends; done | tr ',' '\n' | sed -E 's/^ *//; s/[ |(:].*//; /^$/d' | sort --unique |
  grep --line-regexp --invert-match --fixed-strings "$own" | paste --serial --delimiters ,)
looked=man-db,bash-completion,fish,libglib2.0-bin,desktop-file-utils
say "a new Debian 12 with what the packages depend on"
sources=(/etc/apt/sources.list.d/debian.sources)
if [[ ! -e ${sources[0]} ]]; then sources=(/etc/apt/sources.list); fi
mmdebstrap --quiet --variant=minbase --include="$needed,$looked" bookworm "$there" "${sources[@]}"

# inside COMMAND...: runs it there, with processes of its own.
inside() {
  # shellcheck disable=SC2016  # expanded there
  unshare --mount --pid --fork bash -c 'mount -t proc proc "$1/proc" && mount -t tmpfs tmpfs "$1/tmp" && root=$1 && shift && exec env --ignore-environment \
    PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive chroot "$root" "$@"' inside "$there" "$@"
}
# Of the tools there: their states, logs and what indexes of theirs make anew.
files() { (cd "$there" && find . -xdev -path ./var/lib/dpkg -prune -o -path ./var/log -prune -o -path ./var/cache/man -prune -o -print | sort); }

inside useradd --create-home --home-dir /srv/trainee trainee
files >"$work/before"
mkdir "$work/debs"
say "install"
mkdir "$there/packages"
cp "${debs[@]}" "$there/packages/"
inside bash -c 'dpkg --install /packages/*.deb' >"$work/install.log" 2>&1 || {
  cat "$work/install.log" >&2
  exit 1
}
install --mode 755 "$root/scripts/clean-root-job.sh" "$there/srv/trainee/job.sh"
say "main job, manual, completion, double click"
inside su trainee --command 'cd && ./job.sh'
say "purge"
# shellcheck disable=SC2086  # a word a package
inside dpkg --purge $own >"$work/purge.log" 2>&1 || {
  cat "$work/purge.log" >&2
  exit 1
}
rm -rf "$there/packages"
find "$there/srv/trainee" -mindepth 1 -delete
inside bash -c 'cp --recursive /etc/skel/. /srv/trainee'
files >"$work/after"
if ! diff "$work/before" "$work/after"; then
  echo "clean-root: the files before (<) and after (>) differ" >&2
  exit 3
fi
say "passed: $(wc -l <"$work/before") files before and after"
