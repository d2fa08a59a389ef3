#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regrades a cohort of many short recordings on one machine and in shares, compares both cohorts row by row, and prices the shares: their
processor time and that of merging them, beside mere re-simulation (calot replay) of the same recordings.

usage: shares.py COUNT [--folder F] [--calot PROGRAM] [--each N] [--jobs N]

Makes the recordings itself (attempts.py); those that are there stay. Exit code 1: a row differs, or the overhead is above 10 %.
"""
import argparse
import concurrent.futures
import math
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests/command_line"))
from cohort_content import content, edited  # noqa: E402

MAX_OVERHEAD = 0.10


class Cost:
    """Wall and processor time of the programs that run within it."""

    def __init__(self, name):
        self.name = name

    def __enter__(self):
        self.begin = time.monotonic(), self.used()
        return self

    @staticmethod
    def used():
        u = resource.getrusage(resource.RUSAGE_CHILDREN)
        return u.ru_utime + u.ru_stime

    def __exit__(self, *_):
        self.wall, self.processor = time.monotonic() - self.begin[0], self.used() - self.begin[1]
        print(f"{self.name}: {self.wall:.1f} s, {self.processor:.1f} s of processor time", flush=True)


def well(*command):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"shares: {command[1]}: exit {done.returncode}")
    return done.stdout


def in_shares(o, cohort, shares, *options):
    """Assesses all shares, as many at a time as there are processors, and merges them. @return processor time, the last line of the report"""
    folder = o.folder / "shares"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    databases = [folder / f"{n}.db" for n in range(1, shares + 1)]

    def share(number):
        well(o.calot, "assess", o.folder / "recordings", "--cohort", databases[number - 1], "--share", f"{number}/{shares}")

    with Cost(f"{shares} shares") as computing:
        with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
            list(pool.map(share, range(1, shares + 1)))
    with Cost("merging them") as merging:
        report = well(o.calot, "cohort", "merge", cohort, *databases, *options)
    return computing.processor + merging.processor, report.splitlines()[-1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "build/shares")
    parser.add_argument("--calot", type=pathlib.Path, default=ROOT / "build/release/bin/calot")
    parser.add_argument("--each", type=int, default=500, help="recordings in a share (500)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    o = parser.parse_args()
    o.folder.mkdir(parents=True, exist_ok=True)
    cohort, alone = o.folder / "cohort.db", o.folder / "alone.db"
    for path in o.folder.glob("*.db*"):
        path.unlink()
    with Cost("recording"):
        well(sys.executable, ROOT / "scripts/attempts.py", o.folder / "recordings", "--count", o.count, "--calot", o.calot, "--jobs", o.jobs)
    shares = math.ceil(o.count / o.each)
    in_shares(o, cohort, shares)
    with edited(cohort) as database:
        database.execute("UPDATE checkpoint_value SET version = 0, value = value * 2 WHERE name = 'path-length' AND attempt % 10 = 0")
    shutil.copyfile(cohort, alone)
    recordings = sorted((o.folder / "recordings").rglob("*.h5"))
    if len(recordings) != o.count:
        sys.exit(f"shares: {o.folder / 'recordings'} holds {len(recordings)} recordings, not {o.count}")
    with Cost("re-simulation alone") as replay:
        well(o.calot, "replay", *recordings, "--jobs", o.jobs)
    priced, report = in_shares(o, cohort, shares, "--newer")
    with Cost("regrade on one machine"):
        here = well(o.calot, "regrade", alone, o.folder / "recordings", "--jobs", o.jobs).splitlines()[-1]
    same = content(cohort) == content(alone) and report == here
    overhead = priced / replay.processor - 1.0
    print(report)
    print(f"{o.count} recordings in {shares} shares: overhead {100 * overhead:.1f} % of re-simulation; rows are {'the same' if same else 'NOT the same'}")
    return 0 if same and overhead <= MAX_OVERHEAD else 1


if __name__ == "__main__":
    sys.exit(main())
