#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From a clean clone to graded attempts: builds Calot, lets two synthetic performers clip and cut duct and artery three times
# each, re-simulates every recording bit for bit while it is assessed into a cohort database, compares the two profiles,
# and draws three moments. All that it makes lies below demo/. Run again, it keeps what this build would make again.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

scene=clip-and-cut
attempts=3

"$root/scripts/setup.sh"
configure release
build release calot calot-dashboard
calot=$root/build/release/bin/calot
# Attempts of another simulation version do not compare: each has its folder.
demo=$root/demo/simulation-$("$calot" --version | sed 's/.*simulation version //')
mkdir -p "$demo"

say "record and assess (each is re-simulated: every step and force, bit for bit)"
CALOT_SCENE=$scene CALOT_PROFILES="skilled unskilled" "$root/scripts/cohort.sh" "$attempts" "$demo"
"$calot" replay "$demo/$scene-skilled-1.h5"

say "study: the two profiles side by side (synthetic performers: no statement about people)"
"$calot" study "$demo/cohort.db" --group-by performer --include-synthetic

say "draw"
for time in 2 15 30; do
  "$calot" render "$demo/$scene-skilled-1.h5" --at "$time" --size 1280x720 --force -o "$demo/$scene-$time-s.png"
done

say "done"
echo "cohort database: $demo/cohort.db   (look at it: $root/build/release/bin/calot-dashboard $demo/cohort.db)"
echo "pictures:        $demo/$scene-*.png"
