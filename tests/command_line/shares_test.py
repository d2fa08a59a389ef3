# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings assessed in shares, a database a machine, and merged: the same rows as one machine's."""

import atexit
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import program
from cohort_content import content, figures, query
from cohort_test import change
from program import PROGRAM, SOURCE, calot

COUNT = 16
_store = []


def recordings():
    """A folder of short attempts and the cohort `c.db` of one machine, made once."""
    if not _store:
        _store.append(pathlib.Path(tempfile.mkdtemp(prefix="calot-shares-")))
        atexit.register(shutil.rmtree, _store[0], ignore_errors=True)
        subprocess.run([sys.executable, SOURCE / "scripts/attempts.py", _store[0], "--count", str(COUNT), "--seconds", "0.3", "--calot", PROGRAM,
                        "--jobs", "2"], check=True, stdout=subprocess.DEVNULL)
        assessed = calot("assess", _store[0], "--cohort", _store[0] / "c.db")
        assert assessed.code == 0, assessed
    return _store[0]


class Shares(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.recordings = recordings()
        self.cohort = self.copy(self.recordings / "c.db", "c.db")

    def stale(self):
        """A cohort whose values are old, in several ways."""
        change(self.cohort, "UPDATE checkpoint_value SET version = 0, value = value * 2 WHERE name = 'path-length' AND attempt % 2 = 0")
        change(self.cohort, "DELETE FROM checkpoint_value WHERE name = 'max-force' AND attempt % 3 = 0")
        change(self.cohort, "UPDATE verification SET software = 'calot 0.0.1' WHERE attempt % 5 = 0")

    def share(self, number):
        return self.path(f"share-{number}.db")

    def assess(self, of, numbers=None):
        for number in numbers or range(1, of + 1):
            self.well("assess", self.recordings, "--cohort", self.share(number), "--share", f"{number}/{of}", "--jobs", 1 + number % 2)
        return [self.share(number) for number in numbers or range(1, of + 1)]

    def newer(self, files):
        return json.loads(self.well("cohort", "merge", self.cohort, *files, "--newer", "--json").out)

    def test_merged_shares_hold_the_rows_of_one_machine(self):
        merged = self.path("merged.db")
        self.well("cohort", "merge", merged, *self.assess(7))
        self.assertEqual(figures(merged), figures(self.cohort))
        self.assertIn("nothing new", self.well("cohort", "merge", merged, self.share(3)).out)

    def test_newer_values_are_those_of_regrading(self):
        files = self.assess(5)
        self.stale()
        alone = self.copy(self.cohort, "alone.db")
        before = content(self.cohort)
        report = self.newer(files[3:] + files[:3])
        regraded = json.loads(self.well("regrade", alone, self.recordings, "--json").out)
        self.assertEqual([(a["attempt"], a["result"], a["changes"]) for a in report["attempts"]],
                         [(a["attempt"], a["result"], a["changes"]) for a in regraded["attempts"]])
        self.assertEqual({a["result"] for a in report["attempts"]}, {"changed", "unchanged"})
        self.assertEqual(content(self.cohort), content(alone))
        self.assertNotEqual(content(self.cohort), before)
        self.assertEqual({a["result"] for a in self.newer(files)["attempts"]}, {"unchanged"})
        self.assertIn(f"{COUNT} attempts: 0 changed, {COUNT} unchanged", self.well("cohort", "merge", self.cohort, *files, "--newer").out)

    def test_older_values_do_not_count(self):
        files = self.assess(1)
        change(files[0], "UPDATE verification SET verified_utc = '2000-01-01T00:00:00Z'")
        change(files[0], "UPDATE checkpoint_value SET value = value * 2 WHERE name = 'path-length'")
        before = content(self.cohort)
        self.assertEqual({a["result"] for a in self.newer(files)["attempts"]}, {"unchanged"})
        self.assertEqual(content(self.cohort), before)

    def test_attempts_that_no_share_holds_are_named(self):
        answer = calot("cohort", "merge", self.cohort, *self.assess(4, (1, 2, 4)), "--newer")
        self.assertEqual(answer.code, 4, answer)
        self.assertEqual(answer.err.count("assessed in none of the databases"), 4)
        self.assertIn(", 4 missing", answer.out)

    def test_newer_adds_nothing(self):
        half = self.path("half.db")
        self.well("assess", *sorted(self.recordings.rglob("*.h5"))[:COUNT // 2], "--cohort", half)
        report = json.loads(self.well("cohort", "merge", half, *self.assess(2), "--newer", "--json").out)
        self.assertEqual(len(report["attempts"]), COUNT // 2)

    def test_killed_share_goes_on(self):
        run = ("assess", self.recordings, "--cohort", self.share(1), "--share", "1/1")
        process = subprocess.Popen([PROGRAM, *map(str, run)], stdout=subprocess.DEVNULL)
        stored = 0
        while stored < 3:
            self.assertIsNone(process.poll())
            time.sleep(0.02)
            if self.share(1).exists():
                try:
                    stored = query(self.share(1), "SELECT count(*) FROM verification")[0][0]
                except Exception:  # the schema is not there yet
                    stored = 0
        process.send_signal(signal.SIGKILL)
        process.wait()
        stored = query(self.share(1), "SELECT count(*) FROM verification")[0][0]
        answer = calot(*run)
        self.assertEqual(answer.code, 0, answer)
        self.assertIn(f"{stored} of {COUNT} recordings", answer.err)
        self.assertEqual(figures(self.share(1)), figures(self.cohort))

    def test_wrong_shares(self):
        for wrong in ("", "0/8", "9/8", "3", "x/y"):
            answer = calot("assess", self.recordings, "--cohort", self.share(1), "--share", wrong)
            self.assertEqual(answer.code, 2, answer)
        answer = calot("assess", self.recordings, "--share", "1/2")
        self.assertEqual(answer.code, 2, answer)
        self.assertFalse(self.share(1).exists())


if __name__ == "__main__":
    program.main()
