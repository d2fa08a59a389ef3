# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/facets.sh: a run that was stopped goes on where it was, what is broken is made again, and its components are those of an analysis of
variance by hand. Its heavy form runs attempts of a second."""

import csv
import json
import os
import signal
import subprocess
import time

import numpy
import program

SECONDS = 1 if program.HEAVY else 0.2
LEVELS = ("scene", "half-step", "finer")


def components(values):
    """Person, level, level x group, level x person and group as contributions to the variance of (groups, people, levels)."""
    h, n, k = values.shape
    grand, group, level = values.mean(), values.mean((1, 2)), values.mean((0, 1))
    person, cell = values.mean(2), values.mean(1)
    # Mean squares of the whole design, term by term.
    squares = {
        "group": n * k * ((group - grand)**2).sum() / (h - 1),
        "person": k * ((person - group[:, None])**2).sum() / (h * (n - 1)),
        "level": h * n * ((level - grand)**2).sum() / (k - 1),
        "both": n * ((cell - group[:, None] - level + grand)**2).sum() / ((h - 1) * (k - 1)),
        "rest": ((values - person[:, :, None] - cell[:, None, :] + group[:, None, None])**2).sum() / (h * (n - 1) * (k - 1))}
    fixed = (h - 1) / h  # of a variance over fixed groups that is a contribution
    both = (squares["both"] - squares["rest"]) / n
    return {"person_variance": (squares["person"] - squares["rest"]) / k, "common_variance": (squares["level"] - squares["rest"]) / (h * n),
            "interaction_variance": fixed * both, "residual_variance": squares["rest"],
            "group_variance": fixed * (squares["group"] - squares["person"] - squares["both"] + squares["rest"]) / (n * k)}


class Facets(program.ProgramTest):
    def command(self, *more):
        return [program.SOURCE / "scripts/facets.sh", "--scene", "touch-liver", "--seeds", "2", "--fine-seeds", "1", "--seconds", str(SECONDS), "--jobs", "2",
                "-o", self.path("study"), *more]

    def run_script(self, *more):
        return subprocess.run(self.command(*more), check=False, capture_output=True, text=True, env={**os.environ, "CALOT_PROGRAM": str(program.PROGRAM)},
                              timeout=1800)

    def made(self):
        """{name: when it was written} of the attempts, which are all whole."""
        files = list(self.path("study").glob("attempts/*.json"))
        for file in files:
            self.assertTrue(json.loads(file.read_text())["figures"])
        return {file.stem: file.stat().st_mtime_ns for file in files}

    def finished(self, done):
        self.assertEqual(done.returncode, 0, done)
        self.assertNothingHalfWritten()
        self.assertEqual(list(self.path("study").rglob("*.h5")), [])
        made = self.made()
        self.assertEqual(len(made), 18)  # 2 seeds and profiles on four discretisations, and one on the finest
        return made

    def figures(self, name):
        return json.loads((self.path("study") / "attempts" / f"{name}.json").read_text())["figures"]

    def test_a_run_that_was_stopped_goes_on(self):
        with subprocess.Popen(self.command(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
                              env={**os.environ, "CALOT_PROGRAM": str(program.PROGRAM)}) as first:
            end = time.monotonic() + program.PATIENCE
            while len(list(self.path("study").glob("attempts/*.json"))) < 3 and time.monotonic() < end and first.poll() is None:
                time.sleep(0.02)
            os.killpg(first.pid, signal.SIGKILL)
        before = self.made()
        self.assertGreaterEqual(len(before), 3)
        whole = self.finished(self.run_script())
        self.assertEqual({name: whole[name] for name in before}, before, "what was there is not made again")

        # One that is gone, one cut short, one of another seed: made again, alike. All others stay.
        gone, cut, other = (f"touch-liver-{name}" for name in ("scene-skilled-1", "finer-unskilled-2", "beside-skilled-2"))
        alike = {name: self.figures(name) for name in (gone, cut, other)}
        file = self.path("study") / "attempts"
        (file / f"{gone}.json").unlink()
        (file / f"{cut}.json").write_bytes((file / f"{cut}.json").read_bytes()[:200])
        foreign = json.loads((file / f"{other}.json").read_text())
        foreign["of"]["seed"] = 7
        (file / f"{other}.json").write_text(json.dumps(foreign))
        again = self.finished(self.run_script())
        self.assertEqual({name for name in whole if again[name] != whole[name]}, {gone, cut, other})
        self.assertEqual({name: self.figures(name) for name in alike}, alike)

        said = json.loads((self.path("study") / "components.json").read_text())["all"]
        with (self.path("study") / "all.csv").open(encoding="utf-8", newline="") as table:
            rows = list(csv.DictReader(table))
        compared = 0
        for name, row in said.items():
            values = numpy.array([[[float(r[name] or "nan") for level in LEVELS for r in rows if (r["person"], r["discretisation"]) == (f"{p}-{s}", level)]
                                   for s in (1, 2)] for p in ("skilled", "unskilled")])
            if numpy.isnan(values).any() or values.std() < 1e-9 * abs(values.mean()):
                continue  # not at all levels, or rounding alone
            for part, expected in components(values).items():
                self.assertAlmostEqual(row[part] / values.var(), max(0.0, expected) / values.var(), delta=1e-9, msg=(name, part))
            compared += 1
        self.assertGreater(compared, 5)
        self.assertIn("path-length left", (self.path("study") / "facets.md").read_text())

    def test_words_that_are_no_options_are_refused(self):
        for words in (("--seeds", "1"), ("--seeds",), ("--sceen", "x"), ("--jobs", "0"), ("--seconds", "-1")):
            done = self.run_script(*words)
            self.assertEqual((done.returncode, done.stdout), (2, ""), done)
            self.assertTrue(done.stderr.startswith("usage: facets.sh"))
        self.assertFalse(self.path("study").exists())


if __name__ == "__main__":
    program.main()
