# SPDX-License-Identifier: GPL-3.0-or-later
"""The analysis set: a study, the views, the export, the data frame and the recipes take the same people, attempts and values."""

import csv
import json
import re
import sqlite3
import subprocess
import sys
from contextlib import closing

import calot
import manifest_test
import program
from program import SOURCE


def recipe():
    """The query of the mixed model in R (docs/how-to/reading-results.md)."""
    page = (SOURCE / "docs/how-to/reading-results.md").read_text(encoding="utf-8")
    return re.search(r'```R\n.*?dbGetQuery\(db, "(.*?)"\)', page, re.DOTALL).group(1)


class AnalysisSet(manifest_test.Manifest):
    """Ten people with two attempts each, of whom six are analysed with ten of one key; the others stay out for a reason each."""

    def setUp(self):
        super().setUp()
        rows = [{**r, "consent": "study:2026-01-01"} for r in self.make(10, 2)]
        for row in rows:
            if row["participant"] == "P6":
                row["consent"] = "teaching:2026-01-01"
            if row["participant"] == "P7":
                row["purpose"] = "training"  # what a withdrawal from research leaves
            if row["participant"] == "P8":
                row["group"] = ""
            if row["participant"] == "P9":
                row["mode"] = "practice"
        rows[0]["task"] = "knots"  # another comparability key
        self.write(rows)
        self.well("import", "--manifest", self.table, "--cohort", self.cohort)
        self.well("participant", "withdraw", "P7", "--scope", "research", "--assessments", "keep", "--no-recordings", "--cohort", self.cohort)
        excluded = self.query("SELECT a.uuid FROM attempt a JOIN participant p ON p.id = a.participant WHERE pseudonym = 'P5' ORDER BY start_utc")
        for (uuid,) in excluded[1:]:
            self.well("attempt", "exclude", uuid, "--reason", "fire alarm", "--by", "test", "--cohort", self.cohort)
        (self.key,), = self.query("SELECT DISTINCT comparability_key FROM attempt WHERE scene = 'reaching' AND mode = 1")
        self.set = {(who, start) for who, start in self.query(
            "SELECT p.pseudonym, a.start_utc FROM attempt a JOIN participant p ON p.id = a.participant "
            "WHERE p.pseudonym IN ('P0', 'P1', 'P2', 'P3', 'P4', 'P5') AND a.scene = 'reaching'")} - {("P5", "2026-01-02T09:05:00Z")}

    def query(self, sql, *cells):
        with closing(sqlite3.connect(f"file:{self.cohort}?mode=ro", uri=True)) as database:
            return database.execute(sql, cells).fetchall()

    def rows(self, name):
        with open(self.path(name), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_all_are_equal(self):
        self.refused(3, "study", self.cohort, "--attempt-rule", "mean", names=("2 comparability keys",))
        self.well("study", self.cohort, "--key", self.key, "--attempt-rule", "mean", "--csv", self.path("study"))
        self.well("cohort", "export", self.cohort, "-o", self.path("tables"))
        frame = calot.Cohort(self.cohort).attempts(frame=False, key=self.key)
        self.assertEqual(len(self.set), 10)
        self.assertEqual({(r["participant"], r["start"]) for r in self.rows("study/attempts.csv")}, self.set)
        self.assertEqual({(r["participant"], r["start_utc"]) for r in self.rows("tables/analysis_attempt.csv") if r["comparability_key"] == self.key}, self.set)
        self.assertEqual(set(zip(frame["participant"].tolist(), frame["start_utc"].tolist())), self.set)
        self.assertEqual(set(self.query("SELECT participant, start_utc FROM analysis_attempt WHERE comparability_key = ?", self.key)), self.set)
        flow = {r["stage"]: int(r["attempts"]) for r in self.rows("study/flow.csv")}
        self.assertEqual({stage.removeprefix("left out: "): count for stage, count in flow.items() if stage.startswith("left out")},
                         {"withdrawn from research": 2, "no consent to research": 2, "excluded by hand: fire alarm (test)": 1, "practice": 2,
                          "no group": 2, "not comparable (another key)": 1})

        # Values: one of each person in the study, their mean in the others.
        study = {(r["checkpoint"], r["subject"], r["participant"]): float(r["value"]) for r in self.rows("study/values.csv")}
        view, exported, framed = {}, {}, {}
        for name, subject, who, value in self.query(
                "SELECT name, subject, participant, value FROM analysis_value WHERE comparability_key = ? AND value IS NOT NULL AND of_phase = 0", self.key):
            view.setdefault((name, subject, who), []).append(value)
        for r in self.rows("tables/analysis_value.csv"):
            if r["comparability_key"] == self.key and r["value"] != "" and r["of_phase"] == "0":
                exported.setdefault((r["name"], r["subject"], r["participant"]), []).append(float(r["value"]))
        table = calot.Cohort(self.cohort).values(frame=False, key=self.key)
        for name, subject, who, value in zip(*(table[c].tolist() for c in ("name", "subject", "participant", "value"))):
            if value == value and value is not None:
                framed.setdefault((name, subject, who), []).append(value)
        self.assertGreater(len(view), 100)
        self.assertEqual({k: sorted(v) for k, v in exported.items()}, {k: sorted(v) for k, v in view.items()})
        self.assertEqual({k: sorted(v) for k, v in framed.items()}, {k: sorted(v) for k, v in view.items()})
        self.assertEqual(set(study), set(view))
        factor = {}
        for of, values in view.items():
            mean = sum(values) / len(values)
            if mean != 0.0:
                factor.setdefault(of[0], []).append(study[of] / mean)
            else:
                self.assertEqual(study[of], 0.0)
        for name, ratios in factor.items():  # to the unit that a study shows
            self.assertLess(max(ratios) - min(ratios), 1e-9 * max(ratios), name)

    def test_several_keys_are_refused_by_all(self):
        cohort = calot.Cohort(self.cohort)
        with self.assertRaisesRegex(calot.RefusedError, "2 comparability keys"):
            cohort.values(frame=False)
        self.assertEqual(len(set(cohort.values(frame=False, mix_keys=True)["attempt"])), 11)
        self.assertEqual(len(cohort.attempts(frame=False, include=("practice",))["attempt"]), 13)

    def test_the_recipe_of_a_mixed_model(self):
        rows = [r for r in self.query(recipe()) if r[3] == self.key]
        said = json.loads(self.well("study", self.cohort, "--key", self.key, "--design", "repeated", "--family", "path-length right", "--json").out)
        result = said["results"][0]
        self.assertEqual((len({r[0] for r in rows}), len(rows)), (said["participants"], result["attempts"]))
        stored = self.query("SELECT participant, study_group, site, comparability_key, trial, value FROM analysis_value "
                            "WHERE name = 'path-length' AND subject = 'right' AND comparability_key = ?", self.key)
        self.assertEqual(sorted(rows), sorted(stored))

    def test_phases_are_told_by_their_names(self):
        names = {c["name"] for c in calot.checkpoints()}
        self.assertEqual(set(calot._calot.phase_checkpoints()), {n for n in names if n.startswith("phase-") and n != "phase-duration"})


class Motion(program.ProgramTest):
    def test_a_data_set_of_those_who_are_analysed(self):
        """BIDS: of three recordings with a participant one is in the analysis set."""
        generator = program.seeded("analysis set")
        cohort, out = self.path("c.db"), self.path("bids")
        files = []
        for who, mode in (("P1", "assessment"), ("P2", "practice"), ("P3", "assessment")):
            self.path("m.txt").write_text(manifest_test.motion(generator, 0.001))
            files.append(self.path(f"{who}.h5"))
            self.well("record", "--scene", "touch-liver", "--kinematics", self.path("m.txt"), "--participant", who, "--mode", mode, "--seconds", 1,
                      "-o", files[-1])
        self.well("assess", *files, "--cohort", cohort)
        for who in ("P1", "P2", "P3"):
            self.well("participant", "set", who, "--group", "expert", "--cohort", cohort)
        self.well("participant", "set", "P1", "--consent", "study:2026-01-01", "--cohort", cohort)
        self.well("participant", "set", "P2", "--consent", "study:2026-01-01", "--cohort", cohort)
        done = subprocess.run([sys.executable, "-B", SOURCE / "python/examples/bids_dataset.py", out, "--cohort", cohort, *files],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(p.name for p in out.iterdir() if p.is_dir()), ["sub-P1"])
        with closing(sqlite3.connect(cohort)) as database:
            self.assertEqual(database.execute("SELECT kind, count(*) FROM export JOIN export_attempt ON export = id").fetchall(), [("bids", 1)])


if __name__ == "__main__":
    program.main()
