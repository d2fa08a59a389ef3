#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The documentation as a site in build/site (build/site/index.html opens it), with the reference of the public headers in build/site/api.
# Fails on a warning of either, on a link that leads nowhere and on an anchor that is not there. Installs what it needs.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$root/scripts/setup.sh" docs

say "site"
cd "$root"
rm -rf "$root/build/site"
# A warning is an error (strict). Debian's interpreter and no user's packages: the tool is Debian's, too.
"$python" -s -m mkdocs build --quiet --strict --site-dir "$root/build/site"

say "reference of the public headers"
(cat "$root/docs/Doxyfile"; echo "OUTPUT_DIRECTORY = $root/build/site") | doxygen -

say "links"
"$python" -B "$root/scripts/docs_links.py" "$root/build/site"

say "built: build/site/index.html, build/site/api/index.html"
