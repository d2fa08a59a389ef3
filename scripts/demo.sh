#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From a clean clone to graded attempts: builds Calot, lets two synthetic performers do the whole operation three times
# each, re-simulates every recording bit for bit while it is assessed into a cohort database, compares the two profiles,
# and draws moments of the operation. All that it makes lies below demo/. Run again, it keeps what this build would make
# again.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$root/scripts/setup.sh"
configure release
build release calot calot-dashboard
calot=$root/build/release/bin/calot
# Attempts of another simulation version do not compare: each has its folder.
demo=$root/demo/simulation-$("$calot" --version | sed 's/.*simulation version //')
export CALOT_PROFILES="skilled unskilled"

say "the whole operation, three times each: record and assess (each is re-simulated: every step and force, bit for bit)"
"$root/scripts/cohort.sh" 3 "$demo"

say "study: the two profiles side by side (synthetic performers: no statement about people)"
"$calot" study "$demo/cohort.db" --group-by performer --include-synthetic

say "draw"
for time in 15 30 60 90; do
  "$calot" render "$demo/cholecystectomy-skilled-1.h5" --at "$time" --size 1280x720 --force -o "$demo/operation-$time-s.png"
done

say "done"
echo "cohort database: $demo/cohort.db"
echo "look at it:      $root/build/release/bin/calot-dashboard $demo/cohort.db"
echo "pictures:        $demo/operation-*.png"
