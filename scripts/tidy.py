#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""clang-tidy over the project's sources, several at a time, by the checks of .clang-tidy.

What a build compiles together is looked at together. It is looked at again only when one of its sources, a header or
.clang-tidy changed since it was last found clean.
"""
import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# The commit at which sim, recorder and analytics, which CI looks at, were last found clean; none: all are looked at.
CLEAN = ROOT / "tests/tidy-clean.txt"
ROOMS = ("sim", "recorder", "analytics", "gui", "apps", "python")


def headers_digest():
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    for room in ROOMS:
        for header in sorted((ROOT / room).rglob("*.h")):
            digest.update(header.read_bytes())
    return digest


def reads(file, seen):
    """The project's files that a source reads, itself among them."""
    if file not in seen:
        seen.add(file)
        for name in re.findall(r'^#include "([^"]+)"', file.read_text(), re.M):
            if (ROOT / name).exists():
                reads(ROOT / name, seen)
    return seen


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path, help="a configured build tree (compile_commands.json)")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--rooms", nargs="+", choices=ROOMS, default=ROOMS, help="default: all")
    parser.add_argument("--only", action="store_true", help="only what reads one of the files that standard input names")
    parser.add_argument("--note", action="store_true", help="where all is clean, write the commit to tests/tidy-clean.txt")
    arguments = parser.parse_args()
    wanted = {line.strip() for line in sys.stdin} if arguments.only else None

    commands = json.loads((arguments.build / "compile_commands.json").read_text())
    build = arguments.build.resolve()
    # Sources compiled together are a file of the build tree, in a folder named like the room, that includes them.
    files = []
    for file in sorted({pathlib.Path(c["file"]) for c in commands}):
        base = build if file.is_relative_to(build) else ROOT
        if file.is_relative_to(base) and file.relative_to(base).parts[0] in arguments.rooms:
            files.append(file)
    if wanted is not None:
        files = [f for f in files if wanted & {str(read.relative_to(ROOT)) for read in reads(f, set())}]
    cache = arguments.build / "tidy"
    cache.mkdir(exist_ok=True)
    common = headers_digest()

    def check(file):
        digest = common.copy()
        text = file.read_text()
        digest.update(text.encode())
        for source in re.findall(r'^#include "(/.*\.cpp)"', text, re.MULTILINE):
            digest.update(pathlib.Path(source).read_bytes())
        mark = cache / (re.sub(r"\W", "_", str(file.relative_to(ROOT))) + ".clean")
        if mark.exists() and mark.read_text() == digest.hexdigest():
            return file, ""
        run = subprocess.run(["clang-tidy", "--quiet", f"-p={arguments.build}", str(file)], capture_output=True, text=True)
        if run.returncode == 0 and "warning:" not in run.stdout:
            mark.write_text(digest.hexdigest())
            return file, ""
        return file, run.stdout or run.stderr

    bad = 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for file, complaint in pool.map(check, files):
            if complaint:
                bad += 1
                print(f"--- {file.relative_to(ROOT)}\n{complaint}", flush=True)
    print(f"clang-tidy: {len(files)} sources, {bad} with complaints")
    if arguments.note and not bad:
        CLEAN.write_text(subprocess.run(["git", "-C", ROOT, "rev-parse", "HEAD"], capture_output=True, text=True, check=True).stdout)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
