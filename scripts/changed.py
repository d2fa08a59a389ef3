#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Changed C++ files, since the branch left origin/main (or the commit before) and uncommitted; or with --tests, the test programs of their folders.

A test program of tests/CMakeLists.txt tests the folders of the same names in the modules.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def git(*words):
    return subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=False).stdout.split()


def changed():
    base = git("merge-base", "HEAD", "origin/main")[:1]
    if not base or base == git("rev-parse", "HEAD"):
        base = ["HEAD~1"]
    files = set(git("diff", "--name-only", "--diff-filter=d", base[0])) | set(git("ls-files", "--others", "--exclude-standard"))
    return sorted(f for f in files if f.endswith((".h", ".cpp")))


def programs(files):
    folders = {}
    for name, listed in re.findall(r'^calot_tests\((\w+) \w+ "?([\w/;]+)"?', (ROOT / "tests/CMakeLists.txt").read_text(), re.M):
        for folder in listed.split(";"):
            folders.setdefault(folder, name)
    found = set()
    for file in files:
        path = pathlib.PurePosixPath(file.removeprefix("tests/")).parent
        while str(path) != ".":
            if str(path) in folders:
                found.add(folders[str(path)])
                break
            path = path.parent
    return sorted(found)


if __name__ == "__main__":
    names = changed()
    print("\n".join(programs(names) if sys.argv[1:] == ["--tests"] else names))
