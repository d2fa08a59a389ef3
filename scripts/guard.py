#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guards the run time: instructions of replays of goldens within a narrow margin, ratios of benchmarks within a wide one.

Instructions are counted by callgrind, which has AVX2: they do not depend on what else the machine does, but on the
compiler; kept are those of Debian 12's g++, optimised. Steps of an operation and of a box are counted with AVX2 and, in a
tree of CALOT_VECTOR_BITS=128, with SSE2. Ratios compare with a peer in the same run. What is kept stands in
tests/bench/guard.json; --update writes the counts anew, where a change is meant to cost what it costs.
"""
import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

kept_path = "tests/bench/guard.json"


def instructions(*command: str) -> int:
    """Instructions of a command, which must succeed; of its processes, of the one with the most."""
    run = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *command], capture_output=True, text=True,
                         check=False)
    collected = re.findall(r"Collected : (\d+)", run.stderr)  # of each process
    if run.returncode != 0 or not collected:
        sys.exit(f"guard: {' '.join(command)}: under callgrind failed with exit code {run.returncode}: "
                 f"{(run.stderr or run.stdout).strip().splitlines()[-1:]}")
    return max(int(count) for count in collected)


def replay(calot: str, golden: dict, folder: str) -> int:
    """Of the replay of a golden's run, recorded anew, which must be bit-exact."""
    recording = f"{folder}/{golden['scene']}.h5"
    subprocess.run([calot, "record", "--scene", golden["scene"], "--performer", golden["performer"], "--seed", str(golden["seed"]),
                    "--seconds", str(golden["seconds"]), "--purpose", "golden", "-o", recording], check=True, capture_output=True)
    return instructions(calot, "replay", recording)


def operation(calot: str, folder: str) -> str:
    """A State of the operation, just before the first touch, with the samples of 2 s."""
    recording, state = f"{folder}/operation.h5", f"{folder}/operation.flat"
    subprocess.run([calot, "record", "--scene", "cholecystectomy", "--performer", "skilled", "--seed", "1", "--seconds", "4", "-o",
                    recording], check=True, capture_output=True)
    subprocess.run([calot, "state", recording, "--step", "160", "--flat", "-o", state], check=True, capture_output=True)
    return state


def counters(bench: str, names: list[str]) -> dict[str, dict[str, float]]:
    """Medians of the benchmarks' counters, by name."""
    pattern = "^(" + "|".join(re.escape(name) for name in names) + ")(/|$)"
    run = subprocess.run([bench, f"--benchmark_filter={pattern}", "--benchmark_format=json"], capture_output=True,
                         text=True, check=False)
    if run.returncode != 0:
        sys.exit(f"guard: {bench} failed with exit code {run.returncode}: {run.stderr.strip()}")
    found = {}
    for row in json.loads(run.stdout)["benchmarks"]:
        if row.get("aggregate_name") == "median":
            found[row["run_name"].split("/manual_time")[0].split("/iterations")[0]] = row
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("calot")
    parser.add_argument("bench")
    parser.add_argument("matrix", help="calot-matrix with all clones")
    parser.add_argument("narrow", help="calot-matrix of CALOT_VECTOR_BITS=128")
    parser.add_argument("--root", default=".")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--update", action="store_true", help="keep this run's instruction counts")
    args = parser.parse_args()
    path = os.path.join(args.root, kept_path)
    with open(path, encoding="utf-8") as file:
        kept = json.load(file)
    failed = 0
    with open(os.path.join(args.root, "assets/golden/golden.json"), encoding="utf-8") as file:
        goldens = {os.path.splitext(golden["file"])[0]: golden for golden in json.load(file)["recordings"]}
    with ThreadPoolExecutor(args.jobs) as pool, tempfile.TemporaryDirectory() as folder:
        state = operation(args.calot, folder)
        work = {name: lambda name=name: replay(args.calot, goldens[name], folder) for name in ("touch-liver", "dissect-bed")}
        for vectors, program in (("AVX2", args.matrix), ("SSE2", args.narrow)):
            work[f"operation, {vectors}"] = lambda program=program: instructions(program, state)
            work[f"box, {vectors}"] = lambda program=program: instructions(program, "--large-solid")
        counts = dict(zip(work, pool.map(lambda one: one(), work.values())))
    for name, count in counts.items():
        before = count if args.update else kept["instructions"].get(name)
        if before is None:
            sys.exit(f"guard: {kept_path}: no count of {name}: {count} now; keep it with --update")
        change = count / before - 1.0
        good = change <= kept["instructionMargin"]
        note = "" if good else f": more than {100 * kept['instructionMargin']:.0f} % above what is kept"
        if change < -kept["instructionMargin"]:
            note = ": fewer; keep it with --update"
        print(f"guard: {name}: {count / 1e9:.3f}e9 instructions, {100 * change:+.2f} %{note}")
        failed += not good
        kept["instructions"][name] = before
    if args.update:
        with open(path, "w", encoding="utf-8") as file:
            json.dump(kept, file, indent=2)
            file.write("\n")
        return 0
    measured = counters(args.bench, sorted({bound["benchmark"] for bound in kept["ratios"]}))
    for bound in kept["ratios"]:
        row = measured.get(bound["benchmark"])
        if row is None or bound["counter"] not in row:
            sys.exit(f"guard: {kept_path}: no counter {bound['counter']} of {bound['benchmark']}")
        value = row[bound["counter"]]
        good = bound.get("least", float("-inf")) <= value <= bound.get("most", float("inf"))
        limits = ", ".join(f"at {side} {bound[side]:g}" for side in ("least", "most") if side in bound)
        print(f"guard: {bound['benchmark']} {bound['counter']}: {value:.3g} ({limits}){'' if good else ': out of bounds'}")
        failed += not good
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
