#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the packages of the committed source in another folder, with another time zone, and compares them with those in build/packages byte
# for byte. Takes a whole build.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

if [[ -n $(git -C "$root" status --porcelain) ]]; then
  echo "package-again: there are changes that are not committed: only what is committed can be built again" >&2
  exit 2
fi
other=$(mktemp --directory --suffix=-calot)
trap 'rm -rf "$other"' EXIT
git clone --quiet "$root" "$other/a-folder-of-another-name"
(TZ=Pacific/Auckland; export TZ; "$other/a-folder-of-another-name/scripts/package.sh")
differ=0
for package in "$root"/build/packages/*.deb; do
  cmp "$package" "$other/a-folder-of-another-name/build/packages/$(basename "$package")" || differ=1
done
if [[ $differ -ne 0 ]]; then
  echo "package-again: packages differ (diffoscope shows where)" >&2
  exit 3
fi
say "passed: the same bytes"
