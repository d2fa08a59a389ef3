#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# demo.sh [--windows]: from a clean clone to graded attempts. Builds the command line alone, then records, proves, assesses and draws one short
# attempt, and says where to look. Then two synthetic performers do the whole operation; every recording is re-simulated bit for bit while
# it is assessed into a cohort database. --windows builds the dashboard and the trainer, too. All that it makes lies below demo/. Run
# again, it keeps what this build would make again. What it prints fits one screen; the rest is in demo/*/demo.log.
#   CALOT_SCENE    another scene (cholecystectomy)      CALOT_ATTEMPTS   of each performer (1)
#   CALOT_PROGRAM  another calot: nothing is installed or built then   CALOT_DEMO   another folder (demo)
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

if [[ $# -gt 1 || ($# -eq 1 && $1 != --windows) ]]; then
  echo "usage: demo.sh [--windows]" >&2
  exit 2
fi
attempts=${CALOT_ATTEMPTS:-1}
scene=${CALOT_SCENE:-cholecystectomy}
# megabytes FILE...: what they take on the disk.
megabytes() { du -scm "$@" 2>/dev/null | tail -n 1 | cut -f 1; }

if [[ -z ${CALOT_PROGRAM:-} ]]; then
  echo "The command line is built first (minutes), then a first attempt is shown, then whole operations; 1 GB of disk, and 1 GB of packages where none are there."
  "$root/scripts/setup.sh" demo
  # A tree that has more keeps it.
  [[ -f $root/build/release/CMakeCache.txt ]] || configure release "${first[@]}"
  build release calot calot-engine
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

say "first attempt: a synthetic performer touches the liver; recorded, replayed bit for bit, assessed, drawn; tail -f $log"
logged "$calot" record --scene touch-liver --performer skilled --seed 1 --force -o "$demo/first.h5"
logged "$calot" replay "$demo/first.h5"
rm -f "$demo"/first.db*
logged "$calot" assess "$demo/first.h5" --cohort "$demo/first.db"
logged "$calot" render "$demo/first.h5" --at 5 --force -o "$demo/first.png"
say "look at it: $demo/first.png; its figures: $calot assess $demo/first.h5"

say "$scene by two performers, recorded and assessed"
export CALOT_PROFILES="skilled unskilled" CALOT_SCENE=$scene CALOT_PROGRAM=$calot
logged "$root/scripts/cohort.sh" "$attempts" "$demo"

say "study: the two profiles side by side (synthetic performers: no statement about people)"
"$calot" study --cohort "$demo/cohort.db" --group-by performer --include-synthetic >"$demo/study.txt"
# The figures that the paper has.
sed -n '/^Figures of the paper/,/^$/p' "$demo/study.txt"

say "draw"
rm -f "$demo"/operation-*-s.png
# An attempt that ended before has no such moment.
printf '%s\n' 15 30 60 90 | xargs -P "$jobs" -I '{}' "$calot" render "$demo/$scene-skilled-1.h5" --at '{}' --size 1280x720 \
  -o "$demo/operation-{}-s.png" >>"$log" 2>&1 || true
if ! compgen -G "$demo/operation-*-s.png" >/dev/null; then
  tail -n 1 "$log" >&2
  exit 1
fi

say "done: ${built} s to build, $((SECONDS - built)) s to run, $(megabytes "$demo") MB in $demo"
echo "study:           $demo/study.txt"
echo "cohort database: $demo/cohort.db"
echo "pictures:        $demo/operation-*.png"
if [[ ${1:-} == --windows ]]; then
  "$root/scripts/setup.sh" build
  configure release "${whole[@]}" -DBUILD_TESTING=OFF
  build release calot calot-engine calot_modules calot-dashboard calot-trainer
  echo "look at it:      $(dirname "$calot")/calot-dashboard $demo/cohort.db"
else
  echo "look at it:      scripts/demo.sh --windows builds the dashboard and the trainer"
fi
