# SPDX-License-Identifier: GPL-3.0-or-later
"""calot assess --metric, calot import --metric: users' own metrics, and what becomes of scripts that fail."""

import hashlib
import json
import os
import pathlib
import time

import numpy
import program
from cohort_content import content, query
from program import calot, recording, short

GOOD = '''NAME = "mean-left-force"; VERSION = 1; UNIT = "N"; BETTER = "lower"
def compute(attempt):
    return float(attempt.results["left_force"].mean())
'''
HEAD = 'NAME = "mine"; VERSION = 1; UNIT = "N"; BETTER = "lower"\n'


def csv_motion(path):
    """Two hands for three seconds at 50 Hz; the left one along x at 0.1 m/s."""
    t = numpy.arange(150) / 50.0
    with open(path, "w", encoding="utf-8") as file:
        file.write("t,lx,ly,lz,rx,ry,rz\n")
        for s in t:
            file.write(f"{s:.3f},{100 * s:.6f},0,0,0,{10 * numpy.sin(s):.6f},0\n")
    columns = {"format": "calot-columns", "formatVersion": 1, "device": "tracker", "frame": "table", "length": "mm",
               "time": {"column": "t", "unit": "s"}, "left": {"position": ["lx", "ly", "lz"]}, "right": {"position": ["rx", "ry", "rz"]}}
    return columns


