#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regrades a cohort, or assesses folders, as an array of Slurm jobs: each assesses a share of the recordings into a database of its own,
then one job merges them into the cohort and reports.

Run it again after jobs were killed or nodes failed: complete shares stay, one that was cut short goes on where it was. The folder has to be
on a file system that all nodes see. docs/how-to/cluster.md describes all of it.

  submit.py regrade --cohort C.db --folder RUN RECORDINGS...     --shares N, or as many as --bundle gives
  submit.py assess  --cohort C.db --folder RUN RECORDINGS...
  submit.py progress --folder RUN
"""
import argparse
import contextlib
import math
import os
import pathlib
import shlex
import sqlite3
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent


def run(*command):
    """What a command prints; its own message and exit code where it fails."""
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.returncode)
    return done.stdout


def hdf5_files(places):
    """Recordings among files and in folders and below."""
    for place in map(pathlib.Path, places):
        for path in sorted(place.rglob("*")) if place.is_dir() else [place]:
            if path.is_file():
                with open(path, "rb") as file:
                    if file.read(8) == b"\x89HDF\r\n\x1a\n":
                        yield path


def recorded_seconds(cohort):
    with contextlib.closing(sqlite3.connect(f"file:{cohort}?mode=ro", uri=True)) as database:
        return database.execute("SELECT coalesce(sum(steps * step_seconds), 0) FROM recording").fetchone()[0]


def max_array_size():
    """Slurm's own limit: indices are below it."""
    for line in run("scontrol", "show", "config").splitlines():
        name, _, value = line.partition("=")
        if name.strip() == "MaxArraySize":
            return int(value)
    return 1001


def share_count(o, places):
    """So many that a share is worth a job, and no more than an array holds."""
    limit = max(1, max_array_size() - 1)
    if o.shares > limit:
        sys.exit(f"submit: --shares {o.shares}: an array of this cluster holds {limit} jobs (MaxArraySize)")
    if o.shares:
        return o.shares
    count = sum(1 for _ in hdf5_files(places))
    if count == 0:
        sys.exit(f"submit: there are no recordings in {' '.join(places)}")
    wanted = recorded_seconds(o.cohort) / o.bundle if o.work == "regrade" else count / o.each
    return max(1, min(limit, count, math.ceil(wanted)))


def ranges(numbers):
    """1,2,3,7 as Slurm writes it: 1-3,7."""
    text, numbers = [], sorted(numbers)
    while numbers:
        end = 0
        while end + 1 < len(numbers) and numbers[end + 1] == numbers[end] + 1:
            end += 1
        text.append(str(numbers[0]) if end == 0 else f"{numbers[0]}-{numbers[end]}")
        numbers = numbers[end + 1:]
    return ",".join(text)


def make_plan(o):
    """RUN/plan.sh, which the jobs read; one that is there stays: its shares are in it."""
    plan = o.folder / "plan.sh"
    places = [str(pathlib.Path(p).resolve()) for p in o.recordings]
    cohort = pathlib.Path(o.cohort).resolve()
    if o.work == "regrade":
        places = places or [str(cohort.parent)]
    lines = [f"work={o.work}", f"cohort={shlex.quote(str(cohort))}", "input=(" + " ".join(map(shlex.quote, places)) + ")"]
    if plan.exists():
        if not set(lines) <= set(plan.read_text(encoding="utf-8").splitlines()):
            sys.exit(f"submit: {o.folder} holds a run of another cohort or other recordings; name another --folder")
        print(f"submit: going on with {plan}")
        return
    for name in ("shares", "log"):
        (o.folder / name).mkdir(parents=True, exist_ok=True)
    lines += [f"shares={share_count(o, places)}", f"calot={shlex.quote(o.calot)}"]
    part = plan.with_suffix(".part")
    part.write_text("\n".join(lines) + "\n", encoding="utf-8")
    part.rename(plan)


def shares_of(folder):
    for line in (folder / "plan.sh").read_text(encoding="utf-8").splitlines():
        if line.startswith("shares="):
            return int(line.partition("=")[2])
    sys.exit(f"submit: {folder / 'plan.sh'}: no number of shares")


def progress(o):
    done = 0
    for path in (o.folder / "shares").glob("*.db"):
        try:
            with contextlib.closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as database:
                done += database.execute("SELECT count(*) FROM attempt").fetchone()[0]
        except sqlite3.Error:  # begun a moment ago
            pass
    complete = len(list((o.folder / "shares").glob("*.done")))
    print(f"{complete} of {shares_of(o.folder)} shares complete, {done} recordings done")


def submit(o):
    o.folder.mkdir(parents=True, exist_ok=True)
    make_plan(o)
    shares = shares_of(o.folder)
    left = [n for n in range(1, shares + 1) if not (o.folder / "shares" / f"{n}.done").exists()]
    after = []
    if left:
        limit = f"%{o.limit}" if o.limit else ""
        job = run("sbatch", "--parsable", f"--array={ranges(left)}{limit}", f"--output={o.folder / 'log' / '%a.log'}", *o.sbatch,
                  HERE / "share.sbatch", o.folder).strip().partition(";")[0]
        # Not afterok: the report counts shares that are not complete.
        after = [f"--dependency=afterany:{job}"]
        print(f"submit: {len(left)} of {shares} shares: job {job}")
    job = run("sbatch", "--parsable", *after, f"--output={o.folder / 'log' / 'take.log'}", *o.sbatch, HERE / "take.sbatch", o.folder)
    print(f"submit: report: job {job.strip().partition(';')[0]}, {o.folder / 'report.txt'}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", choices=("regrade", "assess", "progress"))
    parser.add_argument("recordings", nargs="*", help="recordings, or folders that hold them")
    parser.add_argument("--cohort", help="cohort database")
    parser.add_argument("--folder", required=True, type=lambda p: pathlib.Path(p).resolve(), help="of this run: shares, logs, report")
    parser.add_argument("--shares", type=int, default=0, help="how many; default: by --bundle or --each")
    parser.add_argument("--bundle", type=float, default=1800.0, help="regrade: seconds of recorded time in a share (1800)")
    parser.add_argument("--each", type=int, default=100, help="assess: recordings in a share (100)")
    parser.add_argument("--limit", type=int, default=0, help="jobs at a time; default: the cluster's own limit")
    parser.add_argument("--sbatch", action="append", default=[], metavar="OPTION", help="passed to sbatch: --sbatch=--partition=long")
    parser.add_argument("--calot", default=os.environ.get("CALOT", "calot"), help="the program, as nodes find it")
    o = parser.parse_intermixed_args()
    if o.work == "progress":
        progress(o)
    elif not o.cohort:
        parser.error("--cohort is wanted")
    elif o.work == "assess" and not o.recordings:
        parser.error("recordings or folders are wanted")
    else:
        submit(o)


if __name__ == "__main__":
    main()
