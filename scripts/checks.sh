#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What the release tests do not see: format, lints, the documentation's site, a guard of the run time, sanitizers on the
# fast tests (built by clang), clang-tidy with clang's warnings, and the short determinism matrix over what these built. `checks.sh STAGE...` runs only these
# stages. Two have to be asked for: `fast`, in minutes (format, lint, structure, tests and clang-tidy of what changed), and `clang`, the
# optimised programs by clang (heavy.sh builds and tests all by clang).
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$root/scripts/setup.sh" checks

stages=(format lint docs guard tidy asan-ubsan tsan matrix)
if [[ $# -gt 0 ]]; then stages=("$@"); fi

# Targets of the fast tests, so that a sanitizer's tree holds nothing else: what reads files of others, and what manages memory or threads.
# The simulation runs under sanitizers in the stage matrix. Threads run only in the recorder's rooms.
fastTests=(test_formats test_recording test_recorder conformance_reader)
fastLabels='unit|recording|statistics'
# Of numbers, of devices and cohorts, and the fuzzer's corpora: heavy.sh has them under sanitizers, too.
if [[ -n ${CALOT_CHECKS_ALL:-} ]]; then
  fastTests+=(fuzz_corpus test_sources test_analytics test_checkpoints test_math test_geometry test_vessel test_carving test_fat test_connective test_sim test_statistics test_design test_report)
  fastLabels+='|fuzz'
fi
threadTests=(test_recording test_recorder conformance_reader)

# fast PRESET LABELS TARGET...: builds these test programs and runs their tests of these labels; heavy ones are left out, and
# those that tests/sanitizers.txt names.
fast() {
  local preset=$1 labels=$2
  shift 2
  configure "$preset"
  build "$preset" "$@"
  say "test $preset"
  ctest --test-dir "$root/build/$preset" --label-regex "$labels" --label-exclude heavy --parallel "$jobs" \
    --output-on-failure --no-tests=error
}

# What each stage took on two idle cores (min).
declare -A minutes=([docs]=1 [guard]=1 [asan-ubsan]=10 [tsan]=5 [tidy]=7 [matrix]=3)

# roomFor STAGE: whether a run that has to end (CALOT_CHECKS_END, seconds since 1970) has twice the stage's time left. Half
# the stages and an answer are better than all of them and none.
roomFor() {
  local left=$((${CALOT_CHECKS_END:-0} - $(date +%s)))
  [[ -z ${CALOT_CHECKS_END:-} ]] || ((left >= 120 * ${minutes[$1]:-0}))
}

leftOut=()
if [[ " ${stages[*]} " == *" fast "* ]]; then stages=(format lint changed); fi
for stage in "${stages[@]}"; do
  if ! roomFor "$stage"; then
    leftOut+=("$stage")
    continue
  fi
  case $stage in
    format)
      say "format"
      "$root/scripts/format.sh" --check
      ;;
    lint)
      say "lint"
      "$root/scripts/lint-determinism.sh"
      reuse --root "$root" lint >"$root/build/reuse.log" || {
        cat "$root/build/reuse.log" >&2
        exit 1
      }
      shellcheck --external-sources --source-path="$root/scripts" "$root"/scripts/*.sh "$root/.ci/run"
      ;;
    docs)
      "$root/scripts/docs.sh"
      ;;
    changed)
      say "structure"
      for test in "$root"/tests/structure/*_test.py; do "$python" -B "$test" "$root"; done
      mapfile -t programs < <("$python" -B "$root/scripts/changed.py" --tests)
      if [[ ${#programs[@]} -gt 0 ]]; then
        configure release "${whole[@]}" -DBUILD_TESTING=ON
        build release "${programs[@]}"
        say "test ${programs[*]}"
        ctest --test-dir "$root/build/release" --tests-regex "^($(IFS='|' && echo "${programs[*]#test_}"))\." --label-exclude heavy \
          --parallel "$((jobs + 1))" --output-on-failure --no-tests=error
      fi
      configure clang
      "$python" -B "$root/scripts/changed.py" | sed -n '/\.cpp$/p' | "$python" -B "$root/scripts/tidy.py" "$root/build/clang" --jobs "$jobs" --only
      ;;
    guard)
      configure release "${whole[@]}" -DBUILD_TESTING=ON
      build release calot calot-bench calot-matrix
      configure narrow
      build narrow calot-matrix
      "$python" -B "$root/scripts/guard.py" "$root"/build/release/bin/calot{,-bench,-matrix} "$root/build/narrow/bin/calot-matrix" \
        --root "$root" --jobs "$jobs"
      ;;
    clang)
      # Recordings of either compiler's program replay in the other's.
      configure release "${whole[@]}" -DBUILD_TESTING=ON
      build release calot
      configure clang "-DCALOT_OTHER=$root/build/release/bin/calot"
      build clang calot calot_modules calot-dashboard calot-trainer calot-matrix
      ctest --test-dir "$root/build/clang" --tests-regex '^command_line\.builds$' --output-on-failure --no-tests=error
      ;;
    asan-ubsan)
      export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1 UBSAN_OPTIONS=print_stacktrace=1
      fast asan-ubsan "$fastLabels" "${fastTests[@]}"
      ;;
    tsan)
      export TSAN_OPTIONS=second_deadlock_stack=1:halt_on_error=1
      fast tsan 'unit|recording' "${threadTests[@]}"
      ;;
    tidy)
      configure clang
      # What reads a file that changed since heavy.sh last found all clean. What draws and parses options takes as long as these rooms
      # together, of Qt's and the parser's headers: heavy.sh.
      say "clang-tidy"
      "$python" -B "$root/scripts/changed.py" --since "$(cat "$root/tests/tidy-clean.txt")" |
        "$python" -B "$root/scripts/tidy.py" "$root/build/clang" --jobs "$jobs" --rooms sim recorder analytics --only
      ;;
    matrix)
      configure release "${whole[@]}" -DBUILD_TESTING=ON
      build release calot calot-matrix
      trees=(--tree "$root/build/release")
      for tree in asan-ubsan tsan narrow; do
        configure "$tree"
        build "$tree" calot-matrix
        trees+=(--tree "$root/build/$tree")
      done
      "$root/scripts/matrix.sh" --short "${trees[@]}"
      ;;
    *)
      echo "checks: no stage $stage; there are: fast format lint docs guard clang asan-ubsan tsan tidy matrix" >&2
      exit 2
      ;;
  esac
done
if [[ ${#leftOut[@]} -gt 0 ]]; then
  say "FAILED: ${leftOut[*]} NOT RUN for want of time; the others of ${stages[*]} passed" >&2
  exit 1
fi
say "passed: ${stages[*]}"
