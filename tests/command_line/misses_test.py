# SPDX-License-Identifier: GPL-3.0-or-later
"""A step that misses a tolerance is told of: in the recording, and by everything that reports on it."""

import json
import shutil
import unittest

import h5py
import numpy
import program
from program import calot

SOLVER, CONTACT = 1, 2


class Misses(program.ProgramTest):
    def setUp(self):
        super().setUp()
        # Three iterations are too few wherever tissue moves.
        scene = json.loads((program.SOURCE / f"assets/scenes/{program.SCENE}.json").read_text())
        scene["solver"] = {"iterations": 3}
        (self.folder / "scenes").mkdir()
        shutil.copytree(program.SOURCE / "assets/organs", self.folder / "organs")
        self.scene = self.folder / "scenes/hurried.json"
        self.scene.write_text(json.dumps(scene))
        self.recording = self.path("hurried.h5")
        self.said = self.well("record", "--scene", self.scene, "--performer", "skilled", "--seed", 7, "--seconds", 5, "-o",
                              self.recording)
        with h5py.File(self.recording, "r") as file:
            bits = file["/observables/misses"][:]
            events = file["/events"]["kind"][:]
        self.steps = len(bits)
        self.any = int(numpy.count_nonzero(bits))
        self.solver = int(numpy.count_nonzero(bits & SOLVER))
        self.contact = int(numpy.count_nonzero(bits & CONTACT))
        self.assertGreater(self.solver, 20, "the run must miss")
        self.assertGreaterEqual(numpy.count_nonzero(events == 7), self.solver, "an event for each")
        self.line = f"{self.any} of {self.steps} steps missed a tolerance (solver {self.solver}, contact {self.contact}, held back 0)"

    def test_everything_that_reports_tells(self):
        self.assertIn(self.line, self.said.out)
        self.assertIn(f"{self.recording}: {self.line}\n", self.well("replay", self.recording).out)
        counts = {"steps": self.any, "solver": self.solver, "contact": self.contact, "held_back": 0}
        self.assertEqual(json.loads(self.well("replay", "--json", self.recording).out)["recordings"][0]["missed_tolerance"], counts)
        inspected = json.loads(self.well("inspect", "--json", self.recording).out)
        self.assertEqual([inspected[f"steps_{k}"] for k in ("missed_tolerance", "missed_by_solver", "missed_by_contact", "held_back")],
                         [self.any, self.solver, self.contact, 0])

        cohort = self.path("c.db")
        assessed = json.loads(self.well("assess", "--json", self.recording, "--cohort", cohort).out)["recordings"][0]
        self.assertEqual(assessed["missed_tolerance"], counts)
        value = next(v for v in assessed["checkpoints"] if v["name"] == "steps-missed")
        self.assertAlmostEqual(value["value"], self.any / self.steps)
        self.assertEqual(value["note"], self.line)
        # So does a study of the cohort.
        other = self.path("other.h5")
        self.well("record", "--scene", self.scene, "--performer", "unskilled", "--seconds", 3, "-o", other)
        self.well("assess", other, "--cohort", cohort)
        calot("study", cohort, "--group-by", "performer", "--include-synthetic", "--include-practice", "--csv", self.path("csv"))
        self.assertIn("steps-missed", (self.path("csv") / "values.csv").read_text())

    def test_nothing_is_said_where_nothing_missed(self):
        quiet = self.path("quiet.h5")
        said = self.well("record", "--scene", program.SCENE, "--performer", "skilled", "--seconds", 0.2, "-o", quiet)
        self.assertNotIn("missed a tolerance", said.out + self.well("replay", quiet).out)
        self.assertEqual(json.loads(self.well("inspect", "--json", quiet).out)["steps_missed_tolerance"], 0)


if __name__ == "__main__":
    program.main()
