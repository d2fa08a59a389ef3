# SPDX-License-Identifier: GPL-3.0-or-later
"""calot import --manifest and rate --manifest: from a folder and a table to a study, and tables that are wrong."""

import json
import math
import os
import pty
import sqlite3
import subprocess
import unittest
from contextlib import closing

import program
from program import calot

ROWS = 61  # two seconds: long enough for every figure's filter
PEOPLE = 10
PER_PERSON = 4
ITEMS = ("depth-perception", "bimanual-dexterity", "efficiency", "tissue-handling", "autonomy")


def motion(generator, tremor):
    """Two hands that reach to and fro, as 76 columns of text."""
    eye = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    phase = [generator.uniform(0, 2 * math.pi) for _ in range(6)]
    lines = []
    for row in range(ROWS):
        t = row / 30
        cells = []
        for group in range(4):
            hand = group % 2
            place = [0.04 + 0.03 * hand + 0.05 * math.sin(2.5 * t + phase[3 * hand + i]) + tremor * math.sin(25 * t + phase[i])
                     for i in range(3)]
            cells += [*place, *eye, *[0] * 7]
        lines.append(" ".join(f"{c:.6g}" for c in cells))
    return "\n".join(lines) + "\n"


class Manifest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort, self.table = self.path("c.db"), self.path("table.csv")

    def make(self, people=PEOPLE, each=PER_PERSON):
        """Files in a folder, and rows of the table; experts tremble less."""
        generator = program.seeded("manifest")
        self.path("motion").mkdir()
        rows = []
        for person in range(people):
            group = ("expert", "novice")[person % 2]
            for attempt in range(each):
                name = f"motion/p{person}-{attempt}.txt"
                self.path(name).write_text(motion(generator, (0.001 if group == "expert" else 0.004) * generator.uniform(0.8, 1.2)))
                rows.append({"file": name, "participant": f"P{person}", "group": group, "task": "reaching",
                             "start": f"2026-01-{attempt + 1:02}T09:{person:02}:00Z", "outcome": "completed",
                             "experience": f"laparoscopies={200 * (1 - person % 2) + person}; level=made up", "purpose": "demo",
                             "mode": "assessment"})
        return rows

    def write(self, rows, separator=","):
        text = "\n".join(separator.join(str(cell) if separator not in str(cell) else f'"{cell}"' for cell in cells)
                         for cells in [list(rows[0]), *[list(r.values()) for r in rows]])
        self.table.write_text(text + "\n")

    def content(self):
        with closing(sqlite3.connect(f"file:{self.cohort}?mode=ro", uri=True)) as database:
            return {t: database.execute(f"SELECT * FROM {t} ORDER BY 1, 2").fetchall()
                    for t in ("attempt", "recording", "checkpoint_value", "participant", "participant_experience", "audit")}


