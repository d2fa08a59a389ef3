#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From a clean clone to graded attempts: builds Calot, lets two synthetic performers touch the liver three times each,
# replays every recording bit for bit, assesses them into a cohort database, compares the two profiles, draws a moment.
# All that it makes lies in demo/. Run again, it re-uses recordings that this build would make again, and says which.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

scene=touch-liver
attempts=3
demo=$root/demo

"$root/scripts/setup.sh"
configure release
build release calot calot-dashboard
calot=$root/build/release/bin/calot
mkdir -p "$demo"

recordings=()
reused=()
for profile in skilled unskilled; do
  for ((seed = 1; seed <= attempts; ++seed)); do
    recording=$demo/$profile-$seed.h5
    recordings+=("$recording")
    if why=$("$python" -B "$root/scripts/reusable.py" "$recording" --root "$root" --scene "$scene" --performer "$profile" \
      --seed "$seed"); then
      reused+=("$(basename "$recording")")
      continue
    fi
    say "record $(basename "$recording") ($why)"
    "$calot" record --scene "$scene" --performer "$profile" --seed "$seed" --participant "synthetic-$profile-$seed" \
      --mode assessment --force -o "$recording"
  done
done
if [[ ${#reused[@]} -gt 0 ]]; then
  say "re-used ${#reused[@]} recordings (same simulation version, scene, performer and seed): ${reused[*]}"
fi

say "replay: every step and force, bit for bit"
"$calot" replay "${recordings[@]}"

say "assess into the cohort database (re-simulates each recording)"
"$calot" assess "${recordings[@]}" --cohort "$demo/cohort.db"

say "study: the two profiles side by side (synthetic performers: no statement about people)"
"$calot" study "$demo/cohort.db" --group-by performer --include-synthetic

say "draw"
"$calot" render "$demo/skilled-1.h5" --at 4 --size 1280x720 --force -o "$demo/$scene.png"

say "done"
echo "cohort database: $demo/cohort.db   (look at it: $root/build/release/bin/calot-dashboard $demo/cohort.db)"
echo "picture:         $demo/$scene.png"
