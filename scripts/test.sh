#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the release preset and runs every test that is not labelled `heavy`. Arguments go to ctest (-R NAME, -L LABEL).
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$root/scripts/setup.sh" test
configure release -DBUILD_TESTING=ON
build release
say "test release"
# One more than there are processors: some tests wait for devices, folders and clocks.
ctest --test-dir "$root/build/release" --label-exclude heavy --parallel "$((jobs + 1))" --output-on-failure --no-tests=error "$@"
say "passed"
