#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# sensitivity.sh [SECONDS [SCENE...]]: how much does the grade depend on the scenes' constants? One performer's samples run open-loop through dissect-bed,
# carve-fat, clip-and-cut and cholecystectomy, with one constant at a time 30 % smaller and 30 % larger; prints the change of each figure of the
# paper's Table 2 and of each force figure as tables. Runs share the processors. Takes hours; with SECONDS, only so many of the attempts; with
# scenes, only those.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

if [[ ${1:-1} =~ [^0-9.] ]]; then
  echo "usage: sensitivity.sh [SECONDS [SCENE...]]" >&2
  exit 2
fi
seconds=${1:-1}
filter=""
for scene in "${@:2}"; do
  if [[ ! -f "$root/assets/scenes/$scene.json" ]]; then
    echo "sensitivity.sh: no scene $scene" >&2
    exit 2
  fi
  filter+="*SensitivityHeavy.*/${scene//-/}:"
done
"$root/scripts/setup.sh"
configure release "${whole[@]}" -DBUILD_TESTING=ON
build release test_convergence
CALOT_HEAVY=$seconds "$root/build/release/bin/test_convergence" --gtest_filter="${filter:-*SensitivityHeavy.*}"
