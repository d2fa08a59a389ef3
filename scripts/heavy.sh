#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The long tests: everything labelled `heavy` (the whole determinism matrix among them), after all of the tree, tests
# included, was built and run by clang. Arguments go to ctest.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$root/scripts/setup.sh" checks slurm-wlm munge snakemake g++-riscv64-linux-gnu g++-arm-linux-gnueabihf g++-i686-linux-gnu \
  wasi-libc libc++-14-dev-wasm32 libc++abi-14-dev-wasm32 libclang-rt-14-dev-wasm32 lld-14 llvm-14 npm chromium firefox-esr xvfb
configure release "${whole[@]}" -DBUILD_TESTING=ON
build release
# Each source by itself: what one forgot to include, and names that hide others.
configure clang "-DCALOT_OTHER=$root/build/release/bin/calot" -DCALOT_UNITY=OFF
build clang
say "clang-tidy"
"$python" -B "$root/scripts/tidy.py" "$root/build/clang" --jobs "$jobs" --note
say "test clang"
ctest --test-dir "$root/build/clang" --label-exclude 'heavy|determinism' --parallel "$jobs" --output-on-failure --no-tests=error
say "all of the sanitizers' tests"
CALOT_CHECKS_ALL=1 "$root/scripts/checks.sh" asan-ubsan
say "heavy tests"
ctest --test-dir "$root/build/release" --label-regex heavy --output-on-failure --no-tests=error "$@"
say "performers of known order"
"$python" -B "$root/scripts/order.py"
say "what a simulation version adds to a clone"
"$python" -B "$root/scripts/engine.py" --jobs "$jobs" measure --calot "$root/build/release/bin/calot"
say "fuzzing"
"$root/scripts/fuzz.sh"
say "the attempt in a browser"
"$python" -B "$root/scripts/page.py" --jobs "$jobs"
node "$root/tests/page/page_test.mjs" --calot "$root/build/release/bin/calot"
xvfb-run --auto-servernum node "$root/tests/page/page_test.mjs" --calot "$root/build/release/bin/calot" --browser /usr/bin/firefox-esr --output "$root/build/page/pictures-firefox"
say "what is handed out, by validators from elsewhere"
npm install --silent --no-audit --no-fund --ignore-scripts --prefix "$root/build/validators" bids-validator@1.15.0 @learninglocker/xapi-validation@3.0.0
CALOT_VALIDATORS="$root/build/validators" ctest --test-dir "$root/build/release" --tests-regex python.exchange --output-on-failure --no-tests=error
say "packages, in a clean root, and once more from another folder"
"$root/scripts/package.sh"
"$root/scripts/clean-root.sh"
"$root/scripts/package-again.sh"
if [[ $# -eq 0 ]]; then
  say "a cohort of 10,000 recordings in shares"
  "$python" -B "$root/scripts/shares.py" 10000
fi
say "passed"
