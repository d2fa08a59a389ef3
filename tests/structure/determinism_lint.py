#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Refuses names that the determinism contract forbids (docs/explanation/determinism.md), in every folder that obeys it.

usage: determinism_lint.py ROOT | --self-test
"""
import pathlib
import re
import sys
import tempfile

import cpp_text

FOLDERS = ("sim", "recorder/sources", "analytics/checkpoints")
# A device is an input: its drivers live by the clock and by threads, and what they give is logged. How a sample is laid
# into the scene is ours again.
INPUT = "recorder/sources/devices"
INPUT_CHECKED = "device_mapping"
# The one place that may change how a source is compiled: it takes a pass away that breaks the contract.
STRICTER = "sim/math/no_fused_pairs.h"

_LIBM = ("a?(?:sin|cos|tan)h?f?l? atan2[fl]? pow[fl]? exp[fl]? exp2[fl]? expm1[fl]? log[fl]? log2[fl]? log10[fl]? log1p[fl]? "
         "cbrt[fl]? hypot[fl]? fma[fl]? fmod[fl]? remainder[fl]? erfc?[fl]? [tl]gamma[fl]? lerp sincos "
         "n?rint nearbyint lrint llrint").replace(" ", "|")

# (name, pattern, why, what must be refused, what must pass)
RULES = (
    ("libm", rf"(?<![\w])(?:{_LIBM})\s*\(", "libm differs between systems; use sim/math/elementary.h",
     ("y = std::sin(x);", "y = std::pow (x, 2);", "a.array().exp();", "r = std::hypot(a, b);", "s = fma(a, b, c);", "using std::atan2(y, x)"),
     ("y = calot::sine(x);", "y = std::sqrt(x);", "basin(x);", "std::floor(x); std::abs(x); // std::sin(x)", 'f("std::sin(x)");',
      "logarithm(x); exponential(x);")),
    ("libm name", rf"\bstd\s*::\s*(?:{_LIBM})\b(?!\s*\()", "libm differs between systems; use sim/math/elementary.h",
     ("auto f = std::cos;", "using std::exp;"), ("std::costly;", "std::min(a, b);")),
    ("Eigen's trigonometry",
     r"\b(?:AngleAxis[df]?|Rotation2D[df]?|slerp|eulerAngles|angularDistance|computeDirect|hypotNorm|stableNorm|blueNorm)\b",
     "Eigen calls libm here, or an order of its own; use sim/math",
     ("Eigen::AngleAxisd(a, v)", "q.slerp(t, p)", "v.stableNorm()"), ("v.norm()", "mySlerper(q)")),
    ("Eigen's random numbers", r"\bsetRandom\b|::\s*Random\s*\(\s*\)|\bUnitRandom\b", "use sim/math/random.h",
     ("v.setRandom();", "Vec3::Random()"), ("Random random(1);",)),
    ("either zero",
     r"\bstd\s*::\s*max(?:<double>)?\s*\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*,\s*0\.0F?\s*\)|\bstd\s*::\s*min(?:<double>)?\s*\(\s*0\.0F?\s*,|"
     r"\bstd\s*::\s*clamp(?:<double>)?\s*\((?:[^(),]|\((?:[^()]|\([^()]*\))*\))*,\s*0\.0F?\s*,|<\s*0\.0F?\s*\?\s*0\.0F?\s*:|"
     r"\bcwiseM(?:ax|in)\s*\(\s*(?:\w+::Zero|0\.0)|<\s*0\.0F?\s*\?\s*\w+\{\}\s*:|\.max\(0\.0\)",
     "clang loses which zero it is on some machines; use sim/math/linear.h",
     ("a = std::max(x, 0.0);", "b = std::max(f(x, g(y)) - z, 0.0);", "c = std::min(0.0, x);", "d = std::clamp(x, 0.0, 1.0);",
      "e = u < 0.0 ? 0.0 : u;", "v.cwiseMax(Vec3::Zero())", "d = d < 0.0F ? Floats{} : d;", "a.array().max(0.0)"),
     ("a = std::max(0.0, x);", "b = std::min(x, 0.0);", "c = std::max(x, 10.0);", "d = std::clamp(x, 1.0, 2.0);", "e = x > 0.0 ? x : 0.0;",
      "f(std::max(x, y), 0.0);")),
    ("standard random numbers",
     r"\brandom_device\b|\bmt19937\w*|\bdefault_random_engine\b|\bminstd_rand0?\b|\b\w+_distribution\b|<random>",
     "distributions differ between libraries; use sim/math/random.h",
     ("std::mt19937_64 g;", "std::random_device d;", "std::normal_distribution<> n;", "#include <random>"), ("Random r;",)),
    ("C random numbers", r"(?<!\w)s?rand\s*\(|\bdrand48\b", "use sim/math/random.h", ("int i = rand();", "srand (1);"),
     ("operand(1);", "brand();")),
    ("clock", r"\bchrono\b|<ctime>|(?<![\w.>])(?:std::)?(?:time\s*\(\s*(?:nullptr|NULL|0|&)|clock\s*\(\s*\)|gettimeofday|clock_gettime)",
     "time is an input, never read here",
     ("std::chrono::steady_clock::now();", "auto t = time(nullptr);", "clock();"), ("result.time(3);", "double time(int tick);", "double runtime(int);")),
    ("thread", r"\bstd\s*::\s*(?:thread|jthread|async|mutex|condition_variable|future|promise)\b|<(?:thread|mutex|future)>|\bthread_local\b",
     "work goes through the Executor", ("std::thread t(f);", "#include <mutex>", "thread_local int x;"), ("threads = 2;",)),
    ("atomic float", r"\batomic(?:_ref)?\s*<\s*(?:std::\s*)?(?:float|double)\b", "an atomic sum has no fixed order",
     ("std::atomic<double> sum;", "std::atomic_ref< float > s(x);"), ("std::atomic<int> n;",)),
    ("free order", r"\bstd\s*::\s*(?:transform_)?reduce\b|\bexecution\s*::|<execution>|#\s*pragma\s+omp\b",
     "reductions have an order that the source fixes",
     ("std::reduce(a, b);", "std::for_each(std::execution::par, a, b, f);", "#pragma omp parallel for"),
     ("std::accumulate(a, b, 0.0);", "reduce(x);")),
    ("hash order", r"\bunordered_\w+|\bstd\s*::\s*hash\b", "iteration order is the library's; use sorted containers",
     ("std::unordered_map<int, int> m;", "std::hash<int>{}(1);"), ("std::map<int, int> m;",)),
    ("address", r"\bu?intptr_t\b", "addresses differ from run to run", ("auto k = std::uintptr_t(p);",), ("ptr = p;",)),
    ("environment", r"\bgetenv\b|\bsetlocale\b|\bstd\s*::\s*locale\b", "results may not depend on the environment",
     ('getenv("X");', "std::locale l;"), ("environment(x);",)),
    ("extended precision", r"\blong\s+double\b|\b__float(?:80|128)\b", "its width is the machine's",
     ("long double x;", "__float128 y;"), ("double x; long y;",)),
    ("relaxed arithmetic", r"ffast-math|\bFP_CONTRACT\b|__attribute__\s*\(\(\s*optimize|\[\[\s*gnu::optimize|#\s*pragma\s+(?:GCC|clang)\s+(?:optimize|fp)\b",
     "flags of the contract hold for the whole tree",
     ("#pragma STDC FP_CONTRACT ON", "#pragma GCC optimize (\"O3\")", "__attribute__((optimize(\"O3\")))"), ("#pragma once",)),
)
_COMPILED = [(name, re.compile(pattern), why) for name, pattern, why, _, _ in RULES]


def look(text):
    """(line number, rule's name, why) of every forbidden name in C++ text."""
    for number, line in enumerate(cpp_text.code_only(text).splitlines(), 1):
        for name, pattern, why in _COMPILED:
            if pattern.search(line):
                yield number, name, why


def lint(root, report=print):
    """Reports every fault below root; returns (files seen, faults)."""
    seen = faults = 0
    checked = False
    for path in cpp_text.files(root):
        if path.suffix not in (".h", ".cpp") or not any(path.is_relative_to(f) for f in FOLDERS):
            continue
        if path.is_relative_to(INPUT) and path.stem != INPUT_CHECKED:
            continue
        checked = checked or path.is_relative_to(INPUT)
        seen += 1
        for number, name, why in look((root / path).read_text(encoding="utf-8")):
            if path.as_posix() == STRICTER and name == "relaxed arithmetic":
                continue
            faults += 1
            report(f"{path}:{number}: forbidden ({name}): {why}")
    if not checked:
        faults += 1
        report(f"{INPUT}: no file {INPUT_CHECKED}: name the one that maps a device's samples into the scene")
    return seen, faults


def self_test():
    for name, _, _, refused, allowed in RULES:
        for text in refused:
            assert name in {n for _, n, _ in look(text)}, f"rule '{name}' lets pass: {text}"
        for text in allowed:
            assert not list(look(text)), f"refused without need ({list(look(text))}): {text}"
    kept = 'a /* std::sin(x)\n std::cos(x) */ b; // std::exp(x)\nc("std::log(x)"); d(R"(rand())"); e = 1\'000; f = std::tan(x);'
    assert [n for n, _, _ in look(kept)] == [3], list(look(kept))
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for folder in (*FOLDERS, "gui"):
            (root / folder / "deep").mkdir(parents=True)
            (root / folder / "deep" / "bad.cpp").write_text("double f(double x) { return std::sin(x); }\n")
        (root / INPUT).mkdir()
        for file in ("tcp.cpp", f"{INPUT_CHECKED}.cpp"):
            (root / INPUT / file).write_text("double f(double x) { return std::sin(x); }\n")
        seen, faults = lint(root, report=lambda line: None)
        assert seen == len(FOLDERS) + 1 and faults == len(FOLDERS) + 1, (seen, faults)
    print(f"determinism lint: {len(RULES)} rules refuse what they must and pass what they may")


def main():
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return 0
    root = pathlib.Path(sys.argv[1])
    seen, faults = lint(root)
    print(f"determinism lint: {seen} files, {faults} faults")
    return 1 if faults or seen == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
