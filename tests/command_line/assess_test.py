# SPDX-License-Identifier: GPL-3.0-or-later
"""calot assess, study, participant: what comes into a cohort database, and what does not."""

import csv
import json
import sqlite3
from contextlib import closing

import h5py
import program
import recording_file
from cohort_content import content, edited, query
from program import calot, recording


def attempts():
    """Two of each profile, as a study takes them."""
    return [recording(f"{who}-{seed}", "--performer", who, "--seed", seed, "--seconds", 2, "--mode", "assessment", "--purpose", "study")
            for who in ("skilled", "unskilled") for seed in (1, 2)]


class Assess(program.ProgramTest):
    def test_twice_is_once(self):
        cohort = self.path("c.db")
        rows = json.loads(self.well("assess", "--json", *attempts(), "--cohort", cohort).out)["recordings"]
        self.assertEqual([r["stored"] for r in rows], ["added"] * 4)
        before = content(cohort)
        self.assertEqual(len(before["attempt"]), 4)
        self.assertGreater(len(before["checkpoint_value"]), 40)
        rows = json.loads(self.well("assess", "--json", *reversed(attempts()), "--cohort", cohort).out)["recordings"]
        self.assertEqual([r["stored"] for r in rows], ["unchanged"] * 4)
        self.assertEqual(content(cohort), before)

    def test_same_values_at_every_thread_count(self):
        contents = []
        for threads in (1, 2):
            cohort = self.path(f"{threads}.db")
            self.well("assess", *attempts()[:2], "--threads", threads, "--cohort", cohort)
            contents.append(content(cohort))
        self.assertEqual(*contents)

    def test_uncertainty_is_stored_once(self):
        cohort = self.path("c.db")
        r = program.skilled()
        rows = json.loads(self.well("assess", "--json", "--uncertainty", r, "--cohort", cohort).out)["recordings"]
        values = {(c["name"], c["subject"]): c for c in rows[0]["checkpoints"] if c["value"] is not None}
        for value in values.values():
            interval = value["interval"]
            self.assertLessEqual(interval["lower"], value["value"], value)
            self.assertLessEqual(value["value"], interval["upper"], value)
        path, force = values["path-length", "left"]["interval"], values["force-mean", "right"]["interval"]
        self.assertEqual(path["lower"], path["upper"], "hands move alike in every simulation")
        self.assertLess(force["lower"], force["upper"])
        self.assertGreater(force["constants_spread"], 0.0)
        self.assertNotEqual(force["step_effect"], 0.0)
        self.assertNotEqual(force["mesh_effect"], 0.0)
        before = content(cohort)
        again = json.loads(self.well("assess", "--json", "--uncertainty", r, "--cohort", cohort).out)["recordings"]
        self.assertEqual(again[0]["checkpoints"], rows[0]["checkpoints"])
        self.assertEqual(content(cohort), before)
        fresh = self.path("threads.db")
        one = json.loads(self.well("assess", "--json", "--uncertainty", "--threads", 1, r, "--cohort", fresh).out)["recordings"]
        self.assertEqual(one[0]["checkpoints"], rows[0]["checkpoints"], "at every thread count")

    def test_uncertainty_wants_a_cohort(self):
        answer = calot("assess", "--uncertainty", "--cutoff", 6, attempts()[0])
        self.assertEqual(answer.code, 2, answer)
        self.assertIn("--cohort", answer.err)

    def test_values_are_those_of_the_observables(self):
        # Trajectory and duration, computed anew from what the recording says of itself.
        cohort = self.path("c.db")
        r = attempts()[0]
        self.well("assess", r, "--cohort", cohort)
        values = {(name, subject): (value, origin) for name, subject, value, origin in query(
            cohort, "SELECT name, subject, value, origin FROM checkpoint_value")}
        with h5py.File(r, "r") as file:
            self.assertEqual(values["attempt-duration", ""], (file["/steps/lateness"].shape[0] * 0.01, 0))
            liver = list(file["/scene/organs"]).index(b"liver")
            forces = [file[f"/observables/{hand}/organ_force"][:, liver] for hand in ("left", "right")]
        touching = [(f > 0).sum() * 0.01 for f in forces]
        self.assertLessEqual(values["contact-time-union", "liver"][0], values["contact-time-sum", "liver"][0])
        self.assertLessEqual(values["contact-time-sum", "liver"][0], sum(touching) + 1e-9)

    def test_diverged_is_kept_without_values_and_damaged_is_not(self):
        cohort = self.path("c.db")
        diverged, damaged = self.copy(attempts()[0], "diverged.h5"), self.copy(attempts()[1], "damaged.h5")
        with h5py.File(diverged, "r+") as file:
            file["/ticks/left/position"][109, 1] += 1e-4
            recording_file.reseal(file)
        recording_file.flip_stored_byte(damaged, "/ticks/left/force", 0)
        answer = calot("assess", "--json", diverged, damaged, attempts()[2], "--cohort", cohort)
        self.assertEqual(answer.code, 4, answer)
        self.assertEqual([r["stored"] for r in json.loads(answer.out)["recordings"]], ["added", "not stored", "added"])
        self.assertEqual(query(cohort, "SELECT file_name, verdict FROM recording JOIN verification USING (attempt) ORDER BY 1"),
                         [("diverged.h5", 1), (attempts()[2].name, 0)])
        self.assertEqual(query(cohort, "SELECT count(*) FROM checkpoint_value JOIN recording USING (attempt) "
                                       "WHERE file_name = 'diverged.h5' AND value IS NOT NULL"), [(0,)])
        self.assertIn("step 10", query(cohort, "SELECT detail FROM verification WHERE verdict = 1")[0][0])

    def test_two_files_that_claim_to_be_one_attempt(self):
        cohort = self.path("c.db")
        changed = self.copy(attempts()[0], "changed.h5")
        with h5py.File(changed, "r+") as file:
            file["/ticks/left/position"][109, 1] += 1e-4
            recording_file.reseal(file)
        self.well("assess", attempts()[0], "--cohort", cohort)
        before = content(cohort)
        answer = calot("assess", changed, attempts()[1], "--cohort", cohort)
        self.assertEqual(answer.code, 3, answer)
        self.assertOneLine(answer, changed)
        after = content(cohort)
        self.assertEqual(len(after["attempt"]), 2)  # the other file was taken in all the same
        self.assertTrue(set(before["checkpoint_value"]) <= set(after["checkpoint_value"]))

    def test_other_version_is_kept_as_not_checkable(self):
        cohort = self.path("c.db")
        r = self.copy(attempts()[0])
        recording_file.set_attribute(r, "simulation_version", 999)
        self.refused(5, "assess", r, "--cohort", cohort, names=(r, "999"))
        self.assertEqual(query(cohort, "SELECT verdict FROM verification"), [(3,)])
        self.assertEqual(query(cohort, "SELECT count(*) FROM checkpoint_value WHERE value IS NOT NULL AND origin = 0"), [(0,)])