class Metric(program.ProgramTest):
    def script(self, text, name="my.py"):
        self.path(name).write_text(text, encoding="utf-8")
        return self.path(name)

    def assess(self, script, *more):
        return ("assess", short(), "--cohort", self.path("c.db"), "--metric", script, *more)

    def rows(self):
        return query(self.path("c.db"), "SELECT m.name, m.version, m.unit, m.direction, m.sha256, v.availability, v.value, v.reason FROM "
                                        "external_value v JOIN external_metric m ON m.id = v.metric ORDER BY m.name, m.version")

    def test_a_value_is_stored_once(self):
        script = self.script(GOOD)
        out = self.well(*self.assess(script)).out
        self.assertRegex(out, r"mean-left-force +\S+ +N +external")
        (row,) = self.rows()
        self.assertEqual(row[:6], ("mean-left-force", 1, "N", 1, hashlib.sha256(script.read_bytes()).hexdigest(), 0))
        before = content(self.path("c.db"))
        self.well(*self.assess(script))
        self.assertEqual(content(self.path("c.db")), before)
        # Without the script, too, it stays; regrading leaves it alone.
        self.well("assess", short(), "--cohort", self.path("c.db"))
        self.well("regrade", self.path("c.db"), short().parent)
        self.assertEqual(self.rows(), [row])
        said = json.loads(self.well(*self.assess(script), "--json").out)["recordings"][0]["checkpoints"][-1]
        self.assertEqual((said["name"], said["origin"], said["sha256"], said["value"]), ("mean-left-force", "external", row[4], row[6]))
        self.well("cohort", "export", self.path("c.db"), "-o", self.path("out"))
        book = json.loads((self.path("out") / "codebook.json").read_text(encoding="utf-8"))["variables"]
        (entry,) = [v for v in book if v["table"] == "checkpoint" and v["name"] == "mean-left-force"]
        self.assertEqual((entry["origins"], entry["unit"], entry["direction"]), ("external", "N", "lower"))
        self.assertTrue(all(v["title"] for v in book))
        self.well("cohort", "bundle", self.path("c.db"), "-o", self.path("bundle"), "--include-synthetic")
        self.assertIn("mean-left-force,,1,0,", (self.path("bundle") / "values.csv").read_text(encoding="utf-8"))

    def test_what_a_script_sees(self):
        import h5py
        script = self.script(HEAD + '''
import numpy as np
def compute(attempt):
    r, s, e = attempt.results, attempt.samples, attempt.events
    assert "participant" not in attempt.header and attempt.header["scene"] == "touch-liver"
    assert attempt.structures[0] == "liver" and r["organs_volume"].shape == (len(r["time"]), len(attempt.structures))
    assert len(s["time"]) == attempt.header["ticks_per_step"] * len(r["time"])
    assert abs(np.linalg.norm(s["left_orientation"], axis=1) - 1).max() < 1e-3 and e["kind"].dtype == np.int64
    assert not s["time"].flags.writeable and "vessels_clips" not in r
    assert np.array_equal(np.linalg.norm(r["left_contact_force"], axis=1) > 0, r["left_force"] > 0)
    return float(s["right_position"].sum() + r["left_tip_simulated"].sum())
''')
        self.well(*self.assess(script))
        with h5py.File(short(), "r") as file:
            end = file["/status"][-1]
            expected = file["/ticks/right/position"][:end["ticks"]].sum() + file["/observables/left/tip_simulated"][:end["steps"]].sum()
        self.assertAlmostEqual(self.rows()[0][6], expected, delta=1e-9 * abs(expected))

    def test_no_value_with_a_reason(self):
        for n, (given, reason) in enumerate((("None", "compute returned None"), ('float("nan")', "compute returned NaN"), ('(None, "no grasp")', "no grasp"))):
            self.well(*self.assess(self.script(f'NAME = "none-{n}"; VERSION = 1; UNIT = "1"; BETTER = "none"\ndef compute(a): return {given}\n')))
            self.assertEqual(self.rows()[n][5:], (2, None, reason))

    def test_scripts_that_fail(self):
        faults = (
            ("def compute(a): return 1 / 0\n", ("line 2", "ZeroDivisionError: division by zero")),
            ("def inner(x):\n    return x['no']\n\ndef compute(a):\n    return inner({})\n", ("line 3", "KeyError: no")),
            ("def compute(a): return a.results['left_fore']\n", ("line 2", "no 'left_fore'", "left_force")),
            ("def compute(a): return 'much'\n", ("returned a str", "a number, None")),
            ("def compute(a): return [1.0]\n", ("returned a list",)),
            ("def compute(a): return True\n", ("returned a bool",)),
            ("def compute(a): return float('inf')\n", ("infinity",)),
            ("def compute(a): raise SystemExit(0)\n", ("line 2", "SystemExit")),
            ("import os\ndef compute(a): os._exit(7)\n", ("without a result", "exit code 7")),
            ("import os, signal\ndef compute(a): os.kill(os.getpid(), signal.SIGSEGV)\n", ("signal 11",)),
            ("def compute(a):\n    while True: print('x' * 1000)\n", ("prints more than",)),
            ("def compute(a): return len(bytearray(1 << 33))\n", ("line 2", "512 MiB of memory")),
            ("import numpy\ndef compute(a): return numpy.ones(1 << 30).sum()\n", ("line 3", "512 MiB of memory")),
        )
        self.well("assess", short(), "--cohort", self.path("c.db"))
        before = content(self.path("c.db"))
        for text, names in faults:
            with self.subTest(text):
                answer = calot(*self.assess(self.script(HEAD + text), "--metric-memory", 512))
                self.assertEqual(answer.code, 4, answer)
                last = answer.err.splitlines()[-1]
                self.assertTrue(last.startswith("calot: ") and all(name in last for name in ("my.py", *names)), answer.err[-2000:])
                self.assertEqual(content(self.path("c.db")), before)

    def test_declarations_that_are_none(self):
        compute = "def compute(a): return 1.0\n"
        for text, names in (("VERSION = 1; UNIT = 'N'; BETTER = 'lower'\n" + compute, ("declares no NAME",)),
                            (HEAD.replace("mine", "path-length") + compute, ("path-length", "checkpoint of the program")),
                            (HEAD.replace("mine", "My Metric") + compute, ("NAME", "small letters")),
                            (HEAD.replace("VERSION = 1", "VERSION = 0") + compute, ("VERSION 0",)),
                            (HEAD.replace("VERSION = 1", "VERSION = '1'") + compute, ("VERSION is a str",)),
                            (HEAD.replace('"lower"', '"less"') + compute, ("BETTER", "lower, higher or none")),
                            (HEAD.replace('"N"', '""') + compute, ("UNIT",)),
                            (HEAD, ("no function compute",)),
                            (HEAD + "def compute(a):\n  return (\n", ("SyntaxError",)),
                            (HEAD + "import nowhere_at_all\n" + compute, ("line 2", "ModuleNotFoundError"))):
            with self.subTest(text):
                self.refused(4, *self.assess(self.script(text)), names=("my.py", *names))
                self.assertFalse(self.path("c.db").exists())
        self.refused(4, *self.assess(self.path("none.py")), names=("none.py",))
        good = self.script(GOOD)
        self.refused(2, *self.assess(good, "--metric", self.script(GOOD, "other.py")), names=("other.py", "mean-left-force"))
        self.refused(1, *self.assess(good), names=("CALOT_PYTHON",), environment={"CALOT_PYTHON": "/no/python"})

    def test_another_source_wants_another_version(self):
        self.well(*self.assess(self.script(GOOD)))
        before = content(self.path("c.db"))
        changed = GOOD.replace("mean()", "max()")
        self.refused(3, *self.assess(self.script(changed)), names=("my.py", "version 1", "raise VERSION"))
        self.assertEqual(content(self.path("c.db")), before)
        self.well(*self.assess(self.script(changed.replace("VERSION = 1", "VERSION = 2"))))
        self.assertEqual([row[1] for row in self.rows()], [1, 2])
        shown = json.loads(self.well(*self.assess(self.script(changed.replace("VERSION = 1", "VERSION = 2"))), "--json").out)["recordings"][0]["checkpoints"]
        self.assertEqual([(v["version"]) for v in shown if v["name"] == "mean-left-force"], [2])
        self.refused(3, *self.assess(self.script(GOOD)), names=("my.py", "version 2 already"))

    def test_a_value_that_is_another_each_time(self):
        script = self.script(HEAD + "import time\ndef compute(a): return time.time()\n")
        self.well(*self.assess(script))
        before = content(self.path("c.db"))
        answer = calot(*self.assess(script))
        self.assertEqual(answer.code, 3, answer)
        self.assertOneLine(answer, "my.py")
        self.assertEqual(content(self.path("c.db")), before)

    def test_it_is_ended_with_what_it_started(self):
        mark = f"calot-metric-{os.getpid()}"
        script = self.script(HEAD + f'''
import os, subprocess, sys, time
def compute(a):
    for leave in (False, True):
        if os.fork() == 0:
            if leave: os.setsid()
            os.execv(sys.executable, [sys.executable, "-c", "import time; time.sleep(600)", "{mark}"])
    time.sleep(600)
''')
        begun = time.monotonic()
        answer = calot(*self.assess(script, "--metric-seconds", 2))
        self.assertEqual(answer.code, 4, answer)
        # A superuser's script may start programs; anybody else's may not, and says so.
        self.assertTrue("2 s" in answer.err or "BlockingIOError" in answer.err, answer)
        self.assertLess(time.monotonic() - begun, 60)
        left = [p.name for p in pathlib.Path("/proc").iterdir() if p.name.isdigit() and mark.encode() in self.command_of(p)]
        self.assertEqual(left, [])

    @staticmethod
    def command_of(process):
        try:
            return (process / "cmdline").read_bytes() if process.name != str(os.getpid()) else b""
        except OSError:
            return b""

    def test_a_fork_that_returns_as_well(self):
        self.well(*self.assess(self.script(HEAD + "import os\ndef compute(a):\n    try:\n        os.fork()\n    except BlockingIOError:\n        pass\n    return 3\n")))
        self.assertEqual(self.rows()[0][6], 3.0)

    def test_of_motion_without_a_scene(self):
        motion = self.path("m.csv")
        self.path("columns.json").write_text(json.dumps(csv_motion(motion)), encoding="utf-8")
        script = self.script('''NAME = "left-way"; VERSION = 3; UNIT = "m"; BETTER = "lower"; TITLE = "Way of the left hand"
import numpy as np
def compute(attempt):
    assert attempt.header["source"] == "samples" and len(attempt.results) == 0
    return np.linalg.norm(np.diff(attempt.samples["left_position"], axis=0), axis=1).sum()
''')
        arguments = ("import", motion, "--columns", self.path("columns.json"), "--task", "reach", "--cohort", self.path("c.db"), "--metric", script)
        self.assertIn("external", self.well(*arguments).out)
        self.assertAlmostEqual(self.rows()[0][6], 0.298, places=9)
        before = content(self.path("c.db"))
        self.well(*arguments)
        self.assertEqual(content(self.path("c.db")), before)
        answer = calot(*arguments[:-1], self.script(GOOD))
        self.assertEqual(answer.code, 4, answer)
        self.assertOneLine(answer, "my.py", "line 3")

    def test_in_studies_norms_and_grades(self):
        runs = [recording(f"{who}-{seed}", "--performer", who, "--seed", seed, "--seconds", 1, "--mode", "assessment", "--purpose", "study")
                for who in ("skilled", "unskilled") for seed in (1, 2, 3, 4)]
        cohort, script = self.path("c.db"), self.script(
            'NAME = "left-x"; VERSION = 1; UNIT = "m"; BETTER = "lower"\ndef compute(a): return a.samples["left_position"][:, 0].std() * 1000\n')
        self.well("assess", *runs, "--cohort", cohort, "--metric", script)
        who = ("--group-by", "performer", "--include-synthetic")
        study = json.loads(self.well("study", cohort, *who, "--json").out)
        (row,) = [r for r in study["rows"] if r["checkpoint"] == "left-x"]
        sha = hashlib.sha256(script.read_bytes()).hexdigest()
        self.assertEqual((row["source_sha256"], row["origins"], row["unit"]), (sha, ["external"], "m"))
        text = self.well("study", cohort, *who, "--all").out
        self.assertIn("left-x (external)", text)
        self.assertIn(sha, text.replace("\n", ""))
        self.well("study", cohort, *who, "--csv", self.path("study"))
        head, *lines = (self.path("study") / "study.csv").read_text(encoding="utf-8").splitlines()
        self.assertTrue(head.endswith(",source_sha256"))
        self.assertEqual([line.split(",")[0] for line in lines if line.endswith("," + sha)], ["left-x"])
        # A protocol may name it, and its source.
        protocol = {"format": "calot-protocol", "formatVersion": 1, "name": "p", "version": 1, "title": "t", "operators": "performers",
                    "populations": [{"group": "skilled", "definition": "s"}, {"group": "unskilled", "definition": "u"}], "better": "skilled", "unit": "participant",
                    "attemptRule": "first", "exclusions": {"outcomes": [], "reasons": []}, "missing": "complete-cases", "level": 0.05,
                    "hypotheses": [{"external": "left-x", "sha256": sha, "larger": "unskilled", "primary": True}]}
        file = self.path("p.json")
        file.write_text(json.dumps(protocol), encoding="utf-8")
        (row,) = [r for r in json.loads(self.well("study", cohort, "--protocol", file, "--json").out)["rows"] if r["role"] == "primary"]
        self.assertEqual(row["checkpoint"], "left-x")
        protocol["hypotheses"][0]["sha256"] = "0" * 64
        file.write_text(json.dumps(protocol), encoding="utf-8")
        self.assertIn("No attempt has left-x of the script", " ".join(self.well("study", cohort, "--protocol", file).out.split()))
        protocol["hypotheses"][0] = {"external": "path-length", "larger": "skilled", "primary": True}
        file.write_text(json.dumps(protocol), encoding="utf-8")
        self.refused(4, "protocol", "check", file, names=("p.json", "/hypotheses/0/external"))
        # Norms and sheets.
        norm = self.well("norm", "create", cohort, "n", "--by", "test", *who, "--rule", "at-least:1", "--checkpoints", "all").out
        self.assertIn("left-x (external)", norm)
        attempt = query(cohort, "SELECT uuid FROM attempt LIMIT 1")[0][0]
        sheet = self.well("grade", cohort, "--attempt", attempt).out
        self.assertIn("left-x (external)", sheet)
        self.assertIn(sha, sheet.replace("\n", ""))
        self.refused(3, "norm", "create", cohort, "m", "--by", "test", *who, "--rule", "at-least:3", "--checkpoints", "left-x",
                     names=("3", "1"))


if __name__ == "__main__":
    program.main()
