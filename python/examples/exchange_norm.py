#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""External validation by exchange: a frozen norm travels, another site applies it, and figures come back; recordings and people stay.

    exchange_norm.py freeze here.db clinic -o clinic.json
    exchange_norm.py apply clinic.json there.db --better expert -o figures.json          # at the other site, then:
    calot station sign figures.json --station-key station.json -o signed.json
    calot dossier here.db --external signed.json                                         # here again

Needs `calot` on the path, or --calot, and Python alone. A metric of a site's own travels as a figure of a norm: the other site runs the
script with `calot assess --metric`, and its values are accepted by the script's hash."""

import argparse
import csv
import hashlib
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

LEAST = 5  # people of a group: of fewer, one person's figures could be worked out
CHANGING = ("schema", "members", "pass_rate", "use")  # members withdraw, evidence is attached


def fail(code, message):
    print(f"exchange_norm: {message}", file=sys.stderr)
    sys.exit(code)


def calot(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        fail(done.returncode, done.stderr.strip())
    return done.stdout


def program_of(program):
    path = shutil.which(program) or fail(2, f"{program}: no such program")
    return {"version": calot(program, "--version").strip(), "sha256": hashlib.sha256(pathlib.Path(path).resolve().read_bytes()).hexdigest()}


def digest(norm):
    return hashlib.sha256(json.dumps(norm, sort_keys=True).encode()).hexdigest()


def write(path, value):
    try:
        with open(path, "x", encoding="utf-8") as out:
            out.write(json.dumps(value, indent=1) + "\n")
    except OSError as error:
        fail(2, f"{path}: {error.strerror}")


def freeze(o):
    norm = json.loads(calot(o.calot, "norm", "show", o.database, o.norm, "--json"))
    norm = {k: v for k, v in norm.items() if k not in CHANGING and k != "created_utc"}
    write(o.output, {"format": "calot-frozen-norm", "format_version": 1, "sha256": digest(norm), "program": program_of(o.calot), "norm": norm})


def read_frozen(path):
    try:
        frozen = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        good = (frozen["format"], frozen["format_version"]) == ("calot-frozen-norm", 1) and frozen["sha256"] == digest(frozen["norm"])
    except (OSError, ValueError, KeyError, TypeError):
        good = False
    return frozen if good else fail(4, f"{path}: no frozen norm, or changed since it was frozen")


def share(count, of):
    """Wilson's score interval."""
    z, p = 1.959963984540054, count / of
    centre, half = p + z * z / (2 * of), z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    lower, upper = (centre - half) / (1 + z * z / of), (centre + half) / (1 + z * z / of)
    return {"count": count, "of": of, "share": p, "interval": {"lower": max(0.0, lower), "upper": min(1.0, upper)}}


def passes(norm, marks, values, factor):
    """The norm's rule: no critical error, what is fixed, and enough of the figures. A figure without a value is not passed."""
    if values.get(("critical-errors", ""), 0.0) > 0:
        return False
    passed = 0
    for mark in marks:
        value, cut = values.get((mark["checkpoint"], mark["subject"])), mark["cut_si"] * factor(mark["checkpoint"])
        good = value is not None and (value <= cut * (1 + 1e-12) if mark["direction"] == "lower" else value >= cut * (1 - 1e-12))
        if mark["fixed"] and not good:
            return False
        passed += good
    return passed >= norm["needed"]


def apply(o):
    frozen = read_frozen(o.frozen)
    norm, marks = frozen["norm"], [c for c in frozen["norm"]["checkpoints"] if c["in_rule"]]
    with tempfile.TemporaryDirectory() as folder:
        words = ["study", o.database, "--attempt-rule", "first", "--better", o.better, "--key", norm["comparability_key"], "--phases"]
        words += ["--groups", o.groups] if o.groups else []
        words += ["--include-synthetic"] if o.include_synthetic else []
        study = json.loads(calot(o.calot, *words, "--json"))
        calot(o.calot, *words, "--csv", folder)
        with open(pathlib.Path(folder) / "values.csv", encoding="utf-8", newline="") as table:
            rows = list(csv.DictReader(table))
    if min(study["participants"]) < LEAST:
        fail(3, f"{o.database}: figures leave a site of {LEAST} people a group or more; there are {' and '.join(map(str, study['participants']))}")
    found = {(r["checkpoint"], r["subject"]): r for r in study["rows"]}
    for mark in marks:
        row = found.get((mark["checkpoint"], mark["subject"]))
        if row is None or row["versions"] != [mark["version"]] or row.get("source_sha256", "") != mark.get("source_sha256", ""):
            fail(3, f"{o.database}: has no values of {mark['checkpoint']} {mark['subject']} of the norm's version and script; assess again")
    factors = {c["name"]: c["display_factor"] for c in json.loads(calot(o.calot, "checkpoints", "--json"))["checkpoints"]}
    people = {}
    for row in rows:
        values = people.setdefault((row["group"], row["participant"]), {})
        if row["value"]:
            values[(row["checkpoint"], row["subject"])] = float(row["value"])
    passed = {side: [passes(norm, marks, v, lambda name: factors.get(name, 1.0)) for (group, _), v in people.items()
                     if (group == o.better) == side] for side in (True, False)}
    area = {m: found[m].get("area", {}) for m in ((m["checkpoint"], m["subject"]) for m in marks)}
    write(o.output, {
        "norm": norm["name"], "norm_version": norm["version"], "norm_sha256": frozen["sha256"], "norm_program": frozen["program"],
        "program": program_of(o.calot), "marks": marks, "synthetic": study["synthetic"] or norm["synthetic"], "groups": study["groups"],
        "better": o.better, "false_pass": share(sum(passed[False]), len(passed[False])),
        "false_fail": share(len(passed[True]) - sum(passed[True]), len(passed[True])),
        "figures": [{"figure": " ".join(m).strip(), "n": [g["n"] for g in found[m]["groups"]], "a": a.get("a"),
                     "lower": a.get("interval", {}).get("lower"), "upper": a.get("interval", {}).get("upper")} for m, a in area.items()]})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calot", default="calot", help="the program")
    commands = parser.add_subparsers(required=True)
    one = commands.add_parser("freeze", help="write a norm without its members")
    one.add_argument("database")
    one.add_argument("norm")
    one.set_defaults(work=freeze)
    two = commands.add_parser("apply", help="apply a frozen norm to the groups of this site")
    two.add_argument("frozen")
    two.add_argument("database")
    two.add_argument("--better", required=True, help="the competent group")
    two.add_argument("--groups", help="the two groups, A,B")
    two.add_argument("--include-synthetic", action="store_true")
    two.set_defaults(work=apply)
    for command in (one, two):
        command.add_argument("-o", "--output", required=True)
    o = parser.parse_args()
    o.work(o)


if __name__ == "__main__":
    main()
