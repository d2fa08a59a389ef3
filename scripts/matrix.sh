#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The determinism matrix: the core alone, built by several compilers for several machines, must print the same digests.
# See scripts/matrix.py --help. Needs the release build of calot.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

exec "$python" -B "$root/scripts/matrix.py" --calot "$root/build/release/bin/calot" --work "$root/build/release/matrix" --jobs "$jobs" "$@"
