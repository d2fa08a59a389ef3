#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""calot-dashboard before its window: what cannot be shown is one line and the right exit code."""

import contextlib
import os
import sqlite3
import struct
import subprocess
import time

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
        self.assertIn("none.db", self.declined(4, self.folder / "none.db"))
        self.declined(4, "")
        self.assertIn(str(self.folder), self.declined(4, self.folder))
        text = self.folder / "text.db"
        text.write_text("participants: 3\n")
        self.assertIn("text.db", self.declined(4, text))
        empty = self.folder / "empty.db"
        empty.write_bytes(b"")
        self.assertIn(str(empty), self.declined(4, empty))
        other = self.folder / "other.db"
        with sqlite3.connect(other) as database:
            database.execute("create table songs(title)")
        self.assertIn(str(other), self.declined(4, other))

    def test_wrong_use(self):
        self.declined(2, "--no-such-option")
        self.declined(2, "a.db", "b.db")
        self.declined(2, "--pictures")

    def test_pictures_want_a_folder_that_takes_them(self):
        self.assertIn("missing", self.declined(2, "--pictures", self.folder / "missing"))
        file = self.folder / "file"
        file.write_text("")
        self.assertIn(str(file), self.declined(2, "--pictures", file))
        # Nobody makes files there, not even an administrator.
        self.assertIn("/proc", self.declined(1, "--pictures", "/proc"))

    def test_a_cohort_of_an_older_version_is_brought_up_to_date(self):
        old, pictures = self.folder / "old.db", self.folder / "pictures"
        pictures.mkdir()
        with contextlib.closing(sqlite3.connect(old)) as database:
            database.executescript((program.SOURCE / "schemas/cohort/0001_fixed.sql").read_text())
            database.executescript("PRAGMA application_id = 1130458223; PRAGMA user_version = 1;")
        answer = program.calot(old, "--pictures", pictures, program=DASHBOARD, environment={"QT_QPA_PLATFORM": "offscreen"})
        self.assertEqual(answer.code, 0, answer)
        self.assertTrue((self.folder / "old.db.schema-1.bak").exists())
        # The screen of the test's platform has 800 by 800 pixels.
        sizes = [struct.unpack(">II", file.read_bytes()[16:24]) for file in pictures.glob("*.png")]
        self.assertTrue(sizes and all(height >= 700 for _, height in sizes), sizes)
        with contextlib.closing(sqlite3.connect(old)) as database:
            self.assertGreater(database.execute("PRAGMA user_version").fetchone()[0], 1)

    def test_a_recording_is_verified_and_kept(self):
        database = self.folder / "data/calot/opened.db"
        environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen", "LC_ALL": "C.UTF-8", "XDG_DATA_HOME": str(self.folder / "data"), "XDG_CONFIG_HOME": str(self.folder / "settings")}
        recording = self.copy(program.short())
        with subprocess.Popen([DASHBOARD, recording], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as window:
            try:
                end = time.monotonic() + program.PATIENCE
                while not (kept := self.attempts(database)) and time.monotonic() < end and window.poll() is None:
                    time.sleep(0.2)
            finally:
                window.kill()
            self.assertEqual(kept, [("r.h5",)], window.stdout.read())

    def attempts(self, database):
        if not database.exists():
            return []
        with contextlib.closing(sqlite3.connect(f"file:{database}?mode=ro", uri=True)) as cohort:
            try:
                return cohort.execute("select file_name from recording").fetchall()
            except sqlite3.OperationalError:
                return []  # it is just being made

    def test_a_recording_that_cannot_be_shown(self):
        recording = self.copy(program.short())
        self.assertIn("cohort database", self.declined(2, "--pictures", self.folder, recording))
        recording.write_bytes(recording.read_bytes()[:4000])
        self.assertIn("r.h5", self.declined(4, recording))

    def test_without_a_screen(self):
        self.assertIn("screen", self.declined(1, environment=NO_SCREEN))
        self.assertIn(":77", self.declined(1, environment={"QT_QPA_PLATFORM": "xcb", "DISPLAY": ":77"}))


if __name__ == "__main__":
    program.main()
