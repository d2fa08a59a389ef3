# SPDX-License-Identifier: GPL-3.0-or-later
"""calot assess killed at random moments, beside a second writer, on a full disk, into an older and a newer schema: nothing is lost, and
what is said is clear. 8 kills, or 50 with CALOT_HEAVY=1."""

import resource
import shutil
import signal
import sqlite3
import subprocess
import time
from contextlib import closing

import program
from cohort_content import content, edited, query
from program import PROGRAM, SOURCE, calot, recording


def runs():
    return [recording(f"stress-{seed}", "--performer", "skilled", "--seed", seed, "--seconds", 0.3, "--mode", "assessment", "--participant",
                      f"P{seed % 3}") for seed in range(1, 9)]


def whole(path):
    """Nothing but whole attempts, and a file that SQLite itself finds sound."""
    with closing(sqlite3.connect(path)) as database:
        assert database.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
        assert database.execute("PRAGMA foreign_key_check").fetchall() == []
        counts = database.execute("SELECT (SELECT count(*) FROM recording r WHERE r.attempt = a.id), (SELECT count(*) FROM verification v WHERE "
                                  "v.attempt = a.id), (SELECT count(*) FROM checkpoint_value c WHERE c.attempt = a.id) FROM attempt a").fetchall()
        assert all(c[0] == 1 and c[1] == 1 and c[2] > 10 for c in counts), counts
        return len(counts)


def without_audit(path):
    held = content(path)
    del held["audit"]
    return {table: sorted(str(row) for row in rows) for table, rows in held.items()}