class Motion(Manifest):
    def test_from_a_folder_and_a_table_to_a_study(self):
        self.write(self.make())
        answer = self.well("import", "--manifest", self.table, "--cohort", self.cohort)
        self.assertEqual(answer.out, f"{self.table}: 40 files: 40 added; 10 participants (expert 5, novice 5)\n")
        reports = ["--html", self.path("s.html")]
        if "--pdf" in calot("study", "--help").out:
            reports += ["--pdf", self.path("s.pdf")]
        self.well("study", self.cohort, "--attempt-rule", "mean", "--all", *reports)
        for name in reports[1::2]:
            self.assertGreater(name.stat().st_size, 20000)
        said = json.loads(self.well("study", self.cohort, "--attempt-rule", "mean", "--json").out)
        self.assertEqual((said["groups"], said["participants"]), (["expert", "novice"], [5, 5]))
        before = self.content()
        with closing(sqlite3.connect(self.cohort)) as database:
            self.assertEqual(database.execute("SELECT DISTINCT purpose, mode, outcome, scene, synthetic FROM attempt").fetchall(),
                             [("demo", 1, 1, "reaching", 0)])
            self.assertEqual(database.execute("SELECT value FROM participant_experience e JOIN participant p ON p.id = e.participant "
                                              "WHERE pseudonym = 'P2' ORDER BY criterion").fetchall(), [("202",), ("made up",)])
        again = self.well("import", "--manifest", self.table, "--cohort", self.cohort)
        self.assertIn("40 files: 40 unchanged; 10 participants", again.out)
        self.assertEqual(self.content(), before)

    def test_semicolons_options_and_criteria_of_their_own_column(self):
        rows = [{"file": r["file"], "participant": r["participant"], "group": r["group"], "experience:laparoscopies": "12,5", "note": "x"}
                for r in self.make(2, 1)]
        self.write(rows, ";")
        answer = self.well("import", "--manifest", self.table, "--cohort", self.cohort, "--task", "knots", cwd="/")
        self.assertIn("2 in practice mode", answer.out)
        with closing(sqlite3.connect(self.cohort)) as database:
            self.assertEqual(database.execute("SELECT DISTINCT scene FROM attempt").fetchall(), [("knots",)])
            self.assertEqual(database.execute("SELECT criterion, value FROM participant_experience").fetchall(), [("laparoscopies", "12,5")] * 2)

    def test_csv_files_by_their_map(self):
        self.path("maps").mkdir()
        self.path("maps/m.json").write_text(json.dumps({"format": "calot-columns", "formatVersion": 1, "frame": "world", "length": "mm",
                                                        "rate": 100, "left": {"position": ["x", "y", "z"]}}))
        self.path("a.csv").write_text("x,y,z\n" + "".join(f"{i % 7},{i % 5},{i % 3}\n" for i in range(200)))
        self.write([{"file": "a.csv", "columns": "maps/m.json", "participant": "P1"}])
        self.well("import", "--manifest", self.table, "--cohort", self.cohort)
        self.write([{"file": "a.csv", "participant": "P1"}])
        self.refused(4, "import", "--manifest", self.table, "--cohort", self.cohort, names=(self.table, "line 2"))
        self.well("import", "--manifest", self.table, "--cohort", self.cohort, "--columns", self.path("maps/m.json"))

    def test_files_that_say_all_need_no_map(self):
        rows = "".join(f"{i / 100:.2f},{i % 7},{i % 5},{i % 3}\n" for i in range(200))
        self.path("b.csv").write_text("time (s),left_x_mm,left_y_mm,left_z_mm\n" + rows)
        self.path("c.csv").write_text("time (s),left_x,left_y,left_z\n" + rows)
        self.write([{"file": "b.csv", "participant": "P1"}, {"file": "c.csv", "participant": "P2"}])
        self.refused(4, "import", "--manifest", self.table, "--cohort", self.cohort, names=(self.table, "line 3", "c.csv", '"columns"'))
        self.assertFalse(self.path("c.db").exists())
        self.write([{"file": "b.csv", "participant": "P1"}])
        self.well("import", "--manifest", self.table, "--cohort", self.cohort)

    def test_as_spreadsheets_write_them(self):
        rows = [{**r, "start": f"{45957 + i},5", "consent": "study:45957", "experience": ""} for i, r in enumerate(self.make(2, 2))]
        self.write(rows, ";")
        text = "sep=;\n" + self.table.read_text() + ";" * (len(rows[0]) - 1) + "\n"
        command = ("import", "--manifest", self.table, "--cohort", self.cohort)
        for encoding in ("utf-8-sig", "utf-16"):
            self.table.write_bytes(text.replace("\n", "\r\n").encode(encoding))
            answer = calot(*command)
            self.assertEqual((answer.code, answer.err.count("--zone")), (4, 4), answer)
            self.well(*command, "--zone", "+01:00")
        with closing(sqlite3.connect(self.cohort)) as database:
            self.assertEqual(database.execute("SELECT start_utc FROM attempt ORDER BY 1 LIMIT 1").fetchall(), [("2025-10-27T11:00:00Z",)])
        self.write([{**r, "start": "3/4/2026"} for r in rows], ";")
        answer = calot(*command, "--zone", "Z")
        self.assertEqual((answer.code, answer.err.count("--dates")), (4, 4), answer)

    def test_names_that_are_similar_are_asked_about(self):
        rows = self.make(2, 2)
        rows[1]["participant"], rows[3]["group"] = "p0", "Novice"
        self.write(rows)
        command = ("import", "--manifest", self.table, "--cohort", self.cohort)
        self.refused(3, *command, names=(self.table, "line 3", '"participant"', "p0", "P0", "--similar-names"))
        self.assertFalse(self.cohort.exists())
        self.assertIn("2 participants (expert 1, novice 1)", self.well(*command, "--similar-names", "one").out)
        self.write([{**rows[0], "participant": "P00"}])
        self.refused(3, *command, names=("line 2", "P00", "P0"))

    def test_a_wrong_row_stores_nothing(self):
        rows = self.make(2, 2)
        for change, names in (({"file": "motion/none.txt"}, ('"file"', "none.txt", "relative to the manifest")),
                              ({"file": ""}, ('"file"', "is empty")),
                              ({"file": "motion/../motion/p0-0.txt"}, ("line 2 already",)),
                              ({"participant": ""}, ('"participant"', "is empty")),
                              ({"participant": "x" * 65}, ('"participant"', "64")),
                              ({"group": "novice"}, ('"group"', '"novice"', '"expert"')),
                              ({"task": "two words"}, ('"task"', "without blanks")),
                              ({"start": "yesterday"}, ('"start"', "2026-01-31T12:00:00Z")),
                              ({"outcome": "done"}, ('"outcome"', "completed, abandoned, stopped")),
                              ({"mode": "exam"}, ('"mode"', "practice, assessment")),
                              ({"purpose": "fun"}, ('"purpose"',)),
                              ({"experience": "many"}, ('"experience"', "CRITERION=VALUE")),
                              ({"experience": "a=1;a=2"}, ('"experience"', "twice"))):
            with self.subTest(str(change)):
                self.write([rows[0], {**rows[1], **change}, *rows[2:]])
                self.refused(4, "import", "--manifest", self.table, "--cohort", self.cohort, names=(self.table, "line 3", *names))
                self.assertFalse(self.cohort.exists())
        # Every wrong row is named, and no more than 20 of them.
        self.write([{**r, "mode": "exam"} for r in rows])
        answer = calot("import", "--manifest", self.table, "--cohort", self.cohort)
        self.assertEqual([line.split("line ")[1].split(":")[0] for line in answer.err.splitlines()], ["2", "3", "4", "5"])
        self.write([{**rows[0], "mode": f"exam{i}"} for i in range(30)])
        answer = calot("import", "--manifest", self.table, "--cohort", self.cohort)
        self.assertEqual(len(answer.err.splitlines()), 21)
        self.assertIn("10 more", answer.err)

    def test_wrong_tables_and_use(self):
        rows = self.make(1, 1)
        self.write([{**rows[0], "grp": "x"}])
        self.refused(2, "import", "--manifest", self.table, "--cohort", self.cohort, names=("line 1", '"grp"', "group"))
        self.write([{"participant": "P", "group": "x"}])
        self.refused(2, "import", "--manifest", self.table, "--cohort", self.cohort, names=("line 1", '"file"'))
        self.write(rows)
        self.refused(2, "import", "--manifest", self.table, names=("--cohort",))
        self.refused(2, "import", "--manifest", self.table, "--cutoff", 3, names=("--cohort",))
        self.refused(2, "import", "--manifest", self.table, self.path(rows[0]["file"]), "--cohort", self.cohort, names=("--manifest",))
        self.refused(2, "import", "--cohort", self.cohort, names=("--manifest",))
        self.refused(4, "import", "--manifest", self.path("none.csv"), "--cohort", self.cohort, names=("none.csv",))
        self.assertFalse(self.cohort.exists())

    def test_what_the_cohort_knows_stays(self):
        rows = self.make(2, 1)
        self.write(rows)
        self.well("participant", "add", "P0", "--group", "novice", "--cohort", self.cohort)
        before = self.content()
        self.refused(3, "import", "--manifest", self.table, "--cohort", self.cohort,
                     names=(self.table, "line 2", 'group "novice", not "expert"', "participant set"))
        self.assertEqual(self.content(), before)
        self.well("participant", "set", "P0", "--group", "", "--cohort", self.cohort)
        self.well("import", "--manifest", self.table, "--cohort", self.cohort)
        self.assertEqual([r[2] for r in self.content()["participant"]], ["expert", "novice"])

    def test_a_file_that_fails_is_named_at_the_end(self):
        rows = self.make(2, 2)
        lines = self.path(rows[1]["file"]).read_text().splitlines()
        self.path(rows[1]["file"]).write_text("\n".join([*lines[:2], "1 2 3", *lines[3:]]) + "\n")
        self.write(rows)
        answer = calot("import", "--manifest", self.table, "--cohort", self.cohort)
        self.assertEqual(answer.code, 4, answer)
        self.assertOneLine(answer, self.table, "line 3", "p0-1.txt", "76")
        self.assertIn("4 files: 3 added, 1 not stored", answer.out)
        # Mended, the rest is taken in; what was there is not stored again.
        self.path(rows[1]["file"]).write_text("\n".join(lines[:-1]) + "\n")
        self.assertIn("1 added, 3 unchanged", self.well("import", "--manifest", self.table, "--cohort", self.cohort).out)
        self.write([{**r, "task": "other"} for r in rows[:1]])
        answer = calot("import", "--manifest", self.table, "--cohort", self.cohort)
        self.assertEqual(answer.code, 3, answer)
        self.assertOneLine(answer, "line 2", "conflict")

    def test_a_terminal_shows_one_line_that_is_drawn_again(self):
        self.write(self.make(2, 3))
        ours, theirs = pty.openpty()
        done = subprocess.run([str(program.PROGRAM), "import", "--manifest", str(self.table), "--cohort", str(self.cohort)],
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=theirs, timeout=program.PATIENCE, check=True)
        os.close(theirs)
        drawn = os.read(ours, 100000).decode()
        os.close(ours)
        self.assertRegex(drawn, r"^\r\x1b\[KImporting \.\.\.\r.*\x1b\[K$")
        self.assertNotIn("\n", drawn)
        self.assertEqual(len(done.stdout.splitlines()), 1)


