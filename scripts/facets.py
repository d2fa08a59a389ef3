#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Attempts of performers on several discretisations of a scene, and the variance components of their figures: the parts of facets.sh.

usage: facets.py prepare|missing|attempt|table --folder F --calot PROGRAM --scene S [options] [--which DISCRETISATION PROFILE SEED]

A discretisation is the scene divided by `calot scene divide`. Components and their intervals are those of `calot study --design reliability`: seeds
are people nested in profiles, discretisations the levels of the facet. Each question has levels of its own (QUESTIONS), always complete: a seed
without all of them is left out there and counted.
"""
import argparse
import csv
import functools
import hashlib
import json
import os
import pathlib
import re
import resource
import shutil
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROFILES = ("skilled", "unskilled")
# Name: elements over those of the scene, and the step over that of the scene. "beside" has other tetrahedra of the same size: what differs there
# is an attempt's own sensitivity, not what a finer mesh would change.
DISCRETISATIONS = {"scene": (1.0, 1.0), "beside": (1.02, 1.0), "half-step": (1.0, 0.5), "finer": (2.0, 1.0), "finest": (4.0, 1.0)}
FEW = ("finest",)  # of the first --fine-seeds seeds alone
QUESTIONS = {"all": ("scene", "half-step", "finer"), "beside": ("scene", "beside"), "step": ("scene", "half-step"), "mesh": ("scene", "finer"),
             "finest": ("scene", "finer", "finest")}
TITLES = {"beside": "beside", "step": "half the step", "mesh": "twice the elements", "finest": "up to four times"}
MARK = 0.05  # shares above it are marked
FORMAT = 1  # of a file of figures


class Study:
    """What the options ask for, and where it lies."""

    def __init__(self, options):
        self.options = options
        self.calot, self.scene, self.folder = options.calot, options.scene, options.folder
        self.attempts, self.running = self.folder / "attempts", self.folder / "running"

    def scene_file(self, discretisation):
        return self.folder / "divided" / "scenes" / f"{self.scene}-{discretisation}.json"

    def wanted(self):
        """(discretisation, profile, seed), seed after seed: a study that is cut short has as many of each."""
        for seed in range(1, self.options.seeds + 1):
            for discretisation in DISCRETISATIONS:
                if discretisation not in FEW or seed <= self.options.fine_seeds:
                    yield from ((discretisation, profile, seed) for profile in PROFILES)

    def name(self, discretisation, profile, seed):
        return f"{self.scene}-{discretisation}-{profile}-{seed}"

    @functools.cached_property
    def simulation_version(self):
        return int(re.search(r"simulationVersion = (\d+)", (ROOT / "sim/scene/version.h").read_text(encoding="utf-8"))[1])

    @functools.lru_cache(maxsize=None)
    def scene_digest(self, discretisation):
        """Of the divided scene and its surfaces."""
        digest = hashlib.sha256(self.scene_file(discretisation).read_bytes())
        for surface in sorted((self.folder / "divided" / "organs").iterdir()):
            digest.update(surface.read_bytes())
        return digest.hexdigest()

    @functools.lru_cache(maxsize=None)
    def performer(self, profile):
        return f"{profile} {json.loads((ROOT / f'assets/performers/{profile}.json').read_text(encoding='utf-8'))['version']}"

    def identity(self, discretisation, profile, seed):
        """What decides an attempt's figures: one that is there with another is made again."""
        return {"scene": self.scene_digest(discretisation), "simulation_version": self.simulation_version, "performer": self.performer(profile),
                "seed": seed, "seconds": self.options.seconds}

    def read(self, discretisation, profile, seed):
        """The attempt's file if it is whole and of this study, else None."""
        try:
            found = json.loads((self.attempts / f"{self.name(discretisation, profile, seed)}.json").read_text(encoding="utf-8"))
            sound = found["format"] == FORMAT and found["of"] == self.identity(discretisation, profile, seed) and found["figures"]
            return found if sound and found["cost_seconds"] > 0 else None
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def read_all(self):
        return {which: found for which in self.wanted() if (found := self.read(*which)) is not None}

    def left(self):
        """Words on what is still to be made, by what the discretisations have cost so far."""
        there, costs = self.read_all(), {}
        for (discretisation, _, _), found in there.items():
            costs.setdefault(discretisation, []).append(found["cost_seconds"])
        left = [which[0] for which in self.wanted() if which not in there]
        if not left or not costs:
            return f"{len(left)} left"
        mean = {name: statistics.mean(of) for name, of in costs.items()}
        dearest = max(mean.values())
        seconds = sum(mean.get(name, dearest) for name in left) / self.options.jobs
        return f"{len(left)} left, some {seconds / 60:.0f} min" if seconds < 7200 else f"{len(left)} left, some {seconds / 3600:.1f} h"


