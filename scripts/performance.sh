#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# performance.sh [FILTER]: runs calot-bench twice, on as quiet a machine as there is, and writes the headline figures of both runs with the
# machine's name and their bounds into docs/explanation/performance.md, and the diagram of time against error beside it. With a filter (of
# Google Benchmark) only those that it names are run, and the table holds those alone.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

if [[ $# -gt 1 ]]; then
  echo "usage: performance.sh [FILTER]" >&2
  exit 2
fi
filter=${1:-.}
"$root/scripts/setup.sh" python3-matplotlib
configure release "${whole[@]}" -DBUILD_TESTING=ON
build release calot-bench calot-box-unbound
folder=$root/build/performance
mkdir -p "$folder"
for run in 1 2; do
  say "run $run of 2"
  "$root/build/release/bin/calot-bench" --force --benchmark_filter="$filter" --figures "$folder/run$run.json" >"$folder/run$run.txt" 2>&1
done
"$python" -B "$root/scripts/performance.py" --root "$root" "$folder/run1.json" "$folder/run2.json"
