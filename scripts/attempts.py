#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes many short recordings, each of a performer of its own seed: what cohorts of thousands of attempts are tried with.

usage: attempts.py FOLDER --count N [--seconds T] [--scene S] [--calot PROGRAM] [--jobs N]

Recordings that are there stay, so that a run that was cut short is taken up.
"""
import argparse
import concurrent.futures
import os
import pathlib
import subprocess
import sys

PROFILES = ("skilled", "intermediate", "unskilled")
PARTICIPANTS = 200


def record(o, number):
    """The attempt of a number: the same operator, seed and length whenever it is made."""
    target = o.folder / f"{number // 1000:03d}" / f"{number:06d}.h5"
    if target.exists():
        return None
    target.parent.mkdir(parents=True, exist_ok=True)
    # Lengths differ, as those of people do.
    seconds = o.seconds * (0.6 + 0.1 * (number * 7 % 9))
    done = subprocess.run([o.calot, "record", "--scene", o.scene, "--performer", PROFILES[number % len(PROFILES)], "--seed", str(number + 1),
                           "--seconds", f"{seconds:.3f}", "--mode", "assessment", "--purpose", "study", "--participant",
                           f"P{number * 31 % PARTICIPANTS:03d}", "-o", target], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                          check=False)
    return done.stderr.strip() if done.returncode else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--count", type=int, required=True)
    parser.add_argument("--seconds", type=float, default=0.5, help="of an attempt, on average (0.5)")
    parser.add_argument("--scene", default="touch-liver")
    parser.add_argument("--calot", default=os.environ.get("CALOT_PROGRAM", "calot"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    o = parser.parse_args()
    faults = 0
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        for fault in pool.map(lambda number: record(o, number), range(o.count)):
            if fault:
                print(fault, file=sys.stderr)
                faults += 1
    print(f"attempts: {o.count - faults} of {o.count} recordings in {o.folder}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
