#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""calot-dashboard before its window: what cannot be shown is one line and the right exit code."""

import sqlite3

import program
from program import ProgramTest

DASHBOARD = program.PROGRAM.with_name("calot-dashboard")
NO_SCREEN = {"QT_QPA_PLATFORM": "", "DISPLAY": "", "WAYLAND_DISPLAY": ""}


class Dashboard(ProgramTest):
    def declined(self, code, *arguments, environment=None):
        answer = program.calot(*arguments, program=DASHBOARD, environment={"LC_ALL": "C.UTF-8", **(environment or {"QT_QPA_PLATFORM": "offscreen"})})
        self.assertEqual(answer.code, code, answer)
        [line] = answer.err.splitlines()
        self.assertTrue(line.startswith("calot-dashboard: "), answer)
        self.assertEqual(answer.out, "", answer)
        return line

    def test_no_cohort_database(self):
        self.assertIn("no such cohort database", self.declined(4, self.folder / "none.db"))
        self.declined(4, "")
        self.assertIn("not a file", self.declined(4, self.folder))
        text = self.folder / "text.db"
        text.write_text("participants: 3\n")
        self.assertIn("not an SQLite file", self.declined(4, text))
        empty = self.folder / "empty.db"
        empty.write_bytes(b"")
        self.assertIn("empty file", self.declined(4, empty))
        other = self.folder / "other.db"
        with sqlite3.connect(other) as database:
            database.execute("create table songs(title)")
        self.assertIn("another program's", self.declined(4, other))

    def test_wrong_use(self):
        self.declined(2, "--no-such-option")
        self.declined(2, "a.db", "b.db")
        self.declined(2, "--pictures")

    def test_pictures_want_a_folder_that_takes_them(self):
        self.assertIn("is no folder", self.declined(2, "--pictures", self.folder / "missing"))
        file = self.folder / "file"
        file.write_text("")
        self.assertIn("is no folder", self.declined(2, "--pictures", file))
        # Nobody makes files there, not even an administrator.
        self.assertIn("cannot be written", self.declined(1, "--pictures", "/proc"))

    def test_without_a_screen(self):
        self.assertIn("no screen", self.declined(1, environment=NO_SCREEN))


if __name__ == "__main__":
    program.main()
