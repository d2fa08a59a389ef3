#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# cohort.sh N [FOLDER]: N synthetic attempts of each profile at the whole operation, recorded and assessed into
# FOLDER/cohort.db for `calot study`. Several run at once (CALOT_JOBS); what is there already and would be made again
# alike is kept, so an interrupted run goes on where it was. Performers prove the pipeline, never a trainer's validity.
#   CALOT_SCENE     another scene (cholecystectomy)      CALOT_PROFILES  ("skilled intermediate unskilled")
#   CALOT_PROGRAM   another calot (build/release/bin/calot, built where it is missing)
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

if [[ $# -lt 1 || $# -gt 2 || ! $1 =~ ^[1-9][0-9]*$ ]]; then
  echo "usage: cohort.sh N [FOLDER]" >&2
  exit 2
fi
count=$1
folder=${2:-$root/build/cohort}
scene=${CALOT_SCENE:-cholecystectomy}
read -r -a profiles <<<"${CALOT_PROFILES:-skilled intermediate unskilled}"
calot=${CALOT_PROGRAM:-$root/build/release/bin/calot}
if [[ ! -x $calot ]]; then
  configure release
  build release calot
fi
mkdir -p "$folder"

# one PROFILE SEED: records unless the recording is there; a word on a line of its own says which.
one() {
  local profile=$1 seed=$2
  local recording=$folder/$scene-$profile-$seed.h5
  if "$python" -B "$root/scripts/reusable.py" "$recording" --root "$root" --scene "$scene" --performer "$profile" \
    --seed "$seed" >/dev/null 2>&1; then
    echo "kept $(basename "$recording")"
    return
  fi
  if "$calot" record --scene "$scene" --performer "$profile" --seed "$seed" --participant "synthetic-$profile-$seed" \
    --mode assessment --force -o "$recording" >"$recording.log" 2>&1; then
    rm -f "$recording.log"
    echo "made $(basename "$recording")"
  else
    echo "FAILED $(basename "$recording"), see $recording.log"
  fi
}
export -f one
export root folder scene calot

total=$((count * ${#profiles[@]}))
say "$total attempts at $scene, $jobs at once, in $folder"
done=0
failed=0
while read -r word; do
  done=$((done + 1))
  say "$done of $total: $word"
  if [[ $word == FAILED* ]]; then failed=$((failed + 1)); fi
done < <(
  for ((seed = 1; seed <= count; ++seed)); do
    for profile in "${profiles[@]}"; do printf '%s %s\n' "$profile" "$seed"; done
  done | xargs -P "$jobs" -L 1 bash -c 'one "$@"' one
)
if [[ $failed -gt 0 ]]; then
  say "$failed recordings failed" >&2
  exit 1
fi

recordings=()
for profile in "${profiles[@]}"; do
  for ((seed = 1; seed <= count; ++seed)); do recordings+=("$folder/$scene-$profile-$seed.h5"); done
done
say "assess: re-simulates every recording, which is its verification"
"$calot" assess "${recordings[@]}" --cohort "$folder/cohort.db"
say "done: $calot study $folder/cohort.db --group-by performer --include-synthetic"