class Ratings(Manifest):
    def setUp(self):
        super().setUp()
        self.motion = self.make(4, 1)
        self.write(self.motion)
        self.well("import", "--manifest", self.table, "--cohort", self.cohort)
        with closing(sqlite3.connect(self.cohort)) as database:
            self.uuids = dict(database.execute("SELECT r.file_name, a.uuid FROM attempt a JOIN recording r ON r.attempt = a.id"))
        self.rows = [{"file": r["file"], "rater": rater, **{item: 1 + (i + k) % 5 for k, item in enumerate(ITEMS)}}
                     for i, r in enumerate(self.motion) for rater in ("R1", "R2")]

    def rate(self, *more):
        return ("rate", self.cohort, "--manifest", self.table, "--form", "goals", *more)

    def ratings(self):
        with closing(sqlite3.connect(f"file:{self.cohort}?mode=ro", uri=True)) as database:
            return (database.execute("SELECT a.uuid, rater, item, score FROM rating r JOIN attempt a ON a.id = r.attempt ORDER BY 1, 2, 3").fetchall(),
                    database.execute("SELECT count(*) FROM audit").fetchone())

    def test_a_table_of_ratings(self):
        self.rows[0]["efficiency"] = "NA"
        self.write(self.rows, ";")
        self.assertEqual(self.well(*self.rate()).out, f"{self.table}: 8 ratings: 8 added, 0 unchanged, 0 replaced\n")
        stored = self.ratings()
        self.assertEqual(len(stored[0]), 8 * 5 - 1)
        scores = {(u, r, i): s for u, r, i, s in stored[0]}
        for row in self.rows:
            uuid = self.uuids[row["file"].split("/")[1]]
            self.assertEqual([scores.get((uuid, row["rater"], i), "NA") for i in ITEMS], [row[i] for i in ITEMS])
        self.write([{**row, **{i: row[i] if row[i] == "NA" else f"{row[i]},0" for i in ITEMS}} for row in self.rows], ";")
        self.assertIn("8 unchanged", self.well(*self.rate()).out)
        self.assertEqual(self.ratings(), stored)
        self.assertEqual(json.loads(self.well("rate", self.cohort, "--json").out)["forms"][0]["filled"], 8)
        self.rows[3]["autonomy"] = 6 - self.rows[3]["autonomy"] + (self.rows[3]["autonomy"] == 3)
        self.write(self.rows)
        self.refused(3, *self.rate(), names=(self.table, "line 5", "--force"))
        self.assertEqual(self.ratings(), stored)
        self.assertEqual(json.loads(self.well(*self.rate("--force", "--json")).out)["replaced"], 1)

    def test_attempts_and_participants(self):
        file = self.rows[0]["file"].split("/")[1]
        rest = {k: v for k, v in self.rows[0].items() if k != "file"}
        self.write([{"attempt": self.uuids[file][:7], **rest, "form": "goals"}])
        self.refused(4, *self.rate(), names=("line 2", '"attempt"', self.uuids[file][:7]))
        self.write([{"attempt": self.uuids[file][:9].upper(), **rest, "form": "goals"}])
        self.well("rate", self.cohort, "--manifest", self.table)
        self.write([{"participant": "P0", **rest}])
        self.assertIn("1 unchanged", self.well(*self.rate()).out)

    def test_a_wrong_row_stores_nothing(self):
        for change, code, names in (({"file": "none.txt"}, 4, ('"file"', "none.txt", "no attempt")), ({"file": ""}, 4, ("name what was rated",)),
                                    ({"rater": ""}, 4, ('"rater"', "is empty")), ({"rater": "R1"}, 4, ("line 2 rates the same",)),
                                    ({"efficiency": 6}, 4, ("line 3", "efficiency")), ({"efficiency": "good"}, 4, ("efficiency",)),
                                    ({"efficiency": "2,5"}, 4, ("efficiency",)), ({i: "" for i in ITEMS}, 4, ("line 3",))):
            with self.subTest(str(change)):
                self.write([self.rows[0], {**self.rows[1], **change}, *self.rows[2:]])
                self.refused(code, *self.rate(), names=(self.table, "line 3", *names))
                self.assertEqual(self.ratings()[0], [])
        self.write([{k: v for k, v in r.items() if k != "autonomy"} for r in self.rows[:1]])
        self.refused(4, *self.rate(), names=("autonomy",))
        self.write([{**r, "comment": "x"} for r in self.rows])
        self.refused(2, *self.rate(), names=("line 1", '"comment"'))
        self.write(self.rows)
        self.refused(2, "rate", self.cohort, "--manifest", self.table, names=("line 2", "form"))
        self.refused(2, *self.rate("--rater", "R1"), names=("--manifest",))


if __name__ == "__main__":
    program.main()
