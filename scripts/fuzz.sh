#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Coverage-guided fuzzing of all that reads foreign files, by libFuzzer under sanitizers (docs/how-to/testing.md, "Fuzzing").
# usage: fuzz.sh [TARGET...], all by default. CALOT_FUZZ_RUNS (executions of all targets together, default 10^8) are shared
# among them by what one costs; CALOT_FUZZ_SEED (default 1). What is found lies in build/fuzz/found; the committed corpora are
# read, and what is new of them is kept in build/fuzz/corpus.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# Of ten thousand executions, by what one costs: of a recording, which is a file, forty are read in a second, of messages
# and meshes thirty thousand at first and some thousands once the corpus has grown.
declare -A share=([recording]=5 [database]=10 [scene]=200 [mesh]=3600 [kinematics]=2400 [csv]=600 [protocol]=200 [form]=200 [openigtlink]=2785)
targets=(recording database scene mesh kinematics csv protocol form openigtlink)
if [[ $# -gt 0 ]]; then targets=("$@"); fi
runs=${CALOT_FUZZ_RUNS:-100000000}
seed=${CALOT_FUZZ_SEED:-1}

configure fuzz
build fuzz "${targets[@]/#/fuzz_}"
mkdir -p "$root/build/fuzz/found"
for target in "${targets[@]}"; do
  corpus="$root/build/fuzz/corpus/$target"
  mkdir -p "$corpus"
  say "$target: $((runs * share[$target] / 10000)) executions, seed $seed"
  # 4 KB are enough to be wrong in, of a database its pages. An input that takes ten seconds or 2 GB is one that was found.
  longest=4096
  if [[ $target == database ]]; then longest=1048576; fi
  "$root/build/fuzz/bin/fuzz_$target" -runs=$((runs * share[$target] / 10000)) -seed="$seed" -max_len="$longest" -timeout=10 -rss_limit_mb=2048 \
    -print_final_stats=1 -artifact_prefix="$root/build/fuzz/found/$target-" "$corpus" "$root/tests/fuzz/corpus/$target" \
    >"$root/build/fuzz/$target.log" 2>&1 || {
    tail -n 40 "$root/build/fuzz/$target.log" >&2
    say "$target: an input was found: build/fuzz/found" >&2
    exit 1
  }
  grep -E "stat::number_of_executed_units" "$root/build/fuzz/$target.log"
done
