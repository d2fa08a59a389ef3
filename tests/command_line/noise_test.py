# SPDX-License-Identifier: GPL-3.0-or-later
"""A tracker's rate and noise are no skill: a study of the same motion seen by two trackers."""

import importlib.util
import json
import subprocess
import sys
import unittest

import numpy
import program

SCRIPT = program.SOURCE / "scripts/motion_bias.py"
_spec = importlib.util.spec_from_file_location("motion_bias", SCRIPT)
bias = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(bias)


class OneMotionTwoTrackers(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.columns, self.cohort = self.path("columns.json"), self.path("c.db")
        bias.write_columns(self.columns)

    def add(self, group, rate, noise, held=0):
        for person in range(5):
            hands = [bias.Hand(numpy.random.default_rng([9, person, hand])) for hand in range(2)]
            file, name = self.path(f"{group}{person}.csv"), f"{group}{person}"
            bias.write(file, hands, rate, noise, numpy.random.default_rng([person, rate, ord(group[0])]), 30.0, held)
            self.well("participant", "add", name, "--cohort", self.cohort, "--group", group)
            self.well("import", file, "--columns", self.columns, "--cohort", self.cohort, "--task", "knots", "--participant", name,
                      "--mode", "assessment", "--outcome", "completed")

    def rows(self, *options):
        study = json.loads(self.well("study", self.cohort, "--json", *options).out)
        return study, {(row["checkpoint"], row["subject"]): row for row in study["rows"]}

    def test_rate_and_noise_of_unlike_trackers_give_no_difference(self):
        self.add("expert", 100, 0.2)
        self.add("novice", 30, 0.2, held=120)
        study, rows = self.rows()
        for (name, subject), row in rows.items():
            if subject in bias.HANDS:
                self.assertNotIn("p", row["mann_whitney"], name)
        idle = rows["idle-time", "right"]
        self.assertEqual(idle["groups"][1]["missing"], 5)
        self.assertGreater(idle["groups"][0]["n"], 2)
        sampling = {row["subject"]: row for row in study["coverage"]}["left"]
        for group, rate in enumerate((100.0, 30.0)):
            for value in sampling["rates_hz"][group]:
                self.assertAlmostEqual(value, rate, delta=0.1)
            for value in sampling["noises_m"][group]:
                self.assertAlmostEqual(value, 1.8e-4, delta=4e-5)
        self.assertIn("100.0 Hz", sampling["refusal"])
        # Compared all the same, as asked: the report warns.
        study, rows = self.rows("--mix-keys")
        self.assertIn("p", rows["path-length", "left"]["mann_whitney"])
        self.assertNotIn("p", rows["idle-time", "right"]["mann_whitney"])
        text = " ".join(self.well("study", self.cohort, "--mix-keys").out.split())
        self.assertIn("Warning: the trackers differ", text)

    def test_like_trackers_are_compared(self):
        self.add("expert", 60, 0.1)
        self.add("novice", 60, 0.1)
        study, rows = self.rows()
        self.assertIn("p", rows["idle-time", "left"]["mann_whitney"])
        self.assertEqual([row["refusal"] for row in study["coverage"]], [""] * len(study["coverage"]))

    @unittest.skipUnless(program.HEAVY, "in the heavy suites")
    def test_the_published_bias(self):
        page = program.SOURCE / "docs/reference/metrics/noise.md"
        done = subprocess.run([sys.executable, SCRIPT, program.PROGRAM, "--check", page], check=False)
        self.assertEqual(done.returncode, 0)


if __name__ == "__main__":
    program.main()