def write_whole(path, text):
    part = path.with_name(path.name + ".part")
    with part.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, path)


def prepare(study):
    """Divides the scene, and removes what a run that was stopped has left."""
    shutil.rmtree(study.running, ignore_errors=True)
    for folder in (study.attempts, study.running):
        folder.mkdir(parents=True, exist_ok=True)
    for part in study.attempts.glob("*.part"):
        part.unlink()
    listed = json.loads(subprocess.run([study.calot, "scenes", "--json"], check=True, capture_output=True, text=True).stdout)["scenes"]
    ticks = next((s["ticks_per_step"] for s in listed if s["name"] == study.scene), None)
    if ticks is None:
        sys.exit(f"facets: no scene {study.scene} (there are: {', '.join(s['name'] for s in listed)})")
    for discretisation, (elements, step) in DISCRETISATIONS.items():
        subprocess.run([study.calot, "scene", "divide", study.scene, "--elements", str(elements), "--ticks-per-step", str(round(ticks * step)), "--force",
                        "-o", study.scene_file(discretisation)], check=True, stdout=subprocess.DEVNULL)


def missing(study):
    there = study.read_all()
    for which in study.wanted():
        if which not in there:
            print(*which)


def figure_name(row):
    return f"{row['name']} {row['subject']}".strip()


def reason(done):
    """Why a command failed: the last line of its errors, or what its report says of the recording."""
    lines = done.stderr.strip().splitlines()
    if lines:
        return lines[-1]
    try:
        return json.loads(done.stdout)["recordings"][0]["message"]
    except (ValueError, KeyError, IndexError):
        return "no reason was given"


def attempt(study, discretisation, profile, seed, keep):
    """Records and assesses one attempt, and prints a line on it."""
    name = study.name(discretisation, profile, seed)
    recording, cohort = study.running / f"{name}.h5", study.running / f"{name}.db"
    cohort.unlink(missing_ok=True)
    begun = time.monotonic()
    limit = ["--seconds", str(study.options.seconds)] if study.options.seconds else []
    said = {}
    for word, command in (("record", ["record", "--scene", study.scene_file(discretisation), "--performer", profile, "--seed", str(seed), *limit, "--force",
                                      "--json", "-o", recording]),
                          ("assess", ["assess", recording, "--cohort", cohort, "--threads", "1", "--json"])):
        done = subprocess.run([study.calot, *command], check=False, capture_output=True, text=True)
        if done.returncode != 0:
            print(f"FAILED {name}: calot {word}: exit {done.returncode}: {reason(done)}")
            return
        said[word] = json.loads(done.stdout)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    cost, row = time.monotonic() - begun, said["assess"]["recordings"][0]
    figures = [{"name": figure_name(c), "unit": c["unit"], "value": c["value"]} for c in row["checkpoints"]]
    result = {"format": FORMAT, "of": study.identity(discretisation, profile, seed), "outcome": said["record"]["outcome"],
              "seconds": said["record"]["seconds"], "cost_seconds": cost, "processor_seconds": used.ru_utime + used.ru_stime, "figures": figures}
    write_whole(study.attempts / f"{name}.json", json.dumps(result, indent=1) + "\n")
    cohort.unlink(missing_ok=True)
    if keep:
        (study.folder / "recordings").mkdir(exist_ok=True)
        os.replace(recording, study.folder / "recordings" / recording.name)
    else:
        recording.unlink()
    print(f"{name}: {result['seconds']:.1f} s, {result['outcome']}, took {cost:.0f} s; {study.left()}", flush=True)


