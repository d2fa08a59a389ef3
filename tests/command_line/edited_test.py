# SPDX-License-Identifier: GPL-3.0-or-later
"""Edited recordings and databases: no value that no writer makes is accepted, wherever it stands, even if the chain was made to fit."""

import sqlite3

import h5py
import numpy as np
import program
import recording_file
from cohort_content import edited
from program import calot, recording, short, skilled


class EditedRecording(program.ProgramTest):
    def edited(self, original, change, seal=True):
        r = self.copy(original)
        with h5py.File(r, "r+") as file:
            change(file)
            if seal:
                recording_file.reseal(file)
        return r

    def test_lateness(self):
        for dataset in ("/ticks/lateness", "/steps/lateness"):
            for value, word in ((np.nan, "finite"), (np.inf, "finite"), (-0.001, "negative")):
                with self.subTest(dataset=dataset, value=value):
                    def change(file):
                        file[dataset][7] = value
                    r = self.edited(short(), change, seal=False)  # it is outside of the chain
                    self.refused(4, "replay", r, names=(r, f"{dataset}[7]", word))

    def test_numbers_of_contact_sets(self):
        for value in (-2, 1000, 1 << 62):
            with self.subTest(value=value):
                def change(file):
                    file["/ticks/left/contact_set"][77] = value
                r = self.edited(short(), change)
                self.refused(4, "replay", r, names=(r, "contact_set[77]"))

        # In the air any set gives the same force, if it does not fall behind the one before: re-simulation agrees, the chain does not.
        def another(file):
            self.assertFalse(file["/ticks/right/force"][:300].any())
            file["/ticks/right/contact_set"][200] -= 1

        r = self.edited(skilled(), another, seal=False)
        self.refused(3, "replay", r, names=(r, "content chain", "flush 1", "re-simulation agrees"))

    def test_index_of_keyframes(self):
        for member, value in (("step", 98), ("offset", 8), ("state_bytes", 16), ("haptics_bytes", 8), ("step", 1 << 60)):
            for seal in (True, False):
                with self.subTest(member=member, value=value, seal=seal):
                    def change(file):
                        row = file["/keyframes/index"][1]
                        row[member] = value if member == "step" else row[member] + value
                        file["/keyframes/index"][1] = row
                    answer = calot("replay", self.edited(skilled(), change, seal))
                    self.assertIn(answer.code, (3, 4), answer)
                    self.assertIn("keyframe" if seal or answer.code == 4 else "chain", answer.err)

    def test_names(self):
        for dataset, word in (("/steps/field_names", "field"), ("/steps/component_names", ""), ("/scene/organs", "structure")):
            with self.subTest(dataset):
                def change(file):
                    names = file[dataset]
                    names[0] = names[0][:-1] + b"X"
                r = self.edited(short(), change)
                self.refused(3, "replay", r, names=(r, word))
                r = self.edited(short(), change, seal=False)
                self.refused(3, "replay", r, names=(r, "chain" if dataset != "/steps/component_names" else "components"))

    def test_rows_of_status(self):
        def wall(file):
            row = file["/status"][1]
            row["wall_nanoseconds"] = -1
            file["/status"][1] = row

        def outcome(file):
            row = file["/status"][-1]
            row["outcome"] = 1
            file["/status"][len(file["/status"]) - 1] = row

        def steps(file):
            row = file["/status"][1]
            row["steps"] -= 1
            file["/status"][1] = row

        r = self.edited(short(), wall, seal=False)
        self.refused(4, "replay", r, names=(r, "/status", "row 1"))
        r = self.edited(short(), outcome, seal=False)
        self.refused(3, "replay", r, names=(r, "chain"))
        r = self.edited(short(), steps)
        self.refused(4, "replay", r, names=(r, "/status", "row 1"))

    def test_events(self):
        for member, value in (("hand", 7), ("value", np.nan), ("position", np.inf), ("step", 1 << 40)):
            with self.subTest(member):
                def change(file):
                    row = file["/events"][0]
                    row[member] = value
                    file["/events"][0] = row
                r = self.edited(skilled(), change)
                self.refused(4, "inspect", r, names=(r, "/events"))

    def test_every_data_set_holds_numbers(self):
        floating = []
        with h5py.File(short(), "r") as file:
            file.visititems(lambda name, thing: floating.append(name) if isinstance(thing, h5py.Dataset) and thing.dtype.kind == "f" else None)
        self.assertGreater(len(floating), 30)
        for dataset in floating:
            with self.subTest(dataset):
                def change(file):
                    data = file[dataset]
                    data[(30, 0) if data.ndim == 2 else 30] = np.nan
                r = self.edited(short(), change)
                self.refused(4, "inspect", r, names=(r, f"/{dataset}[30]"))


class EditedDatabase(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort = self.path("c.db")
        made = [recording(f"study-{profile}-{seed}", "--performer", profile, "--seed", seed, "--seconds", 0.5, "--mode", "assessment")
                for profile in ("skilled", "unskilled") for seed in (1, 2, 3)]
        self.well("assess", *made, "--cohort", self.cohort)
        self.who = ("--group-by", "performer", "--include-synthetic")
        self.well("norm", "create", self.cohort, "n", "--by", "test", "--rule", "at-least:1", "--checkpoints", "all", *self.who)
        self.attempt = self.query("SELECT uuid FROM attempt ORDER BY uuid")[0][0]
        self.ask = (("study", self.cohort, *self.who, "--json"), ("grade", self.cohort, "--attempt", self.attempt, "--json"))

    def query(self, words):
        with sqlite3.connect(self.cohort) as db:
            rows = db.execute(words).fetchall()
        db.close()
        return rows

    def test_study_and_grade_check_first(self):
        for command in self.ask:
            self.well(*command)
        with edited(self.cohort) as db:
            db.execute("DELETE FROM recording WHERE attempt = (SELECT id FROM attempt WHERE uuid = ?)", (self.attempt,))
        self.assertEqual(calot("cohort", "check", self.cohort).code, 4)
        norm = ("norm", "create", self.cohort, "m", "--by", "test", "--rule", "at-least:1", "--checkpoints", "all", *self.who)
        for command in (*self.ask, norm):
            answer = self.refused(4, *command, names=(self.cohort,))
            self.assertEqual(answer.out, "")

    def test_changed_bytes(self):
        draw = program.seeded("changed bytes of a database")
        whole = self.cohort.read_bytes()
        for _ in range(300 if program.HEAVY else 25):
            at = draw.randrange(100, len(whole))
            changed = bytearray(whole)
            changed[at] ^= 1 << draw.randrange(8)
            self.cohort.write_bytes(changed)
            for command in (("cohort", "check", self.cohort), *self.ask):
                answer = calot(*command)
                with self.subTest(at=at, command=command[0]):
                    self.assertIn(answer.code, (4, 5), answer)
                    self.assertOneLine(answer, self.cohort)
                    self.assertEqual(answer.out, "")


if __name__ == "__main__":
    program.main()
