# SPDX-License-Identifier: GPL-3.0-or-later
"""The examples that write motion as a BIDS data set and attempts as xAPI statements: what is in them, what stays out, and what is refused.

With CALOT_VALIDATORS, a folder in which npm installed bids-validator and @learninglocker/xapi-validation, these judge them, too.
"""

import json
import os
import pathlib
import re
import sqlite3
import subprocess
import sys
from contextlib import closing

import course_test
import h5py
import program
from program import SOURCE, recording

VALIDATORS = os.environ.get("CALOT_VALIDATORS", "")
UUID = re.compile(r"[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}")


def performed(seed, profile="skilled"):
    return recording(f"{profile}{seed}", "--performer", profile, "--seed", seed, "--seconds", 2, "--mode", "assessment")


def example(name, *arguments):
    """Runs a script of python/examples; its whole answer."""
    return subprocess.run([sys.executable, "-B", SOURCE / "python/examples" / name, *map(str, arguments)], capture_output=True, text=True, check=False)


class ExampleTest(program.ProgramTest):
    def done(self, name, *arguments):
        answer = example(name, *arguments)
        self.assertEqual((answer.returncode, answer.stderr), (0, ""), answer)
        return answer.stdout

    def fails(self, name, *arguments, names=()):
        answer = example(name, *arguments)
        self.assertEqual((answer.returncode, answer.stderr.count("\n")), (1, 1), answer)
        for part in names:
            self.assertIn(part, answer.stderr)


def table(path):
    return [line.split("\t") for line in path.read_text(encoding="utf-8").splitlines()]


class Bids(ExampleTest):
    def test_a_data_set_of_three_attempts(self):
        out = self.path("bids")
        self.done("bids_dataset.py", out, performed(1), performed(2), performed(3, "unskilled"))
        self.assertEqual(sum(p.is_file() for p in out.rglob("*")), 3 * 4 + 4)
        stem = "task-touchliver_tracksys-performer_run"
        for who, run in (("skilled", 1), ("skilled", 2), ("unskilled", 1)):
            base = out / f"sub-{who}/motion/sub-{who}_{stem}-{run}"
            about = json.loads(pathlib.Path(f"{base}_motion.json").read_text())
            self.assertEqual((about["TaskName"], about["SamplingFrequency"]), ("touch-liver", 100.0))
            channels, rows = table(pathlib.Path(f"{base}_channels.tsv")), table(pathlib.Path(f"{base}_motion.tsv"))
            self.assertEqual(channels[0][:5], ["name", "component", "type", "tracked_point", "units"])
            self.assertEqual(about["MotionChannelCount"], len(channels) - 1)
            self.assertEqual(about["POSChannelCount"] % 3, 0)
            self.assertEqual(len(rows), 200, "two seconds at 100 Hz")
            for row in rows:
                self.assertEqual(len(row), len(channels) - 1)
                self.assertTrue(all(cell == "n/a" or abs(float(cell)) < 10 for cell in row), row)
        self.assertEqual(table(out / "participants.tsv"),
                         [["participant_id", "synthetic"], ["sub-skilled", "yes"], ["sub-unskilled", "yes"]])
        self.assertEqual(json.loads((out / "dataset_description.json").read_text())["BIDSVersion"], "1.9.0")
        self.assertNotIn("202", "".join(p.read_text() for p in out.rglob("*.json")).replace("0.2", ""), "no dates")
        if VALIDATORS:
            done = subprocess.run([f"{VALIDATORS}/node_modules/.bin/bids-validator", str(out), "--json"], capture_output=True, text=True, check=False)
            errors = json.loads(done.stdout)["issues"]["errors"]
            self.assertEqual([e["key"] for e in errors], [], done.stdout)

    def test_positions_are_those_of_the_recording(self):
        out = self.path("bids")
        self.done("bids_dataset.py", out, performed(1))
        channels = [c[0] for c in table(next(out.rglob("*_channels.tsv")))[1:]]
        rows = table(next(out.rglob("*_motion.tsv")))
        with h5py.File(performed(1)) as file:
            for hand in ("left", "right"):
                ticks = file[f"ticks/{hand}"]
                columns = [channels.index(f"{hand}_{axis}") for axis in "xyz"]
                for k, row in enumerate(rows):
                    self.assertEqual([float(row[c]) for c in columns], list(ticks["position"][10 * k]) if "position" in ticks else None)

    def test_what_is_refused(self):
        out = self.path("bids")
        self.fails("bids_dataset.py", self.path("no/where"), performed(1), names=("where",))
        self.path("there").mkdir()
        self.fails("bids_dataset.py", self.path("there"), performed(1), names=("there",))
        broken = self.copy(performed(1), "broken.h5")
        broken.write_bytes(performed(1).read_bytes()[:5000])
        self.fails("bids_dataset.py", out, performed(1), broken, names=("broken.h5",))
        self.assertFalse(out.exists())


class StatementTest(ExampleTest):
    def judged_valid(self):
        if VALIDATORS:
            script = ("const v = require('@learninglocker/xapi-validation'); const list = JSON.parse(require('fs').readFileSync(process.argv[1]));"
                      "const check = v.default; let n = 0;"
                      "for (const s of list) { const w = check(s); n += w.length; for (const one of w) console.error(String(one)); }"
                      "process.exit(n === 0 ? 0 : 1);")
            done = subprocess.run(["node", "-e", script, str(self.file)], cwd=VALIDATORS, capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""))