def components(study, attempts, question):
    """{figure: what `calot study` says of it, components and shares} of the attempts at the question's levels."""
    levels = QUESTIONS[question]
    rows = {}
    for (discretisation, profile, seed), found in attempts.items():
        if discretisation in levels:
            rows[profile, seed, discretisation] = {f["name"]: f["value"] for f in found["figures"]}
    people = [p for p in {(profile, seed) for profile, seed, _ in rows} if all((*p, level) in rows for level in levels)]
    rows = {key: values for key, values in sorted(rows.items()) if key[:2] in people}
    names = [n for n in dict.fromkeys(n for values in rows.values() for n in values) if any(values.get(n) is not None for values in rows.values())]
    if min((sum(p[0] == profile for p in people) for profile in PROFILES), default=0) < 2:
        return {}
    table = study.folder / f"{question}.csv"
    with table.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["person", "profile", "discretisation", *names])
        for (profile, seed, level), values in rows.items():
            writer.writerow([f"{profile}-{seed}", profile, level, *("" if values.get(n) is None else repr(values[n]) for n in names)])
    done = subprocess.run([study.calot, "study", "--table", table, "--participant-column", "person", "--group-column", "profile", "--occasion-column",
                           "discretisation", "--design", "reliability", "--json", *(word for n in names for word in ("--outcome", n))],
                          check=False, capture_output=True, text=True)
    if done.returncode == 3:  # no figure can be analysed
        return {}
    if done.returncode != 0:
        sys.exit(f"facets: {table}: {done.stderr.strip()}")
    said = json.loads(done.stdout)
    found = {row["figure"]: row for row in said["components"] if row["of"] == "within groups"}
    for row in said["shares"]:
        found[row["figure"]]["shares"] = row
    return found


def table_two():
    """The figures of the 2014 paper's Table 2, in its order."""
    protocol = json.loads((ROOT / "assets/protocols/cholecystectomy-2014-table2.json").read_text(encoding="utf-8"))
    return [f"{h['checkpoint']} {h.get('subject', '')}".strip() for h in protocol["hypotheses"]]


def percent(share, mark=False):
    text = f"{100 * share['share']:.1f} %"
    if mark and share["share"] > MARK:
        text = f"**{text}**"
    interval = share["interval"]
    return f"{text} [{100 * interval['lower']:.0f}, {100 * interval['upper']:.0f}]" if "lower" in interval else text


def main_table(order, found, attempts):
    yield ("| figure | unit | skilled | unskilled | people (deviation) | discretisation | all alike | by profile | by person |")
    yield "|" + " --- |" * 9
    units = {f["name"]: f["unit"] for a in attempts.values() for f in a["figures"]}
    for name in order:
        row = found[name]
        if "level" not in row["shares"]:
            continue
        means = []
        for profile in PROFILES:
            values = [f["value"] for (level, who, _), a in attempts.items() if (level, who) == ("scene", profile) for f in a["figures"]
                      if f["name"] == name and f["value"] is not None]
            means.append(f"{statistics.mean(values):.3g}" if values else "none")
        cut = " (0)" if row["truncated"] else ""
        parts = [percent(row["shares"][part]).split(" [")[0] for part in ("common", "interaction", "residual")]
        yield (f"| {name} | {units[name]} | {means[0]} | {means[1]} | {row['person_variance'] ** 0.5:.3g} | {percent(row['shares']['level'], True)}{cut} | "
               f"{' | '.join(parts)} |")


