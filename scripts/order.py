#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Performers of known order: does each figure of the 2014 paper's Table 2 go the way that the paper reports?

usage: order.py [N [FOLDER]]     N attempts each of the skilled and the unskilled performer (20)

Without FOLDER they lie in one of build/order that is named by the versions of simulation and performers: those of another version are other attempts.

Records and assesses them (scripts/cohort.sh: a run that was cut short goes on), lets `calot study` compare them, and prints A, the probability of
superiority in the direction that the protocol cholecystectomy-2014-table2 gives, with its interval. Exit code: 0; 1 where an attempt is not complete or
an A is below 0.7. Performers are synthetic: their order is made, and shows that the pipeline finds it, never that a trainer tells people apart.
"""
import csv
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CALOT = os.environ.get("CALOT_PROGRAM", ROOT / "build/release/bin/calot")
PERFORMER = {"expert": "skilled", "novice": "unskilled"}  # who stands for whom in the protocol
LEAST = 0.7
PARTS = (("fat-remaining-inside", "", "unskilled"), ("fat-remaining-outside", "", "skilled"))  # other readings of remaining fat


def expected():
    """Checkpoint, subject and the performer that should have more of it."""
    protocol = json.loads((ROOT / "assets/protocols/cholecystectomy-2014-table2.json").read_text(encoding="utf-8"))
    return [(h["checkpoint"], h.get("subject", ""), PERFORMER[h["larger"]]) for h in protocol["hypotheses"]]


def versions():
    """Versions of the simulation and of both performers: 19-1.4-1.4."""
    simulation = re.search(r"simulationVersion = (\d+)", (ROOT / "sim/scene/version.h").read_text(encoding="utf-8")).group(1)
    profiles = (json.loads((ROOT / f"assets/performers/{name}.json").read_text(encoding="utf-8")) for name in PERFORMER.values())
    return "-".join([simulation, *(profile["version"] for profile in profiles)])


def towards(row, larger):
    """A and its interval, towards the performer that should have more."""
    a, area, lower, upper = (float(row[key]) for key in ("a", "area", "area_lower", "area_upper"))
    if abs(area - a) > 1e-9:  # the interval is of the other direction
        lower, upper = 1.0 - upper, 1.0 - lower
    return (a, lower, upper) if row["group_a"] == larger else (1.0 - a, 1.0 - upper, 1.0 - lower)


def compare(folder, count):
    """Prints the table. @return what falls short"""
    with (folder / "study" / "study.csv").open(encoding="utf-8", newline="") as file:
        rows = {(row["checkpoint"], row["subject"]): row for row in csv.DictReader(file)}
    short = []
    print(f"{'figure (synthetic performers)':37}{'skilled':>10}{'unskilled':>11}  {'unit':5}{'larger':11}{'A':>5}  95 %")
    for checkpoint, subject, larger in expected() + list(PARTS):
        row = rows[checkpoint, subject]
        side = {row["group_a"]: "a", row["group_b"]: "b"}
        name = f"{checkpoint} {subject}".strip()
        a, lower, upper = towards(row, larger)
        median = {performer: float(row[f"median_{side[performer]}"]) for performer in PERFORMER.values()}
        judged = (checkpoint, subject, larger) not in PARTS
        print(f"{name if judged else '  of it: ' + name:37}{median['skilled']:>10.4g}{median['unskilled']:>11.4g}  {row['unit']:5}{larger:11}{a:5.2f}"
              f"  {lower:.2f} to {upper:.2f}")
        if judged and a < LEAST:
            short.append(f"{name}: A {a:.2f}, at least {LEAST} wanted")
        if judged and {int(row["n_a"]), int(row["n_b"])} != {count}:
            short.append(f"{name}: {row['n_a']} and {row['n_b']} attempts have a value, {count} each wanted")
    return short


def main():
    words = sys.argv[1:]
    if len(words) > 2 or (words and not (words[0].isdigit() and int(words[0]) > 1)):
        print("usage: order.py [N [FOLDER]], with N at least 2", file=sys.stderr)
        return 2
    count = int(words[0]) if words else 20
    folder = pathlib.Path(words[1]) if len(words) > 1 else ROOT / "build/order" / versions()
    made = subprocess.run([ROOT / "scripts/cohort.sh", str(count), folder], check=False,
                          env={**os.environ, "CALOT_PROFILES": "skilled unskilled", "CALOT_SCENE": "cholecystectomy", "CALOT_PROGRAM": str(CALOT)})
    if made.returncode:
        return 1
    subprocess.run([CALOT, "study", folder / "cohort.db", "--group-by", "performer", "--include-synthetic", "--csv", folder / "study", "--force"], check=True,
                   stdout=subprocess.DEVNULL)
    short = compare(folder, count)
    for fault in short:
        print(f"order.py: {fault}", file=sys.stderr)
    return 1 if short else 0


if __name__ == "__main__":
    sys.exit(main())
