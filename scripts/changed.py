#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""changed.py [--tests | --since COMMIT]: changed C++ files, since the branch left origin/main (or the commit before) and uncommitted.

With --tests, the test programs of their folders instead; with --since, what changed since that commit, all files where a clone lacks it.
A test program of tests/CMakeLists.txt tests the folders of the same names in the modules.
"""
import argparse
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent


def git(*words):
    return subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=False).stdout.split()


def changed(since=None):
    base = git("merge-base", "HEAD", "origin/main" if since is None else since)[:1]
    if since is not None:
        base = base or git("hash-object", "-t", "tree", "/dev/null")
    elif not base or base == git("rev-parse", "HEAD"):
        base = ["HEAD~1"]
    files = set(git("diff", "--name-only", "--diff-filter=d", base[0])) | set(git("ls-files", "--others", "--exclude-standard"))
    if ".clang-tidy" in files:
        files |= set(git("ls-files"))
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
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tests", action="store_true")
    parser.add_argument("--since", metavar="COMMIT")
    arguments = parser.parse_args()
    names = changed(arguments.since)
    print("\n".join(programs(names) if arguments.tests else names))