def question_table(order, answers):
    asked = [q for q in TITLES if answers.get(q)]
    yield "| figure | " + " | ".join(TITLES[q] for q in asked) + " |"
    yield "|" + " --- |" * (1 + len(asked))
    for name in order:
        cells = [answers[q].get(name, {}).get("shares", {}) for q in asked]
        yield f"| {name} | " + " | ".join(percent(c["level"], True) if "level" in c else "-" for c in cells) + " |"


def unsaid(attempts, analysed):
    """Sentences on the figures without components."""
    values = {}
    for found in attempts.values():
        for f in found["figures"]:
            values.setdefault(f["name"], []).append(f["value"])
    rest = {n: v for n, v in values.items() if n not in analysed and any(x is not None for x in v)}
    same = sorted(n for n, v in rest.items() if len(set(v)) == 1)
    others = sorted(n for n in rest if n not in same)
    if same:
        yield f"The same in all attempts: {', '.join(same)}."
    if others:
        yield f"Without components, since too few seeds have a value everywhere or nothing varies within profiles: {', '.join(others)}."


def table(study):
    attempts = study.read_all()
    answers = {question: components(study, attempts, question) for question in QUESTIONS}
    found = answers["all"]
    if not found:
        print("facets: no table yet: two seeds of each profile at the scene's discretisation, twice the elements and half the step are needed")
        return
    names = [n for n in found if "level" in found[n]["shares"]]
    first = [n for n in table_two() if n in names]
    contacts = [n for n in names if n not in first and n.startswith("contact-time-union ")]
    others = [n for n in names if n not in first + contacts and "phase" not in n]
    seeds = {p: len({s for _, who, s in attempts if who == p}) for p in PROFILES}
    above = [n for n in first + contacts + others if found[n]["shares"]["level"]["share"] > MARK]
    length = f"the first {study.options.seconds:g} s of an attempt" if study.options.seconds else "whole attempts"
    lines = [f"# Discretisation beside people: {study.scene}", "",
             f"Simulation version {next(iter(attempts.values()))['of']['simulation_version']}, {length}, closed loop; "
             f"{len(attempts)} attempts, seeds: {', '.join(f'{n} {p}' for p, n in seeds.items())}.", "",
             "Shares are of the variance of a figure within its profile. Discretisation: what depends on it, in all alike, by profile, or by person; the "
             f"rest is people's. Intervals: 95 %, percentile bootstrap over seeds ({found[names[0]]['shares']['resamples']} resamples, seed "
             f"{found[names[0]]['shares']['seed']}). Shares above {100 * MARK:.0f} % are bold. (0): a negative component was set to 0."]
    for title, order in (("Figures of the paper's Table 2", first), ("Contact times", contacts), ("Other figures", others)):
        if order:
            lines += ["", f"## {title}", "", *main_table(order, found, attempts), "", *question_table(order, answers)]
    lines += ["", f"Above {100 * MARK:.0f} %: {len(above)} of {len(first + contacts + others)} figures.", "", *unsaid(attempts, found)]
    write_whole(study.folder / "components.json", json.dumps(answers, indent=1) + "\n")
    write_whole(study.folder / "facets.md", "\n".join(lines) + "\n")
    print("\n".join(lines), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("prepare", "missing", "attempt", "table"))
    parser.add_argument("--folder", type=pathlib.Path, required=True)
    parser.add_argument("--calot", type=pathlib.Path, required=True)
    parser.add_argument("--scene", required=True)
    parser.add_argument("--seconds", type=float, default=0.0, help="0: whole attempts")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--fine-seeds", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", action="store_true", help="the recordings, too")
    parser.add_argument("--which", nargs=3, metavar=("DISCRETISATION", "PROFILE", "SEED"))
    options = parser.parse_args()
    study = Study(options)
    if options.what == "attempt":
        attempt(study, options.which[0], options.which[1], int(options.which[2]), options.keep)
    else:
        {"prepare": prepare, "missing": missing, "table": table}[options.what](study)


if __name__ == "__main__":
    main()