class Xapi(StatementTest):
    def setUp(self):
        super().setUp()
        self.cohort = self.path("c.db")
        self.well("assess", performed(1), performed(3, "unskilled"), "--cohort", self.cohort)
        self.file = self.path("s.json")

    def test_statements(self):
        home = "https://training.example.org"
        ask = ("xapi_statements.py", self.cohort, home + "/", self.file)
        self.fails(*ask, names=("c.db", "synthetic"))
        self.done(*ask, "--include-synthetic")
        statements = json.loads(self.file.read_text())
        self.assertEqual(len(statements), 2)
        with closing(sqlite3.connect(self.cohort)) as database:
            values = dict(database.execute("SELECT a.uuid, count(*) FROM checkpoint_value v JOIN attempt a ON a.id = v.attempt GROUP BY 1"))
            noted = database.execute("SELECT count(*) FROM export WHERE kind = 'xapi'").fetchone()
        self.assertEqual(noted, (1,))
        for s in statements:
            self.assertRegex(s["id"], UUID)
            self.assertEqual(s["actor"]["account"]["homePage"], home)
            self.assertIn(s["actor"]["account"]["name"], ("skilled", "unskilled"))
            self.assertEqual(s["object"]["id"], f"{home}/scenes/touch-liver/{s['object']['id'].rsplit('/', 1)[1]}")
            self.assertEqual(s["result"]["duration"], "PT2.00S")
            self.assertIs(s["result"]["completion"], s["verb"]["id"].endswith("completed"))
            self.assertEqual(len(s["result"]["extensions"][home + "/extensions/checkpoints"]), values[s["id"]])
            about = s["context"]["extensions"][home + "/extensions/attempt"]
            self.assertEqual((about["verification"], about["synthetic"]), ("verified", True))
        self.judged_valid()

    def test_what_is_refused(self):
        for home in ("", "training", "ftp://a.b", "https://", "https://a b"):
            self.fails("xapi_statements.py", self.cohort, home, self.file, "--include-synthetic", names=("home page",))
        self.file.write_text("kept")
        self.fails("xapi_statements.py", self.cohort, "https://a.example", self.file, "--include-synthetic", names=(str(self.file),))
        self.assertEqual(self.file.read_text(), "kept")


class XapiOfACourse(course_test.Trainees, StatementTest):
    def test_passed_failed_and_mastered(self):
        for day, reach in ((5, course_test.BAD), (6, course_test.GOOD), (7, course_test.GOOD)):
            self.attempt("T1", "trainee", "reaching", reach, f"2026-01-{day:02}")
        self.store()
        home, progress = "https://training.example.org", self.path("progress.json")
        progress.write_text(self.well("course", self.cohort, "--course", self.course(groups=["trainee"]), "--json").out)
        self.file = self.path("s.json")
        ask = ("xapi_statements.py", self.cohort, home)
        self.done(*ask, self.file, "--course", progress)
        statements = json.loads(self.file.read_text())
        own = {s["id"]: s for s in statements if "statement" not in s["context"]}
        course = [s for s in statements if "statement" in s["context"]]
        self.assertEqual(len({s["id"] for s in statements}), len(statements))
        self.assertEqual([s["verb"]["display"]["en"] for s in course], ["failed", "passed", "passed", "mastered"])
        self.assertEqual([s["result"]["success"] for s in course], [False, True, True, True])
        for s in course:
            attempt = own[s["context"]["statement"]["id"]]
            self.assertEqual((s["actor"], s["timestamp"]), (attempt["actor"], attempt["timestamp"]))
            self.assertEqual(s["actor"]["account"]["name"], "T1")
            self.assertEqual(s["object"]["id"], home + "/courses/c/tasks/reaching")
            self.assertEqual(s["context"]["contextActivities"]["parent"][0]["id"], home + "/courses/c")
            self.assertTrue(s["verb"]["id"].endswith("/" + s["verb"]["display"]["en"]))
            criterion = s["result"]["extensions"][home + "/extensions/criterion"]
            self.assertEqual((criterion["norm"], criterion["failure"] is None), ("reaching 1", s["result"]["success"]))
        self.judged_valid()
        # The same ids again, and none of attempts that stay out.
        self.well("attempt", "exclude", course[0]["context"]["statement"]["id"], "--cohort", self.cohort, "--reason", "x", "--by", "me")
        again = self.path("again.json")
        self.done(*ask, again, "--course", progress)
        self.assertEqual([s["id"] for s in json.loads(again.read_text()) if "statement" in s["context"]], [s["id"] for s in course[1:]])

    def test_what_is_refused(self):
        self.store()
        for text in ("", "[]", '{"schema": "calot-grade", "version": 1}'):
            self.path("p.json").write_text(text)
            self.fails("xapi_statements.py", self.cohort, "https://a.example", self.path("s.json"), "--course", self.path("p.json"),
                       names=("p.json",))
        self.fails("xapi_statements.py", self.cohort, "https://a.example", self.path("s.json"), "--course")
        self.assertFalse(self.path("s.json").exists())


if __name__ == "__main__":
    program.main()
