#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every line of tests/sanitizers.txt names a test that there is, and a sanitizer that there is.

usage: sanitizers_test.py ROOT | --self-test
"""
import fnmatch
import pathlib
import re
import sys
import tempfile

TEST = re.compile(r"^(TEST|TEST_F|TEST_P|TYPED_TEST)\((\w+),\s*(\w+)\)", re.M)
INSTANCE = re.compile(r"INSTANTIATE_TEST_SUITE_P\(\s*(\w+),\s*(\w+)")


def names_of(root):
    """SUITE.TEST of every test, and PREFIX/SUITE.TEST of those with parameters."""
    tests, instances = [], []
    for path in sorted((root / "tests").rglob("*_test.cpp")):
        text = path.read_text(encoding="utf-8")
        tests += TEST.findall(text)
        instances += INSTANCE.findall(text)
    for kind, suite, test in tests:
        yield f"{suite}.{test}"
        if kind == "TEST_P":
            for prefix, of in instances:
                if of == suite:
                    yield f"{prefix}/{suite}.{test}"


def check(root):
    """Number of lines, of tests, and the faults."""
    names, faults = list(names_of(root)), []
    lines = [line for line in (root / "tests/sanitizers.txt").read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    for line in lines:
        pattern, *sanitizers = line.split()
        if not sanitizers or not set(sanitizers) <= {"address", "thread"}:
            faults.append(f"{line}: a pattern, then address, thread or both")
        elif not any(fnmatch.fnmatchcase(name, pattern) for name in names):
            faults.append(f"{pattern}: there is no such test")
    return len(lines), len(names), faults


def self_test():
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        (root / "tests").mkdir()
        (root / "tests/a_test.cpp").write_text("TEST(Loop, Ends) {}\nTEST_P(Jaws, Hold) {}\nINSTANTIATE_TEST_SUITE_P(Meshes, Jaws, 1);\n")
        for line, count in (("Loop.* address", 0), ("Loop.E* address thread", 0), ("Meshes/Jaws.* thread", 0), ("Loop.Stops* address", 1),
                            ("Gone.* thread", 1), ("Loop.*", 1), ("Loop.* memory", 1)):
            (root / "tests/sanitizers.txt").write_text(line + "\n")
            assert len(check(root)[2]) == count, line
    print("sanitizers: 4 wrong lines refused, 3 right ones passed")


def main():
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return 0
    lines, tests, faults = check(pathlib.Path(sys.argv[1]))
    for fault in faults:
        print(f"tests/sanitizers.txt: {fault}")
    print(f"sanitizers: {lines} lines, {tests} tests, {len(faults)} faults")
    return 1 if faults or not lines or not tests else 0


if __name__ == "__main__":
    sys.exit(main())