class Stress(program.ProgramTest):
    def reference(self):
        cohort = self.path("reference.db")
        self.well("assess", *runs(), "--cohort", cohort)
        return without_audit(cohort)

    def test_killed_at_random_moments(self):
        draw = program.seeded("assess killed")
        expected = self.reference()
        begin = time.monotonic()
        self.well("assess", *runs(), "--cohort", self.path("timed.db"))
        full = time.monotonic() - begin
        partly = 0
        for round_ in range(50 if program.HEAVY else 8):
            cohort = self.path(f"{round_}.db")
            process = subprocess.Popen([str(PROGRAM), "assess", *map(str, runs()), "--cohort", str(cohort)], stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            begin = time.monotonic()
            try:
                process.wait(timeout=draw.uniform(0.0, full))
                full = min(full, time.monotonic() - begin)  # the machine was busy when it was timed
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                process.wait()
            if cohort.exists() and query(cohort, "SELECT count(*) FROM sqlite_master")[0][0] > 0:
                partly += 0 < whole(cohort) < len(runs())
            self.well("assess", *runs(), "--cohort", cohort)
            self.assertEqual(whole(cohort), len(runs()))
            self.assertEqual(without_audit(cohort), expected)
        self.assertGreater(partly, 0, "no kill came in the middle")

    def test_two_at_once(self):
        expected = self.reference()
        cohort = self.path("c.db")
        orders = (runs(), list(reversed(runs())))
        both = [subprocess.Popen([str(PROGRAM), "assess", *map(str, order), "--cohort", str(cohort)], stdin=subprocess.DEVNULL,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) for order in orders]
        for process in both:
            error = process.communicate()[1]
            self.assertEqual((process.returncode, error), (0, b""))
        self.assertEqual(whole(cohort), len(runs()))
        # Numbers of rows tell the order of arrival; what is held does not.
        values = "SELECT uuid, name, subject, value, origin FROM checkpoint_value JOIN attempt ON attempt.id = attempt ORDER BY 1, 2, 3"
        self.assertEqual(query(cohort, values), query(self.path("reference.db"), values))
        self.assertEqual(len(content(cohort)["participant"]), len(expected["participant"]))

    def test_full_disk(self):
        # No file may grow beyond a limit, which SQLite meets as a disk that is full.
        cohort = self.path("c.db")
        self.well("assess", *runs()[:2], "--cohort", cohort)
        before = without_audit(cohort)
        room = 40000  # less than the log of one attempt

        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))

        answer = calot("assess", *runs(), "--cohort", cohort, before=limit)
        self.assertEqual(answer.code, 1, answer)
        self.assertOneLine(answer, cohort, "run again")
        whole(cohort)
        self.assertTrue(set(before["attempt"]) <= set(without_audit(cohort)["attempt"]))
        self.well("assess", *runs(), "--cohort", cohort)
        self.assertEqual(whole(cohort), len(runs()))
        # A merge that does not fit is none.
        small = self.path("small.db")
        self.well("assess", runs()[0], "--cohort", small)
        held = without_audit(small)
        answer = calot("cohort", "merge", small, cohort, before=limit)
        self.assertEqual(answer.code, 1, answer)
        self.assertOneLine(answer, small)
        self.assertEqual(without_audit(small), held)

    def older(self, name):
        """A database as the first two migrations make it, with a participant and an attempt."""
        old = self.path(name)
        with closing(sqlite3.connect(old)) as database:
            for file in ("0001_fixed.sql", "0002_rebuildable.sql"):
                database.executescript((SOURCE / "schemas/cohort" / file).read_text())
            database.execute("INSERT INTO participant (pseudonym, site, created_utc) VALUES ('P1', 'North', '2026-01-01T00:00:00Z')")
            database.execute("PRAGMA application_id = 1130458223")
            database.execute("PRAGMA user_version = 2")
            database.commit()
        return old

    def test_older_schema_is_kept_and_brought_up_to_date(self):
        old = self.older("old.db")
        was = content(old)
        answer = self.refused(1, "study", old, names=(old, "calot cohort upgrade"))
        self.assertEqual(content(old), was)
        self.assertNotIn("Traceback", answer.err)
        self.assertIn("schema", self.well("cohort", "upgrade", old).out)
        self.well("assess", runs()[0], "--cohort", old)
        backup = self.path("old.db.schema-2.bak")
        self.assertEqual(content(backup), was)
        self.assertEqual(query(backup, "PRAGMA user_version"), [(2,)])
        self.assertEqual(query(old, "SELECT name FROM site"), [("North",)])
        self.assertEqual(whole(old), 1)
        # Two at once.
        again = self.older("two.db")
        both = [subprocess.Popen([str(PROGRAM), "participant", "add", f"N{i}", "--cohort", str(again)], stdin=subprocess.DEVNULL,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) for i in range(2)]
        for process in both:
            error = process.communicate()[1]
            self.assertEqual((process.returncode, error), (0, b""))
        self.assertEqual(query(again, "SELECT count(*) FROM participant"), [(3,)])

    def test_no_room_for_the_backup(self):
        old = self.older("old.db")
        was = content(old)

        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (40000, 40000))

        answer = calot("participant", "add", "P2", "--cohort", old, before=limit)
        self.assertEqual(answer.code, 1, answer)
        self.assertOneLine(answer, old, "backed up")
        self.assertEqual(content(old), was)
        self.assertNothingHalfWritten()

    def test_newer_schema_is_refused_by_everything(self):
        cohort = self.path("c.db")
        self.well("assess", runs()[0], "--cohort", cohort)
        with edited(cohort) as database:
            version = database.execute("PRAGMA user_version").fetchone()[0]
            database.execute(f"PRAGMA user_version = {version + 1}")
        before = content(cohort)
        other = self.path("other.db")
        self.well("participant", "add", "P", "--cohort", other)
        shutil.copyfile(cohort, self.path("copy.db"))
        for command in (("study", cohort), ("regrade", cohort, self.path(".")), ("cohort", "check", cohort), ("cohort", "list", cohort),
                        ("cohort", "merge", other, cohort), ("cohort", "merge", cohort, other), ("cohort", "scrub", cohort),
                        ("attempt", "exclude", "0", "--cohort", cohort, "--reason", "r", "--by", "b"),
                        ("participant", "withdraw", "P1", "--cohort", cohort, "--scope", "all", "--no-recordings"),
                        ("cohort", "name", "x", "--cohort", cohort), ("assess", runs()[1], "--cohort", cohort)):
            self.refused(5, *command, names=(cohort, "newer"))
        self.assertEqual(content(cohort), before)


if __name__ == "__main__":
    program.main()
