#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the command line out of the libraries: no exit codes and no flags there; and no cast to reach a device.

usage: errors_test.py ROOT | --self-test
"""
import pathlib
import re
import sys

import cpp_text

LIBRARIES = ("sim", "recorder", "analytics", "gui")
SOURCES = {".h", ".cpp"}
FLAG = re.compile(r"(?<![-!\w])--[a-z][\w-]*")
EXIT_CODE = re.compile(r"\bExitCode\b")
DEVICE_CAST = re.compile(r"\bdynamic_(?:pointer_)?cast\s*<[^<>]*\b\w*Device(?:Source)?\b[^<>]*>")


def faults_of(path, text):
    """(line number, message) of each fault of one file."""
    code = cpp_text.code_only(text)
    if pathlib.PurePosixPath(path).parts[0] in LIBRARIES:
        for match in EXIT_CODE.finditer(code):
            yield text.count("\n", 0, match.start()) + 1, "an exit code: a library says ErrorKind, the program answers"
        for start, literal in cpp_text.strings(text):
            for match in FLAG.finditer(literal):
                yield text.count("\n", 0, start + match.start()) + 1, f"{match.group()}: a library names a Remedy, the program its flag"
    for match in DEVICE_CAST.finditer(code):
        yield text.count("\n", 0, match.start()) + 1, f"{match.group()}: ask SampleSource::device()"


def check(root):
    files = [path for path in cpp_text.files(root) if path.suffix in SOURCES]
    faults = [f"{path}:{number}: {message}" for path in files
              for number, message in faults_of(path.as_posix(), (root / path).read_text(encoding="utf-8"))]
    for fault in faults:
        print(fault)
    print(f"errors: {len(files)} files, {len(faults)} faults")
    return 1 if faults else 0


WRONG = (
    ("recorder/a.cpp", 'throw Error(kind, "exists; --force replaces it");', 1),
    ("analytics/a/a.cpp", 'f("a "\n  "--mix-keys does");', 2),
    ("gui/a/a.cpp", 'const char* t = R"(see\n --at SECONDS)";', 2),
    ("gui/a/a.cpp", 'start(program, {"assess", "--json"});', 1),
    ("sim/a/a.h", "ExitCode code;", 1),
    ("recorder/a.h", "\nenum class ExitCode : int {};", 2),
    ("apps/a/a.cpp", "auto* d = dynamic_cast<recorder::DeviceSource*>(&s);", 1),
    ("tests/gui/a.cpp", "dynamic_cast<const DeviceSource&>(s)", 1),
    ("gui/a/a.cpp", "std::dynamic_pointer_cast<MouseDevice>(s)", 1),
)
RIGHT = (
    ("apps/a/a.cpp", 'app.add_flag("--force", f); return static_cast<int>(ExitCode::yes);'),
    ("recorder/a.cpp", "// the program says --force\n--count; f(i--);"),
    ("recorder/a.cpp", 'f("SELECT 1 -- why", "a--b", "<!--note-->", "---");'),
    ("gui/a/a.cpp", "/* ExitCode */ exitCode = 3;"),
    ("tests/gui/a.cpp", "dynamic_cast<const CheckpointTableModel&>(*m); dynamic_cast<Error*>(e);"),
)


def self_test():
    bad = [case for case in WRONG if [number for number, _ in faults_of(case[0], case[1])] != [case[2]]]
    bad += [case for case in RIGHT if list(faults_of(*case))]
    for case in bad:
        print("misjudged:", case)
    print(f"errors: {len(WRONG)} wrong files refused, {len(RIGHT)} right files passed" if not bad else "errors: self-test failed")
    return 1 if bad else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(self_test() if sys.argv[1] == "--self-test" else check(pathlib.Path(sys.argv[1])))
