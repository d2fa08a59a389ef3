#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the Debian packages in build/packages, with a bill of materials (SPDX), and holds them against lintian. Made so that the same source gives the
# same bytes (docs/how-to/installing.md).
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$root/scripts/setup.sh" build dpkg-dev file fakeroot lintian reuse desktop-file-utils appstream libxml2-utils
SOURCE_DATE_EPOCH=$(dpkg-parsechangelog --file "$root/packaging/debian/changelog" --show-field Timestamp)
export SOURCE_DATE_EPOCH
umask 022  # folders of the packages are for all to read

configure package
build package calot_packaged
"$root/scripts/docs.sh"
say "bill of materials"
"$python" -B "$root/scripts/bill.py" "$root" --date "$SOURCE_DATE_EPOCH" --output "$root/build/package/packaging/calot.spdx"
desktop-file-validate "$root"/packaging/desktop/*.desktop
appstreamcli validate --no-net "$root"/packaging/metainfo/*.xml
xmllint --noout "$root/packaging/mime/calot.xml"

say "packages"
rm -rf "$root/build/package/packages"
(cd "$root/build/package" && cpack --config CPackConfig.cmake >cpack.log 2>&1) || {
  cat "$root/build/package/cpack.log" >&2
  exit 1
}
rm -rf "$root/build/packages"
mkdir -p "$root/build/packages"
cp "$root"/build/package/packages/*.deb "$root/build/packages/"
say "lintian"
# As whoever builds may be root here.
lintian --allow-root --fail-on error --profile debian "$root"/build/packages/*.deb
(cd "$root/build/packages" && sha256sum -- *.deb)
say "passed"
