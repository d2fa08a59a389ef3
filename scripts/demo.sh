#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From a clean clone to graded attempts: builds Calot, lets two synthetic performers do the whole operation three times
# each, re-simulates every recording bit for bit while it is assessed into a cohort database, compares the two profiles,
# and draws moments of the operation. All that it makes lies below demo/. Run again, it keeps what this build would make
# again. What it prints fits one screen; the rest is in demo/*/demo.log.
#   CALOT_SCENE    another scene (cholecystectomy)      CALOT_ATTEMPTS   of each performer (3)
#   CALOT_PROGRAM  another calot: nothing is installed or built then   CALOT_DEMO   another folder (demo)
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

attempts=${CALOT_ATTEMPTS:-3}
scene=${CALOT_SCENE:-cholecystectomy}
# megabytes FILE...: what they take on the disk.
megabytes() { du -scm "$@" 2>/dev/null | tail -n 1 | cut -f 1; }

if [[ -z ${CALOT_PROGRAM:-} ]]; then
  echo "On two processors: about 15 minutes to build (later: seconds), 12 to run; 2 GB of disk, and 1 GB of packages where none are there."
  "$root/scripts/setup.sh" demo
  # What README.md runs next is there afterwards. Tests are scripts/test.sh's.
  configure release -DBUILD_TESTING=OFF
  build release calot calot-dashboard calot-trainer calot-engine
fi
calot=${CALOT_PROGRAM:-$root/build/release/bin/calot}
built=$SECONDS
# Attempts of another simulation version do not compare: each has its folder.
demo=${CALOT_DEMO:-$root/demo}/simulation-$("$calot" --version | sed 's/.*simulation version //')
mkdir -p "$demo"
log=$demo/demo.log
: >"$log"
# logged COMMAND...: its output goes to the log; where it fails, the end of that to the screen.
logged() {
  if ! "$@" >>"$log" 2>&1; then
    tail -n 5 "$log" >&2
    say "failed: $* (all it said: $log)" >&2
    exit 1
  fi
}

say "$scene, $attempts times each, recorded and assessed (each is re-simulated: every step and force, bit for bit); tail -f $log"
export CALOT_PROFILES="skilled unskilled" CALOT_SCENE=$scene CALOT_PROGRAM=$calot
logged "$root/scripts/cohort.sh" "$attempts" "$demo"

say "study: the two profiles side by side (synthetic performers: no statement about people)"
"$calot" study --cohort "$demo/cohort.db" --group-by performer --include-synthetic >"$demo/study.txt"
# The figures that the paper has.
sed -n '/^Figures of the paper/,/^$/p' "$demo/study.txt"

say "draw"
for time in 15 30 60 90; do
  # An attempt that ended before has no such moment.
  if "$calot" render "$demo/$scene-skilled-1.h5" --at "$time" --size 1280x720 --force -o "$demo/operation-$time-s.png" >>"$log" 2>&1; then
    drawn=$time
  fi
done
if [[ -z ${drawn:-} ]]; then
  tail -n 1 "$log" >&2
  exit 1
fi

say "done: ${built} s to build, $((SECONDS - built)) s to run, $(megabytes "$demo") MB in $demo, $(megabytes "$root/build/release") MB built"
echo "study:           $demo/study.txt"
echo "cohort database: $demo/cohort.db"
echo "look at it:      $(dirname "$calot")/calot-dashboard $demo/cohort.db"
echo "pictures:        $demo/operation-*.png"
