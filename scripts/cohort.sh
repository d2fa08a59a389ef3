#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# cohort.sh N [FOLDER]: N synthetic attempts of each profile at the whole operation, recorded and assessed into
# FOLDER/cohort.db for `calot study`. Several run at once (CALOT_JOBS). What is there already and would be made again
# alike is kept, recordings and assessments, so an interrupted run goes on where it was. Seeds come before profiles: a
# run that is cut short has as many of each. Performers prove the pipeline, never a trainer's validity.
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
  configure release "${first[@]}"
  build release calot
fi
mkdir -p "$folder"

# one PROFILE SEED: records and assesses what is not there yet; says so in one line.
one() {
  local profile=$1 seed=$2
  local recording=$folder/$scene-$profile-$seed.h5
  local name assessed=$recording.assessed made="kept"
  name=$(basename "$recording")
  if ! "$python" -B "$root/scripts/reusable.py" "$recording" --root "$root" --scene "$scene" --performer "$profile" \
    --seed "$seed" >/dev/null 2>&1; then
    rm -f "$assessed"
    if ! "$calot" record --scene "$scene" --performer "$profile" --seed "$seed" \
      --participant "synthetic-$profile-$seed" --mode assessment --force -o "$recording" >"$recording.log" 2>&1; then
      echo "FAILED $name: recording, see $recording.log"
      return
    fi
    made=$(tail -n 1 "$recording.log" | sed 's/.*attempt [^,]*, //')
    rm -f "$recording.log"
  fi
  if [[ -f $folder/cohort.db && $assessed -nt $recording && $assessed -nt $calot ]]; then
    echo "$name: $made, assessed before"
  elif "$calot" assess "$recording" --threads "$jobs" --cohort "$folder/cohort.db" >"$recording.log" 2>&1; then
    rm -f "$recording.log"
    touch "$assessed"
    echo "$name: $made, assessed"
  else
    echo "FAILED $name: $made, but assessing it failed, see $recording.log"
  fi
}
export -f one
export root folder scene calot jobs

total=$((count * ${#profiles[@]}))
say "$total attempts at $scene, $jobs at once, in $folder (each is re-simulated as it is assessed)"
finished=0
failed=0
while read -r line; do
  finished=$((finished + 1))
  say "$finished of $total: $line"
  if [[ $line == FAILED* ]]; then failed=$((failed + 1)); fi
done < <(
  for ((seed = 1; seed <= count; ++seed)); do
    for profile in "${profiles[@]}"; do printf '%s %s\n' "$profile" "$seed"; done
  done | xargs -P "$jobs" -L 1 bash -c 'one "$@"' one
)
if [[ $failed -gt 0 || $finished -lt $total ]]; then
  say "$((total - finished + failed)) of $total attempts are missing" >&2
  exit 1
fi
say "done: $calot study $folder/cohort.db --group-by performer --include-synthetic"
