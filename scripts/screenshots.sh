#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Pictures of the dashboard's pages from a cohort database, under a virtual X server. Recordings beside the database are
# replayed in them.
#   scripts/screenshots.sh COHORT.db [FOLDER]        without FOLDER: docs/pictures, as WebP (pictures.py)
# The program is taken from build/release/bin, or from CALOT_BIN.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
  echo "usage: scripts/screenshots.sh COHORT.db [FOLDER]" >&2
  exit 2
fi
database=$1
folder=${2:-}
program=${CALOT_BIN:-$root/build/release/bin}/calot-dashboard
if [ ! -x "$program" ]; then
  echo "screenshots.sh: $program is not built; build it or set CALOT_BIN" >&2
  exit 1
fi
if ! command -v xvfb-run > /dev/null || ! command -v xauth > /dev/null; then
  echo "screenshots.sh: no virtual X server; install the packages xvfb and xauth" >&2
  exit 1
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/runtime"
chmod 700 "$work/runtime"
XDG_RUNTIME_DIR=$work/runtime XDG_CONFIG_HOME=$work/config QT_QPA_PLATFORM=xcb LC_ALL=C.UTF-8 \
  xvfb-run --auto-servernum --server-args="-screen 0 1600x1000x24" "$program" "$database" --pictures "$work"
pages=()
for page in attempts attempt compare study trainee pair ratings settings greeting; do
  if [ -f "$work/$page.png" ]; then
    mv "$work/$page.png" "$work/dashboard-$page.png"
    pages+=("$work/dashboard-$page.png")
  fi
done
if [ -n "$folder" ]; then
  mkdir -p "$folder"
  mv "${pages[@]}" "$folder"
else
  "$root/scripts/pictures.py" "${pages[@]}"
fi
