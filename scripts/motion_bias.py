#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bias of every figure of motion over a tracker's rate and noise: the same simulated hands, sampled as trackers sample.

    motion_bias.py CALOT               prints the table, in Markdown
    motion_bias.py CALOT --check DOC   compares it with a page's: exit 3 where a cell differs by more than its last digit
"""
import argparse
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy

# Hz, and mm of noise, standard deviation on each axis (1 mrad of turn for 0.1 mm); the first is the truth
TRACKERS = ((100, 0.0), (100, 0.1), (100, 0.2), (100, 0.3), (60, 0.2), (30, 0.0), (30, 0.1), (30, 0.2), (30, 0.3))
HANDS = ("left", "right")
MOTIONS, SECONDS, SEED = 8, 60.0, 43
ABSOLUTE = {"sparc", "log-dimensionless-jerk", "movement-jerk", "bimanual-correlation", "bimanual-lag", "hand-ratio", "movement-straightness"}
APART = {"attempt-duration", "elapsed-time", "motion-rate"}


class Hand:
    """Strokes of minimum jerk with rests of 0.2 to 2 s between them; the shaft turns with each stroke."""

    def __init__(self, generator):
        self.strokes, at, place, turn = [], 0.5, numpy.zeros(3), numpy.zeros(3)
        while at < SECONDS:
            way, twist, duration = generator.uniform(-0.03, 0.03, 3), generator.uniform(-0.3, 0.3, 3), generator.uniform(0.3, 1.2)
            self.strokes.append((at, duration, way - place, twist - turn))
            place, turn = way, twist
            at += duration + generator.uniform(0.2, 2.0) * (generator.random() < 0.5)

    def at(self, t):
        place, turn = numpy.zeros((len(t), 3)), numpy.zeros((len(t), 3))
        for start, duration, way, twist in self.strokes:
            u = numpy.clip((t - start) / duration, 0.0, 1.0)[:, None]
            s = u ** 3 * (10.0 - 15.0 * u + 6.0 * u * u)
            place, turn = place + s * way, turn + s * twist
        return place, turn


def quaternions(turn):
    angle = numpy.linalg.norm(turn, axis=1, keepdims=True)
    return numpy.hstack([numpy.cos(angle / 2), numpy.sinc(angle / (2 * numpy.pi)) * turn / 2])


def write(path, hands, rate, noise, generator, seconds=SECONDS, held=0):
    """held: rows a second that repeat the newest sample; 0: each row is one."""
    t = numpy.arange(int(seconds * rate) + 1) / rate
    columns = []
    for hand in hands:
        place, turn = hand.at(t)
        place = place + generator.normal(0.0, 1.0, place.shape) * noise * 1e-3
        turn = turn + generator.normal(0.0, 1.0, turn.shape) * noise * 1e-2
        columns.append(numpy.hstack([place * 1000.0, quaternions(turn)]))
    rows = numpy.hstack([t[:, None], *columns])
    if held:
        times = numpy.arange(int(seconds * held) + 1) / held
        rows = rows[numpy.floor(times * rate + 1e-9).astype(int)]
        rows[:, 0] = times
    names = [f"{h}{c}" for h in HANDS for c in ("x", "y", "z", "qw", "qx", "qy", "qz")]
    with path.open("w", newline="") as out:
        writer = csv.writer(out)
        writer.writerow(["t", *names])
        writer.writerows([[repr(round(x, 9)) for x in row] for row in rows.tolist()])


def write_columns(path):
    path.write_text(json.dumps({
        "format": "calot-columns", "formatVersion": 1, "frame": "world", "device": "tracker", "length": "mm", "delimiter": ",",
        "time": {"column": "t", "unit": "s"},
        **{h: {"position": [f"{h}{c}" for c in "xyz"], "quaternion": [f"{h}q{c}" for c in "wxyz"], "axis": "z"} for h in HANDS}}))


def figures_of(calot, files, columns):
    out = subprocess.run([calot, "import", *files, "--columns", columns, "--cutoff", "6", "--json"], stdout=subprocess.PIPE, check=True).stdout
    return [file["checkpoints"] for file in json.loads(out)["files"]]


def cell_of(name, values, reference, factor):
    """Mean change over motions and hands, in per cent of the reference's mean or in the displayed unit."""
    known = [(v, r) for v, r in zip(values, reference) if v is not None and r is not None]
    wanted = sum(r is not None for r in reference)
    if 2 * len(known) < wanted or not known:
        return "refused"
    change = sum(v - r for v, r in known) / len(known)
    if name in ABSOLUTE:
        return f"{change * factor:+.2f}"
    mean = sum(r for _, r in known) / len(known)
    return f"{100.0 * change / mean:+.1f} %"


