# SPDX-License-Identifier: GPL-3.0-or-later
"""Checkpoints and cohorts in Python against the command line's."""

import json
import sqlite3
import sys
import warnings
from contextlib import closing

import calot
import h5py
import numpy as np
import program
import recording_file
from program import recording


def attempts():
    return [recording(f"{who}-{seed}", "--performer", who, "--seed", seed, "--seconds", 2, "--mode", "assessment", "--purpose", "study",
                      "--participant", f"{who[0].upper()}{seed}")
            for who in ("skilled", "unskilled") for seed in (1, 2)]


class Assess(program.ProgramTest):
    def same(self, value, row):
        self.assertEqual((value.name, value.subject, value.version, value.unit, value.origin, value.filter),
                         tuple(row[k] for k in ("name", "subject", "version", "unit", "origin", "filter")))
        self.assertEqual(value.value, row["value"], value)
        self.assertEqual(value.availability, row.get("missing", "value"))
        self.assertEqual((value.reason, value.note, value.coverage), (row.get("reason", ""), row.get("note", ""), row.get("coverage")))

    def test_values_are_the_command_lines(self):
        for file in attempts()[:2]:
            for cutoff in (6, 10):
                said = json.loads(self.well("assess", "--json", "--cutoff", cutoff, file).out)["recordings"][0]
                assessed = calot.assess(file, cutoff=cutoff)
                self.assertEqual(len(assessed), len(said["checkpoints"]))
                self.assertGreater(sum(v.value is not None for v in assessed), 40)
                for value, row in zip(assessed, said["checkpoints"]):
                    self.same(value, row)
                self.assertEqual({k: assessed.report[k] for k in ("verdict", "steps", "attempt")}, {k: said[k] for k in ("verdict", "steps", "attempt")})

    def test_one_value(self):
        assessed = calot.assess(attempts()[0])
        self.assertGreater(assessed.value("path-length", "left").value, 0.0)
        with self.assertRaisesRegex(calot.InvalidError, "'left', 'right'"):
            assessed.value("path-length")
        with self.assertRaisesRegex(calot.InvalidError, "calot.checkpoints"):
            assessed.value("grace")
        self.assertEqual({v.name for v in assessed} - {c["name"] for c in calot.checkpoints()}, set())
        for wrong in (dict(cutoff=5.0), dict(cutoff=10.0, cohort=self.path("c.db"))):
            with self.assertRaises(calot.InvalidError):
                calot.assess(attempts()[0], **wrong)
        self.assertFalse(self.path("c.db").exists())

    def test_of_another_simulation_version(self):
        other = self.copy(attempts()[0])
        recording_file.set_attribute(other, "simulation_version", 999)
        with h5py.File(other, "r+") as file:
            recording_file.reseal(file)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            assessed = calot.assess(other)
        self.assertIn("999", str(caught[0].message))
        self.assertEqual({v.origin for v in assessed if v.value is not None}, {"observables", "samples"})


class Cohorts(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort = self.path("c.db")
        self.well("assess", *attempts()[:3], "--cohort", self.cohort)
        calot.assess(attempts()[3], cohort=self.cohort)
        self.well("participant", "set", "S1", "--group", "expert", "--experience", "laparoscopies=500", "--cohort", self.cohort)

    def test_tables(self):
        with closing(sqlite3.connect(self.cohort)) as database:
            stored = database.execute("SELECT a.uuid, v.name, v.subject, v.value FROM checkpoint_value v JOIN attempt a ON a.id = v.attempt").fetchall()
        cohort = calot.Cohort(self.cohort)
        table = cohort.values(frame=False, analysed=False)
        rows = list(zip(table["attempt"], table["name"], table["subject"], table["value"]))
        self.assertEqual(len(rows), len(stored))
        self.assertEqual({r for r in rows if r[3] == r[3]}, {r for r in stored if r[3] is not None})
        whose = dict(zip(table["attempt"], table["participant"]))
        self.assertEqual(sorted(whose.values()), ["S1", "S2", "U1", "U2"])
        attempts = cohort.attempts(frame=False, analysed=False)
        self.assertEqual(set(attempts["verdict"]), {"verified"})
        self.assertEqual(dict(zip(attempts["participant"], attempts["group"]))["S1"], "expert")
        people = cohort.participants(frame=False)
        self.assertEqual(dict(zip(people["participant"], people["experience"]))["S1"], {"laparoscopies": "500"})

    def test_frames(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        cohort = calot.Cohort(self.cohort)
        frame = cohort.values(name="path-length", analysed=False)
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual(len(frame), 8)
        wide = frame.pivot(index="attempt", columns="subject", values="value")
        self.assertEqual((wide.shape, wide.dtypes["left"]), ((4, 2), np.dtype(float)))
        self.assertEqual(list(cohort.attempts(analysed=False).profile), list(cohort.attempts(frame=False, analysed=False)["profile"]))

    def test_without_pandas(self):
        kept = {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] == "pandas"}
        sys.modules["pandas"] = None
        try:
            with self.assertRaisesRegex(ImportError, "python3-pandas.*frame=False"):
                calot.Cohort(self.cohort).values()
        finally:
            del sys.modules["pandas"]
            sys.modules.update(kept)

    def test_what_is_excluded_stays_out(self):
        cohort = calot.Cohort(self.cohort)
        made = {"frame": False, "include": ("synthetic", "practice")}
        self.assertEqual(len(cohort.attempts(frame=False)["attempt"]), 0, "performers' practice")
        first, second = cohort.attempts(**made)["attempt"][:2]
        self.well("attempt", "exclude", first, "--reason", "test", "--by", "me", "--cohort", self.cohort)
        self.assertEqual(len(cohort.attempts(**made)["attempt"]), 3)
        self.assertEqual(len(cohort.attempts(frame=False, analysed=False)["attempt"]), 4)
        self.assertNotIn(first, cohort.values(**made)["attempt"])
        self.assertIn(first, cohort.values(frame=False, analysed=False)["attempt"])
        self.assertIn(second, cohort.values(**made)["attempt"])
        with self.assertRaises(calot.InvalidError):
            cohort.attempts(include=("novices",))

    def test_what_is_no_cohort(self):
        for file in (self.path("none.db"), attempts()[0]):
            said = self.refused(4, "study", file)
            with self.assertRaises(calot.DamagedError) as caught:
                calot.Cohort(file)
            self.assertEqual(f"calot: {caught.exception}\n", said.err)
        with self.assertRaisesRegex(calot.InvalidError, "grace"):
            calot.Cohort(self.cohort).values(name="grace")


if __name__ == "__main__":
    program.main()
