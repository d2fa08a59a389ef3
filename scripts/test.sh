#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# test.sh [-R SUITE | CTEST'S ARGUMENTS]: builds the release preset and runs every test that is not labelled `heavy`. Arguments go to ctest
# (-R NAME, -L LABEL). Where -R begins with a test program's name ("math.", "math.Elementary"), that program alone is built.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$root/scripts/setup.sh" test
configure release "${whole[@]}" -DBUILD_TESTING=ON
targets=()
if [[ $# -eq 2 && $1 == -R && $2 =~ ^\^?([a-z_]+)\\?\. ]]; then
  program=test_${BASH_REMATCH[1]}
  if ninja -C "$root/build/release" -t query "$program" >/dev/null 2>&1; then targets=("$program"); fi
fi
build release "${targets[@]}"
say "test release"
# One more than there are processors: some tests wait for devices, folders and clocks.
ctest --test-dir "$root/build/release" --label-exclude heavy --parallel "$((jobs + 1))" --output-on-failure --no-tests=error "$@"
say "passed"
