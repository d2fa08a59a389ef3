# SPDX-License-Identifier: GPL-3.0-or-later
"""calot attempt, regrade, cohort: decisions, values computed anew, two databases made one."""

import json
import os
import shutil

import h5py
import program
import recording_file
from cohort_content import content, edited, query
from program import calot, recording


def of(participant, seed):
    return recording(f"{participant}-{seed}", "--performer", "skilled", "--seed", seed, "--seconds", 1, "--mode", "assessment",
                     "--purpose", "study", "--participant", participant)


def change(path, sql):
    with edited(path) as database:
        return database.execute(sql).rowcount


class Attempts(program.ProgramTest):
    def test_exclude_and_include(self):
        cohort = self.path("c.db")
        runs = [recording(f"{who}-{seed}", "--performer", who, "--seed", seed, "--seconds", 1, "--mode", "assessment", "--purpose", "study")
                for who in ("skilled", "unskilled") for seed in (1, 2)]
        rows = json.loads(self.well("assess", *runs, "--cohort", cohort, "--json").out)["recordings"]
        uuid = rows[0]["attempt"]
        decide = ("--cohort", cohort, "--reason", "fire alarm", "--by", "instructor 2")
        self.well("attempt", "exclude", uuid[:8], *decide)
        study = ("study", cohort, "--group-by", "performer", "--include-synthetic")
        flow = json.loads(self.well(*study, "--json").out)["flow"]
        self.assertEqual([(row["reason"], row["attempts"]) for row in flow["excluded"]], [("excluded by hand: fire alarm (instructor 2)", 1)])
        self.assertEqual((flow["recruited"], flow["analysed"]), (4, 3))
        self.assertIn("fire alarm (instructor 2)", self.well(*study).out)
        self.well("attempt", "include", uuid, "--cohort", cohort, "--reason", "heard nothing", "--by", "instructor 2")
        self.assertEqual(json.loads(self.well(*study, "--json").out)["flow"]["analysed"], 4)
        self.assertEqual(query(cohort, "SELECT action, subject, detail FROM audit WHERE action LIKE '%clude' ORDER BY id"),
                         [("attempt-exclude", uuid, "fire alarm (by instructor 2)"),
                          ("attempt-include", uuid, "heard nothing (by instructor 2)")])
        before = content(cohort)
        self.refused(3, "attempt", "include", uuid, *decide, names=(uuid,))
        self.refused(3, "attempt", "exclude", "zz", *decide, names=(cohort, "zz"))
        self.refused(3, "attempt", "exclude", "%", *decide)
        self.refused(2, "attempt", "exclude", uuid, "--cohort", cohort, "--reason", "  ", "--by", "me")
        self.refused(2, "attempt", "exclude", uuid, "--cohort", cohort, "--reason", "x")
        self.refused(4, "attempt", "exclude", uuid, "--cohort", self.path("none.db"), "--reason", "x", "--by", "y", names=("none.db",))
        self.assertEqual(content(cohort), before)


    def test_tags(self):
        cohort = self.path("c.db")
        runs = [recording(f"skilled-{seed}", "--performer", "skilled", "--seed", seed, "--seconds", 1, "--mode", "assessment", "--purpose", "study")
                for seed in (1, 2)]
        uuid = json.loads(self.well("assess", *runs, "--cohort", cohort, "--json").out)["recordings"][0]["attempt"]
        by = ("--cohort", cohort, "--by", "me")
        said = json.loads(self.well("attempt", "tag", uuid[:8], "add", "teaching", *by, "--json").out)
        self.assertEqual((said["schema"], said["attempt"], said["tags"], said["changed"]), ("calot-attempt-tag", uuid, ["teaching"], True))
        self.assertFalse(json.loads(self.well("attempt", "tag", uuid, "add", "teaching", *by, "--json").out)["changed"])
        self.assertIn("tags bleeding, teaching", self.well("attempt", "tag", uuid, "add", "bleeding", *by).out)
        listed = json.loads(self.well("attempt", "list", "--cohort", cohort, "--tag", "bleeding", "--json").out)["attempts"]
        self.assertEqual([(a["attempt"], a["tags"]) for a in listed], [(uuid, ["bleeding", "teaching"])])
        self.assertRegex(self.well("attempt", "list", "--cohort", cohort).out, r"(?s)tags\n.*bleeding,\s+teaching")
        self.well("regrade", cohort, os.path.dirname(runs[0]))
        self.well("attempt", "tag", uuid, "remove", "bleeding", *by)
        self.assertEqual(query(cohort, "SELECT action, subject, detail FROM audit WHERE action LIKE '%tag' ORDER BY id"),
                         [("attempt-tag", uuid, "teaching (by me)"), ("attempt-tag", uuid, "bleeding (by me)"),
                          ("attempt-untag", uuid, "bleeding (by me)")])
        self.assertEqual(query(cohort, "SELECT tag FROM attempt_tag"), [("teaching",)])
        before = content(cohort)
        self.refused(3, "attempt", "tag", uuid, "remove", "bleeding", *by, names=(uuid, "bleeding"))
        self.refused(3, "attempt", "tag", "zz", "add", "x", *by, names=("zz",))
        self.refused(2, "attempt", "tag", uuid, "add", "two words", *by, names=("one word",))
        self.refused(2, "attempt", "tag", uuid, "put", "x", *by)
        self.refused(2, "attempt", "tag", uuid, "add", "x", "--cohort", cohort)
        self.assertEqual(content(cohort), before)


