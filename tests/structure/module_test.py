#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps engines and the page buildable for WebAssembly, without its compiler: what their sources read through all includes.

A module has no files and no threads, so that no header of those may be read. An engine is linked of the sources that
apps/calot-engine/sources.txt lists: a header that is read, and whose source is not among them, will be missed there.

usage: module_test.py ROOT | --self-test
"""
import pathlib
import sys
import tempfile

import cpp_text

ABSENT = {"condition_variable", "filesystem", "fstream", "future", "mutex", "thread"}


def read_by(root, sources):
    """What these sources read: files of the tree, and pairs (file, header of another)."""
    seen, waiting, foreign = set(sources), list(sources), []
    while waiting:
        file = waiting.pop()
        for _, name, quoted in cpp_text.includes(file.read_text()):
            if not quoted:
                foreign.append((file, name))
            elif (root / name).is_file() and root / name not in seen:
                seen.add(root / name)
                waiting.append(root / name)
    return seen, foreign


def faults_of(root, what, sources, linked_alone):
    seen, foreign = read_by(root, sources)
    for file, name in sorted(foreign):
        if name in ABSENT:
            yield f"{file.relative_to(root)}: {what} reads <{name}>, which WebAssembly has not"
    for header in sorted(seen) if linked_alone else ():
        source = header.with_suffix(".cpp")
        if header.suffix == ".h" and source.is_file() and source not in sources:
            yield f"{header.relative_to(root)}: {what} reads it without its source (apps/calot-engine/sources.txt)"


def check(root):
    sys.path.insert(0, str(root / "scripts"))
    import engine  # pylint: disable=import-outside-toplevel
    import page  # pylint: disable=import-outside-toplevel
    parts = [(f"the {kind} engine", engine.source_patterns(root, kind), True) for kind in ("module", "native")]
    parts += [(f"the page's {name}", patterns, False) for name, patterns in page.MODULES.items()]
    seen, faults = 0, []
    for what, patterns, linked_alone in parts:
        sources = engine.matching(root, patterns)
        seen += len(sources)
        faults += faults_of(root, what, sources, linked_alone)
    return seen, sorted(set(faults))


def self_test():
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        (root / "a").mkdir()
        (root / "a/scene.cpp").write_text('#include "a/scene.h"\n#include <vector>\n')
        (root / "a/scene.h").write_text('#include "a/file.h"\n// #include <thread>\n')
        (root / "a/file.h").write_text("#include <filesystem>\n")
        (root / "a/file.cpp").write_text("")
        scene = [root / "a/scene.cpp"]
        assert len(list(faults_of(root, "x", scene, True))) == 2
        assert len(list(faults_of(root, "x", scene, False))) == 1
        (root / "a/file.h").write_text("")
        assert not list(faults_of(root, "x", [*scene, root / "a/file.cpp"], True))
    print("module: missing sources and absent headers are found")


def main():
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return 0
    seen, faults = check(pathlib.Path(sys.argv[1]).resolve())
    print("\n".join([*faults, f"module: {seen} sources, {len(faults)} faults"]))
    return 1 if faults or seen == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
