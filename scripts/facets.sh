#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# facets.sh [--scene S] [--seeds N] [--fine-seeds M] [--seconds T] [--jobs J] [--keep] -o FOLDER: how much of each figure's
# variance is of people, and how much of mesh and step? Performers operate closed loop, each seed anew on each discretisation
# (scripts/facets.py lists them): N seeds a profile (20), at four times the elements M (5; 0: none), the whole attempt or its first T seconds.
# Each attempt becomes one file of figures in FOLDER/attempts, written as a whole; its recording is deleted unless --keep. What is there and would be
# made again alike is kept, what is broken or of another version is made again, so a run that was stopped goes on where it was. Ends with the
# table of docs/explanation/mesh-and-step.md in FOLDER/facets.md.
#   CALOT_PROGRAM   another calot (build/release/bin/calot, built where it is missing)
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
  echo 'usage: facets.sh [--scene S] [--seeds N] [--fine-seeds M] [--seconds T] [--jobs J] [--keep] -o FOLDER' >&2
  exit 2
}
scene=cholecystectomy
seeds=20
fine_seeds=5
seconds=0
folder=""
keep=()
while [[ $# -gt 0 ]]; do
  if [[ $1 == --keep ]]; then
    keep=(--keep)
    shift
    continue
  fi
  if [[ $# -lt 2 ]]; then usage; fi
  case $1 in
    --scene) scene=$2 ;;
    --seeds) seeds=$2 ;;
    --fine-seeds) fine_seeds=$2 ;;
    --seconds) seconds=$2 ;;
    --jobs) jobs=$2 ;;
    -o | --output) folder=$2 ;;
    *) usage ;;
  esac
  shift 2
done
if [[ -z $folder || ! $seeds =~ ^[1-9][0-9]*$ || $seeds -lt 2 || ! $fine_seeds =~ ^[0-9]+$ || ! $jobs =~ ^[1-9][0-9]*$ ||
  ! $seconds =~ ^[0-9]+(\.[0-9]+)?$ ]]; then usage; fi

calot=${CALOT_PROGRAM:-$root/build/release/bin/calot}
if [[ ! -x $calot ]]; then
  configure release "${first[@]}"
  build release calot
fi
mkdir -p "$folder"
exec 9>"$folder/lock"
if ! flock --wait 5 9; then
  echo "facets.sh: $folder: another run is at work there" >&2
  exit 1
fi
facets=("$python" -B "$root/scripts/facets.py")
study=(--folder "$folder" --calot "$calot" --scene "$scene" --seconds "$seconds" --seeds "$seeds" --fine-seeds "$fine_seeds" --jobs "$jobs")
"${facets[@]}" prepare "${study[@]}"
list=$("${facets[@]}" missing "${study[@]}")
left=0
if [[ -n $list ]]; then left=$(wc -l <<<"$list"); fi
say "$left attempts to make at $scene, $jobs at once, in $folder"

failed=0
while read -r line; do
  say "$line"
  if [[ $line == FAILED* ]]; then failed=$((failed + 1)); fi
done < <(if [[ $left -gt 0 ]]; then xargs -P "$jobs" -L 1 "${facets[@]}" attempt "${study[@]}" "${keep[@]}" --which <<<"$list" || true; fi)

"${facets[@]}" table "${study[@]}"
if [[ $failed -gt 0 ]]; then
  say "$failed attempts failed; the same command tries them again" >&2
  exit 1
fi
say "done: $folder/facets.md"