class Regrade(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort = self.path("c.db")
        self.folder_of = self.path("recordings")
        self.folder_of.mkdir()
        self.files = [shutil.copy(of(f"P{n}", n), self.folder_of) for n in (1, 2, 3)]
        self.well("assess", *self.files, "--cohort", self.cohort)

    def regrade(self, *more):
        return json.loads(self.well("regrade", self.cohort, self.folder_of, "--json", *more).out)["attempts"]

    def test_twice_is_once(self):
        before = content(self.cohort)
        for jobs in (1, 2):
            self.assertEqual([a["result"] for a in self.regrade("--jobs", jobs)], ["unchanged"] * 3)
            self.assertEqual(content(self.cohort), before)

    def test_one_metric_of_another_version_changes_its_rows_only(self):
        before = content(self.cohort)
        stale = change(self.cohort, "UPDATE checkpoint_value SET version = 0, value = value * 2 WHERE name = 'path-length'")
        self.assertEqual(stale, 6)
        old = content(self.cohort)
        attempts = self.regrade()
        self.assertEqual([a["result"] for a in attempts], ["changed"] * 3)
        self.assertEqual({(c["name"], c["before"]["version"]) for a in attempts for c in a["changes"]}, {("path-length", 0)})
        self.assertEqual(sum(len(a["changes"]) for a in attempts), 6)
        after = content(self.cohort)
        self.assertEqual(after["checkpoint_value"], before["checkpoint_value"])
        self.assertEqual(len(set(old["checkpoint_value"]) ^ set(after["checkpoint_value"])), 12)
        for table in before:
            if table not in ("checkpoint_value", "audit"):
                self.assertEqual(after[table], before[table], table)

    def test_values_that_are_gone_or_of_no_checkpoint(self):
        before = content(self.cohort)
        change(self.cohort, "DELETE FROM checkpoint_value WHERE name = 'elapsed-time'")
        change(self.cohort, "UPDATE checkpoint_value SET name = 'style', subject = 'left' WHERE position = 5")
        self.assertEqual(calot("regrade", self.cohort, self.folder_of).code, 0)
        self.assertEqual(content(self.cohort)["checkpoint_value"], before["checkpoint_value"])

    def test_decisions_stay(self):
        uuid = query(self.cohort, "SELECT uuid FROM attempt ORDER BY id LIMIT 1")[0][0]
        self.well("attempt", "exclude", uuid, "--cohort", self.cohort, "--reason", "r", "--by", "b")
        change(self.cohort, "DELETE FROM checkpoint_value")
        self.regrade()
        self.assertEqual(query(self.cohort, "SELECT reason FROM exclusion"), [("r",)])

    def test_missing_and_damaged_recordings_are_named(self):
        os.unlink(self.files[0])
        recording_file.flip_stored_byte(self.files[1], "/ticks/left/force", 0)
        before = content(self.cohort)
        answer = calot("regrade", self.cohort, self.folder_of)
        self.assertEqual(answer.code, 4, answer)
        lines = answer.err.splitlines()
        self.assertEqual(len(lines), 2, answer)
        self.assertTrue(any("P1-1.h5 is in none of the places" in line for line in lines), answer)
        self.assertTrue(any("unreadable" in line and "P2-2.h5" in line for line in lines), answer)
        self.assertEqual(content(self.cohort), before)

    def test_other_simulation_version_keeps_what_was_resimulated(self):
        recording_file.set_attribute(self.files[0], "simulation_version", 999)
        change(self.cohort, "UPDATE attempt SET simulation_version = 999 WHERE id = (SELECT attempt FROM recording WHERE file_name = 'P1-1.h5')")
        with h5py.File(self.files[0], "r") as file:
            head = file["/status"][-1]["chain"].tobytes().hex()
        change(self.cohort, f"UPDATE recording SET chain_head = x'{head}' WHERE file_name = 'P1-1.h5'")
        change(self.cohort, "DELETE FROM checkpoint_value WHERE name = 'elapsed-time'")
        before = content(self.cohort)["checkpoint_value"]
        answer = calot("regrade", self.cohort, self.folder_of, "--json")
        self.assertEqual(answer.code, 5, answer)
        after = content(self.cohort)["checkpoint_value"]
        self.assertEqual(len(after), len(before) + 3)
        origins = dict(query(self.cohort, "SELECT origin, count(*) FROM checkpoint_value JOIN recording USING (attempt) "
                                          "WHERE file_name = 'P1-1.h5' AND value IS NOT NULL GROUP BY 1"))
        self.assertGreater(origins.get(0, 0), 10)
        self.assertEqual(calot("regrade", self.cohort, self.folder_of).code, 5)
        self.assertEqual(content(self.cohort)["checkpoint_value"], after)

    def test_places_that_are_not_there(self):
        self.refused(4, "regrade", self.cohort, self.path("nowhere"), names=("nowhere",))
        self.refused(4, "regrade", self.path("none.db"), self.folder_of, names=("none.db",))


class Merge(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.a, self.b = self.path("a.db"), self.path("b.db")
        self.well("participant", "add", "P1", "--group", "novice", "--site", "A", "--experience", "laparoscopies=3", "--cohort", self.a)
        self.well("participant", "add", "P2", "--group", "expert", "--site", "B", "--consent", "research:2026-01-01", "--cohort", self.b)
        self.well("assess", of("P1", 1), of("P3", 3), "--cohort", self.a)
        self.well("assess", of("P2", 2), of("P3", 3), "--cohort", self.b)
        uuid = query(self.b, "SELECT uuid FROM attempt ORDER BY id LIMIT 1")[0][0]
        self.well("attempt", "exclude", uuid, "--cohort", self.b, "--reason", "late", "--by", "me")
        self.well("cohort", "name", "both", "--add", "P2", "--cohort", self.b)

    def merge(self):
        return json.loads(self.well("cohort", "merge", self.a, self.b, "--json").out)

    def test_everything_comes_once(self):
        source = content(self.b)
        said = self.merge()
        self.assertEqual((said["merged"], said["participants"], said["attempts"]), (True, 1, 1))
        once = content(self.a)
        self.assertEqual(len(once["attempt"]), 3)
        for table in ("participant", "consent", "exclusion", "cohort_participant", "site"):
            self.assertGreaterEqual(len(once[table]), len(source[table]), table)
        self.assertEqual(query(self.a, "SELECT reason, pseudonym FROM exclusion JOIN attempt ON attempt.id = exclusion.attempt "
                                       "JOIN participant ON participant.id = attempt.participant"), [("late", "P2")])
        values = "SELECT uuid, name, subject, value FROM checkpoint_value JOIN attempt ON attempt.id = attempt ORDER BY 1, 2, 3"
        self.assertTrue(set(query(self.b, values)) <= set(query(self.a, values)))
        said = self.merge()
        self.assertEqual((said["participants"], said["attempts"], said["other_rows"], said["filled"]), (0, 0, 0, 0))
        self.assertEqual(content(self.a), once)
        self.assertEqual(content(self.b), source)
        self.well("cohort", "check", self.a)

    def test_either_way_round_holds_the_same(self):
        reverse = self.path("r.db")
        shutil.copyfile(self.b, reverse)
        self.well("cohort", "merge", reverse, self.a)
        self.merge()
        for sql in ("SELECT pseudonym, study_group, site FROM participant ORDER BY 1", "SELECT uuid FROM attempt ORDER BY 1",
                    "SELECT name FROM site ORDER BY 1", "SELECT count(*) FROM checkpoint_value"):
            self.assertEqual(query(self.a, sql), query(reverse, sql))

    def test_conflicts_are_named_and_nothing_is_merged(self):
        self.well("participant", "add", "P1", "--group", "expert", "--experience", "laparoscopies=4", "--cohort", self.b)
        change(self.b, "UPDATE attempt SET seed = '77' WHERE participant = (SELECT id FROM participant WHERE pseudonym = 'P3')")
        before = content(self.a)
        answer = calot("cohort", "merge", self.a, self.b)
        self.assertEqual(answer.code, 3, answer)
        for words in ('participant "P1": study_group is "novice"', "another seed", "participant_experience P1", "3 conflicts", "nothing was merged"):
            self.assertIn(words, answer.err)
        self.assertEqual(content(self.a), before)

    def test_what_is_empty_is_filled(self):
        self.well("participant", "add", "P2", "--cohort", self.a)
        self.assertEqual(self.merge()["filled"], 2)
        self.assertEqual(query(self.a, "SELECT study_group, site FROM participant WHERE pseudonym = 'P2'"), [("expert", "B")])

    def test_refusals(self):
        self.refused(2, "cohort", "merge", self.a, self.a, names=(self.a,))
        self.refused(4, "cohort", "merge", self.a, self.path("none.db"), names=("none.db",))
        self.well("cohort", "merge", self.path("new.db"), self.b)
        self.assertIn("nothing new", self.well("cohort", "merge", self.path("new.db"), self.b).out)
        self.assertFalse(self.path("none.db").exists())


class Check(program.ProgramTest):
    def test_sound_and_damaged(self):
        cohort = self.path("c.db")
        self.well("assess", of("P1", 1), "--cohort", cohort)
        self.assertIn("sound", self.well("cohort", "check", cohort).out)
        change(cohort, "DELETE FROM attempt")  # foreign keys are off here
        answer = calot("cohort", "check", cohort)
        self.assertEqual(answer.code, 4, answer)
        self.assertOneLine(answer, cohort, "attempt")

    def test_overwritten_pages_never_pass_and_never_crash(self):
        cohort, draw = self.path("c.db"), program.seeded("overwritten pages")
        self.well("assess", of("P1", 1), "--cohort", cohort)
        whole = cohort.read_bytes()
        refused = 0
        for _ in range(30):
            damaged = bytearray(whole)
            at = draw.randrange(100, len(whole) - 200)
            damaged[at:at + 200] = draw.randbytes(200)
            cohort.write_bytes(damaged)
            answer = calot("cohort", "check", cohort)
            self.assertIn(answer.code, (0, 1, 4, 5), answer)
            if answer.code:
                self.assertOneLine(answer, cohort)
                refused += 1
        self.assertEqual(refused, 30)

    def test_names(self):
        cohort = self.path("c.db")
        self.well("participant", "add", "P1", "--site", "North", "--arm", "control", "--cohort", cohort)
        self.well("cohort", "station", "S1", "--site", "North", "--public-key", "ab" * 32, "--cohort", cohort)
        self.well("cohort", "name", "pilot", "--add", "P1", "--note", "first week", "--cohort", cohort)
        said = json.loads(self.well("cohort", "list", cohort, "--json").out)
        self.assertEqual(said["sites"], [{"name": "North", "note": ""}])
        self.assertEqual(said["arms"], [{"name": "control", "note": ""}])
        self.assertEqual(said["stations"], [{"name": "S1", "site": "North", "public_key": "ab" * 32, "note": ""}])
        self.assertEqual(said["cohorts"], [{"name": "pilot", "participants": ["P1"], "note": "first week"}])
        self.refused(3, "cohort", "station", "S1", "--public-key", "cd" * 32, "--cohort", cohort, names=("S1",))
        self.refused(2, "cohort", "station", "S1", "--public-key", "xy", "--cohort", cohort)
        self.refused(3, "cohort", "name", "pilot", "--add", "P9", "--cohort", cohort, names=("P9",))
        self.refused(2, "cohort", "site", "", "--cohort", cohort)
        self.well("cohort", "name", "pilot", "--remove", "P1", "--cohort", cohort)
        self.assertEqual(json.loads(self.well("cohort", "list", cohort, "--json").out)["cohorts"][0]["participants"], [])


if __name__ == "__main__":
    program.main()