def table(calot):
    declared = {c["name"]: c for c in json.loads(subprocess.run([calot, "checkpoints", "--json"], stdout=subprocess.PIPE, check=True).stdout)["checkpoints"]}
    people = [[Hand(numpy.random.default_rng([SEED, motion, hand])) for hand in range(2)] for motion in range(MOTIONS)]
    cells = {}
    with tempfile.TemporaryDirectory() as folder:
        columns = pathlib.Path(folder, "columns.json")
        write_columns(columns)
        for rate, noise in TRACKERS:
            files = [pathlib.Path(folder, f"{rate}-{noise}-{motion}.csv") for motion in range(MOTIONS)]
            for motion, file in enumerate(files):
                write(file, people[motion], rate, noise, numpy.random.default_rng([SEED, motion, rate, int(10 * noise)]))
            cell = cells[rate, noise] = {}
            for figures in figures_of(calot, files, columns):
                for v in figures:
                    cell.setdefault(v["name"], []).append(v["value"])
                    if v["name"] == "path-length":
                        cell.setdefault("noise", []).append(v["noise"])
    reference = cells[TRACKERS[0]]
    head = [f"{rate} Hz, {noise:g} mm" for rate, noise in TRACKERS][1:]
    lines = ["| figure | 100 Hz, no noise | " + " | ".join(head) + " |", "|---" * (len(head) + 2) + "|"]
    known = [1000.0 * sum(cells[tracker]["noise"]) / (2 * MOTIONS) for tracker in TRACKERS]
    lines.append("| noise, estimated (mm) | " + " | ".join(f"{n:.2f}" for n in known) + " |")
    for name, values in reference.items():
        # Figures of motion alone, which are never given for an attempt without motion.
        if name in APART or name == "noise" or declared[name]["origins"] != ["samples"]:
            continue
        factor, unit = declared[name]["display_factor"], declared[name]["display_unit"]
        there = [v for v in values if v is not None]
        mean = f"{factor * sum(there) / len(there):.4g}{'' if unit == '1' else ' ' + unit}" if there else "-"
        row = [cell_of(name, cells[tracker][name], values, factor) for tracker in TRACKERS][1:]
        lines.append(f"| `{name}` | {mean} | " + " | ".join(row) + " |")
    return lines


def differs(one, two):
    """Cells of a row that are not equal to a unit of their last digit."""
    pairs = list(zip(one.split("|"), two.split("|")))
    if len(one.split("|")) != len(two.split("|")):
        return True
    for a, b in pairs:
        numbers = [re.search(r"[-+]?\d+(\.\d+)?", text) for text in (a, b)]
        if a.strip() == b.strip():
            continue
        if not all(numbers) or "`" in a:
            return True
        digits = len((numbers[0].group(1) or ".")[1:])
        if abs(float(numbers[0].group()) - float(numbers[1].group())) > 1.01 * 10.0 ** -digits:
            return True
    return False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("calot")
    parser.add_argument("--check", type=pathlib.Path, metavar="DOC")
    options = parser.parse_args()
    lines = table(options.calot)
    if options.check is None:
        print("\n".join(lines))
        return 0
    page = options.check.read_text().splitlines()
    start = page.index(lines[0]) if lines[0] in page else None
    wrong = lines if start is None else [line for line, there in zip(lines, page[start:start + len(lines)]) if differs(line, there)]
    for line in wrong:
        print(f"{options.check}: not as published: {line}", file=sys.stderr)
    return 3 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
