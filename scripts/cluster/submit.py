#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regrades a cohort, or assesses folders, as an array of Slurm jobs: shares, then one job that takes them all and reports.

Run it again after jobs were killed or nodes failed: complete shards stay, one that was cut short goes on where it was. The folder has to be
on a file system that all nodes see. docs/how-to/cluster.md describes all of it.

  submit.py regrade --cohort C.db --folder RUN RECORDINGS...     --shards N, or as many as --bundle gives
  submit.py assess  --cohort C.db --folder RUN RECORDINGS...
  submit.py progress --folder RUN
"""
import argparse
import contextlib
import json
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


def snapshot(cohort, copy):
    """A copy that no job writes to: all shards see one list of attempts, and no lock is held on the file system of the nodes."""
    part = copy.with_suffix(".part")
    part.unlink(missing_ok=True)
    with contextlib.closing(sqlite3.connect(f"file:{cohort}?mode=ro", uri=True)) as source, contextlib.closing(sqlite3.connect(part)) as target:
        source.backup(target)
        target.execute("PRAGMA journal_mode = DELETE")
    part.rename(copy)


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
    if o.shards > limit:
        sys.exit(f"submit: --shards {o.shards}: an array of this cluster holds {limit} jobs (MaxArraySize)")
    if o.shards:
        return o.shards
    what = [o.cohort] if o.work == "regrade" else []
    plan = json.loads(run(o.calot, o.work, *what, *places, "--plan", 1, "--json"))
    wanted = plan["seconds"] / o.bundle if o.work == "regrade" else plan["recordings"] / o.each
    return max(1, min(limit, plan["recordings"], math.ceil(wanted)))


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
    """RUN/plan.sh, which the jobs read; one that is there stays: its shards are in it."""
    plan = o.folder / "plan.sh"
    places = [str(pathlib.Path(p).resolve()) for p in o.recordings]
    cohort = pathlib.Path(o.cohort).resolve()
    copy = []
    if o.work == "regrade":
        places = places or [str(cohort.parent)]
        copy = [str(o.folder / "cohort.db")]
    lines = [f"work={o.work}", f"cohort={shlex.quote(str(cohort))}", "input=(" + " ".join(shlex.quote(p) for p in copy + places) + ")"]
    if plan.exists():
        if not set(lines) <= set(plan.read_text(encoding="utf-8").splitlines()):
            sys.exit(f"submit: {o.folder} holds a run of another cohort or other recordings; name another --folder")
        print(f"submit: going on with {plan}")
        return
    for name in ("values", "log"):
        (o.folder / name).mkdir(parents=True, exist_ok=True)
    lines += [f"shards={share_count(o, places)}", f"calot={shlex.quote(o.calot)}"]
    if copy:
        snapshot(cohort, pathlib.Path(copy[0]))
    part = plan.with_suffix(".part")
    part.write_text("\n".join(lines) + "\n", encoding="utf-8")
    part.rename(plan)


def shards_of(folder):
    for line in (folder / "plan.sh").read_text(encoding="utf-8").splitlines():
        if line.startswith("shards="):
            return int(line.partition("=")[2])
    sys.exit(f"submit: {folder / 'plan.sh'}: no number of shards")


def progress(o):
    """Counts lines; a header, and where a share is complete an end, are no recordings."""
    shards, complete, done = shards_of(o.folder), 0, 0
    for path in (o.folder / "values").glob("*.values*"):
        with open(path, "rb") as file:
            lines = sum(block.count(b"\n") for block in iter(lambda f=file: f.read(1 << 20), b""))
        whole = path.suffix == ".values"
        complete += whole
        done += max(0, lines - 1 - whole)
    print(f"{complete} of {shards} shards complete, {done} recordings done")


def submit(o):
    o.folder.mkdir(parents=True, exist_ok=True)
    make_plan(o)
    shards = shards_of(o.folder)
    left = [n for n in range(1, shards + 1) if not (o.folder / "values" / f"{n}.values").exists()]
    after = []
    if left:
        limit = f"%{o.limit}" if o.limit else ""
        job = run("sbatch", "--parsable", f"--array={ranges(left)}{limit}", f"--output={o.folder / 'log' / '%a.log'}", *o.sbatch,
                  HERE / "share.sbatch", o.folder).strip().partition(";")[0]
        # Not afterok: the report says which shards are missing.
        after = [f"--dependency=afterany:{job}"]
        print(f"submit: {len(left)} of {shards} shards: job {job}")
    job = run("sbatch", "--parsable", *after, f"--output={o.folder / 'log' / 'take.log'}", *o.sbatch, HERE / "take.sbatch", o.folder)
    print(f"submit: report: job {job.strip().partition(';')[0]}, {o.folder / 'report.txt'}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", choices=("regrade", "assess", "progress"))
    parser.add_argument("recordings", nargs="*", help="recordings, or folders that hold them")
    parser.add_argument("--cohort", help="cohort database")
    parser.add_argument("--folder", required=True, type=lambda p: pathlib.Path(p).resolve(), help="of this run: values, logs, report")
    parser.add_argument("--shards", type=int, default=0, help="how many; default: by --bundle or --each")
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
