#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# convergence.sh [SECONDS]: does the grade depend on mesh and step? One performer's samples run open-loop through the scenes with other meshes
# and steps; prints every checkpoint of each beside the finest run's, as tables in the form of docs/explanation/mesh-and-step.md. Takes minutes to an hour; with
# SECONDS, only so many of the attempts.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

if [[ $# -gt 1 ]]; then
  echo "usage: convergence.sh [SECONDS]" >&2
  exit 2
fi
"$root/scripts/setup.sh"
configure release "${whole[@]}" -DBUILD_TESTING=ON
build release test_convergence
CALOT_HEAVY=${1:-1} "$root/build/release/bin/test_convergence" --gtest_filter='*MeshAndStepHeavy.*'
