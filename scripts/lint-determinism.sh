#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Refuses what the determinism contract forbids (docs/explanation/determinism.md), wrong includes, unkept files, flags in libraries and retired words.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$python" -B "$root/tests/structure/determinism_lint.py" --self-test
"$python" -B "$root/tests/structure/determinism_lint.py" "$root"
"$python" -B "$root/tests/structure/includes_test.py" --self-test
"$python" -B "$root/tests/structure/includes_test.py" "$root"
"$python" -B "$root/tests/structure/house_test.py" --self-test
"$python" -B "$root/tests/structure/house_test.py" "$root"
"$python" -B "$root/tests/structure/errors_test.py" --self-test
"$python" -B "$root/tests/structure/errors_test.py" "$root"
"$python" -B "$root/tests/structure/words_test.py" --self-test
"$python" -B "$root/tests/structure/words_test.py" "$root"
