#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the files in order: licence line, length, place of tests, no unfinished marks, no paths of one machine, links that lead somewhere.

usage: house_test.py ROOT | --self-test
"""
import pathlib
import re
import sys
import tempfile

import cpp_text

LONGEST = 600
MIRRORED = ("sim", "recorder", "analytics", "gui", "apps")  # tests/ has the folders of these
SOURCES = {".h", ".cpp", ".py", ".sh", ".cmake", ".sql"}
TEXTS = SOURCES | {".md", ".txt", ".json", ".yml", ".yaml"}
# Put together from parts, or this file would find itself.
UNFINISHED = re.compile(r"\b(?:" + "|".join(("TO" + "DO", "FIX" + "ME", "XX" + "X", "HA" + "CK")) + r")\b")
MACHINE_PATH = re.compile(r"(?<![\w.~$}<])/(?:" + "|".join(("wo" + "rk", "ho" + "me", "ro" + "ot", "tm" + "p", "Us" + "ers")) + r")/")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


def is_source(path):
    return path.suffix in SOURCES or path.name in ("CMakeLists.txt", "run")


def misplaced(root, path):
    """What is wrong with the place of a test program's source, or None."""
    if not path.name.endswith(("_test.cpp", "_test.h")):
        return None
    if path.parts[0] != "tests":
        return "named like a test, which stands in tests/"
    if len(path.parts) > 2 and path.parts[1] in MIRRORED and not (root / pathlib.Path(*path.parts[1:-1])).is_dir():
        return f"tests/ mirrors the modules, and there is no {pathlib.Path(*path.parts[1:-1])}"
    return None


def faults_of(root, path):
    """(line number, message) of each fault of one file."""
    if not is_source(path) and path.suffix not in TEXTS:
        return
    text = (root / path).read_text(encoding="utf-8")
    lines = text.splitlines()
    if (fault := misplaced(root, path)) is not None:
        yield 1, fault
    if is_source(path):
        if not any("SPDX-License-" "Identifier: GPL-3.0-or-later" in line for line in lines[:3]):
            yield 1, "no line SPDX-License-" "Identifier: GPL-3.0-or-later at its head"
        if len(lines) > LONGEST:
            yield LONGEST, f"{len(lines)} lines: one concern a file, {LONGEST} lines at most"
    for number, line in enumerate(lines, 1):
        if UNFINISHED.search(line):
            yield number, "marked unfinished"
        if MACHINE_PATH.search(line):
            yield number, "names a path of one machine"
    if path.suffix == ".md":
        for link in LINK.finditer(text):  # its words may stand on two lines
            target = link[1]
            if not re.match(r"[a-z]+:|#", target) and not (root / path.parent / target.split("#")[0]).exists():
                yield text.count("\n", 0, link.start(1)) + 1, f"link leads nowhere: {target}"


def check(root):
    seen = faults = 0
    for path in cpp_text.files(root):
        seen += 1
        for number, message in faults_of(root, path):
            faults += 1
            print(f"{path}:{number}: {message}")
    return seen, faults


def self_test():
    head = "// SPDX-License-" "Identifier: GPL-3.0-or-later\n"
    cases = (
        ("a.cpp", head + "int x;\n", 0), ("b.cpp", "int x;\n", 1), ("c.h", head + "\n" * LONGEST, 1),
        ("d.cpp", head + "// TO" + "DO later\n", 1), ("e.md", "see /wo" + "rk/x\n", 1), ("f.md", "[a](missing.md) [b\nc](missing.cpp) [b](a.cpp)\n", 2),
        ("g.py", "#!/usr/bin/env python3\n# SPDX-License-" "Identifier: GPL-3.0-or-later\n", 0),
        ("rank_test.cpp", head, 1), ("sim/math/a.cpp", head, 0), ("tests/sim/math/a_test.cpp", head, 0), ("tests/sim/core/a_test.cpp", head, 1),
        ("tests/accuracy/a_test.cpp", head, 0),
        ("h.md", "[site](https://example.org) [here](#words) `build/tests/work/`\n", 0),
    )
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for file, text, _ in cases:
            (root / file).parent.mkdir(parents=True, exist_ok=True)
            (root / file).write_text(text)
        for file, _, expected in cases:
            found = list(faults_of(root, pathlib.Path(file)))
            assert len(found) == expected, (file, found)
    print(f"house: {len(cases)} cases judged as they must be")


def main():
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return 0
    seen, faults = check(pathlib.Path(sys.argv[1]))
    print(f"house: {seen} files, {faults} faults")
    return 1 if faults or seen == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
