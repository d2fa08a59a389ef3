#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Formats every C++ file by .clang-format; with --check, changes nothing and fails where one differs.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

mode=(-i)
if [[ ${1:-} == --check ]]; then mode=(--dry-run -Werror); fi
find "$root"/{sim,recorder,analytics,gui,apps,python,tests} \( -name '*.h' -o -name '*.cpp' \) -print0 |
  xargs -0 --no-run-if-empty --max-args=20 --max-procs="$jobs" clang-format "${mode[@]}"