class Study(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort = self.path("c.db")
        self.well("assess", *attempts(), "--cohort", self.cohort)

    def test_two_groups_side_by_side(self):
        table = self.well("study", self.cohort, "--group-by", "performer", "--include-synthetic", "--all").out
        for word in ("skilled against unskilled", "exploratory", "median", "mean", "no p", "SYNTHETIC"):
            self.assertIn(word, table)
        said = json.loads(self.well("study", self.cohort, "--group-by", "performer", "--include-synthetic", "--json").out)
        self.assertEqual((said["groups"], said["attempts"], said["synthetic"]), (["skilled", "unskilled"], [2, 2], True))
        duration = next(r for r in said["rows"] if r["checkpoint"] == "attempt-duration")
        self.assertEqual([(g["n"], g["mean"], g["median"]) for g in duration["groups"]], [(2, 2.0, 2.0)] * 2)

    def test_performers_stay_out_unless_asked_for(self):
        self.refused(3, "study", self.cohort, "--group-by", "performer", names=(self.cohort, "synthetic"))

    def test_csv(self):
        folder = self.path("csv")
        study = ("study", self.cohort, "--group-by", "performer", "--include-synthetic", "--csv", folder)
        self.well(*study)
        self.assertEqual(sorted(p.name for p in folder.iterdir()), ["attempts.csv", "coverage.csv", "flow.csv", "study.csv", "values.csv"])
        for file in folder.iterdir():
            rows = list(csv.reader(line for line in file.read_text().splitlines() if not line.startswith("#")))
            self.assertGreater(len(rows), 1)
            self.assertEqual({len(row) for row in rows}, {len(rows[0])}, file)
        self.refused(2, *study, names=(folder, "--force"))
        self.well(*study, "--force")

    def test_unknown_groups(self):
        self.refused(3, "study", self.cohort, "--group-by", "performer", "--include-synthetic", "--groups", "skilled,nobody", names=("nobody",))


class Participants(program.ProgramTest):
    def test_add_and_set(self):
        cohort = self.path("c.db")
        self.well("participant", "add", "P1", "--group", "novice", "--site", "A", "--experience", "laparoscopies=12", "--consent",
                  "study:2026-01-31", "--cohort", cohort)
        self.refused(3, "participant", "add", "P1", "--cohort", cohort, names=("P1",))
        self.refused(3, "participant", "set", "P2", "--group", "x", "--cohort", cohort, names=("P2",))
        self.well("participant", "set", "P1", "--group", "expert", "--experience", "laparoscopies=500", "--cohort", cohort)
        self.assertEqual(query(cohort, "SELECT pseudonym, study_group, site FROM participant"), [("P1", "expert", "A")])
        self.assertEqual(query(cohort, "SELECT criterion, value FROM participant_experience"), [("laparoscopies", "500")])
        self.assertEqual(query(cohort, "SELECT purpose, given_on FROM consent"), [("study", "2026-01-31")])
        self.assertEqual([a for (a,) in query(cohort, "SELECT action FROM audit ORDER BY id")], ["participant-add", "participant-set"])
        before = content(cohort)
        for wrong in (["--experience", "many"], ["--experience", "=3"], ["--consent", "study"], ["--consent", "study:31.1.2026"],
                      ["--consent", "study:2026-02-30"], ["--experience", "a=1", "--experience", "a=2"]):
            with self.subTest(" ".join(wrong)):
                self.refused(2, "participant", "set", "P1", *wrong, "--cohort", cohort)
        self.refused(2, "participant", "add", "", "--cohort", cohort)
        self.refused(2, "participant", "add", "P" * 65, "--cohort", cohort)
        self.refused(2, "participant", "add", "a\nb", "--cohort", cohort)
        self.assertEqual(content(cohort), before)

    def test_attempts_of_participants(self):
        cohort = self.path("c.db")
        r = recording("of-P1", "--performer", "skilled", "--seconds", 0.5, "--participant", "P1", "--mode", "assessment")
        self.well("participant", "add", "P1", "--group", "novice", "--cohort", cohort)
        self.well("assess", r, "--cohort", cohort)
        self.assertEqual(query(cohort, "SELECT pseudonym, study_group FROM attempt JOIN participant ON participant.id = attempt.participant"),
                         [("P1", "novice")])

    def test_a_database_that_is_none_of_ours(self):
        other = self.path("other.db")
        with closing(sqlite3.connect(other)) as database:
            database.execute("CREATE TABLE participant (name TEXT)")
            database.commit()
        before = other.read_bytes()
        self.refused(4, "participant", "add", "P1", "--cohort", other, names=(other,))
        self.refused(4, "study", other, names=(other,))
        self.refused(4, "assess", program.short(), "--cohort", other, names=(other,))
        self.assertEqual(other.read_bytes(), before)

    def test_a_database_of_later_software(self):
        later = self.path("later.db")
        self.well("participant", "add", "P1", "--cohort", later)
        with edited(later) as database:
            version = database.execute("PRAGMA user_version").fetchone()[0]
            self.assertGreater(version, 0)
            database.execute(f"PRAGMA user_version = {version + 1}")
        answer = calot("participant", "add", "P2", "--cohort", later)
        self.assertIn(answer.code, (4, 5), answer)
        self.assertOneLine(answer, later)


if __name__ == "__main__":
    program.main()
