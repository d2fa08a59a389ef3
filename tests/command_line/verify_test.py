# SPDX-License-Identifier: GPL-3.0-or-later
"""calot verify --watch: recordings are taken into a cohort as they come, whatever happens to them, to the program and to the machine's patience."""

import json
import queue
import shutil
import signal
import sqlite3
import subprocess
import threading
import time
from contextlib import closing

import program
import recording_file
from cohort_content import content, query
from program import PROGRAM, calot, recording

QUICK = {"quiet": 0.2, "rescan": 0.5, "settle": 1.5}


def waits(**other):
    """How long things are waited for: short, unless a test says otherwise."""
    return [part for name, seconds in {**QUICK, **other}.items() for part in (f"--{name}", str(seconds))]


def attempt(seed, *more):
    return recording(f"watched-{seed}", "--performer", "skilled", "--seed", seed, "--seconds", 0.3, "--mode", "assessment", "--purpose", "study",
                     "--participant", f"P{seed}", *more)


class Watched(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.inbox, self.cohort = self.path("inbox"), self.path("c.db")
        self.inbox.mkdir()

    def put(self, seed, name=None):
        """As a careful copy does: a temporary name first."""
        target = self.inbox / (name or f"{seed}.h5")
        target.parent.mkdir(parents=True, exist_ok=True)
        part = target.with_name("." + target.name + ".copy")
        shutil.copyfile(attempt(seed), part)
        part.rename(target)
        return target

    def once(self):
        answer = calot("verify", "--watch", self.inbox, "--cohort", self.cohort, "--once", "--json", *waits())
        return answer, [json.loads(line) for line in answer.out.splitlines()]

    def start(self, **other):
        watcher = subprocess.Popen([PROGRAM, "verify", "--watch", self.inbox, "--cohort", self.cohort, "--json", *waits(**other)],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        watcher.lines = queue.Queue()
        watcher.reader = threading.Thread(target=lambda: [watcher.lines.put(json.loads(line)) for line in watcher.stdout], daemon=True)
        watcher.reader.start()
        self.addCleanup(self.end, watcher)
        return watcher

    def end(self, watcher, how=signal.SIGTERM):
        if watcher.poll() is None:
            watcher.send_signal(how)
        code = watcher.wait(30)
        watcher.reader.join()
        watcher.stdout.close()
        self.assertEqual(watcher.stderr.read() if not watcher.stderr.closed else "", "")
        watcher.stderr.close()
        return code

    def line(self, watcher):
        return watcher.lines.get(timeout=60)

    def quiet(self, watcher, seconds=2.0):
        with self.assertRaises(queue.Empty):
            raise AssertionError(watcher.lines.get(timeout=seconds))

    def test_files_that_come_while_it_watches(self):
        self.put(1)
        watcher = self.start(rescan=600)  # what comes later is noticed, not found
        first = self.line(watcher)
        self.assertEqual((first["file"], first["result"], first["report"]["verdict"]), (str(self.inbox / "1.h5"), "added", "bit-exact"))
        self.put(2)
        self.assertEqual(self.line(watcher)["result"], "added")
        self.put(3, "later/deep/3.h5")  # in folders that were not there
        self.assertEqual(self.line(watcher)["file"], str(self.inbox / "later/deep/3.h5"))
        (self.inbox / "notes.txt").write_text("no recording")
        self.put(1, "copy.h5")
        self.assertEqual(self.line(watcher)["result"], "known")
        self.quiet(watcher)
        self.assertEqual(self.end(watcher, signal.SIGINT), 0)
        alone = self.path("alone.db")
        self.well("assess", *(attempt(n) for n in (1, 2, 3)), "--cohort", alone)
        values = "SELECT uuid, name, subject, value, reason FROM checkpoint_value JOIN attempt ON attempt.id = attempt ORDER BY 1, 2, 3"
        self.assertEqual(query(self.cohort, values), query(alone, values))
        self.assertEqual(query(self.cohort, "SELECT verdict FROM verification"), [(0,)] * 3)

    def test_recording_in_progress_waits_until_it_is_finished(self):
        watcher = self.start(settle=60)
        process = subprocess.Popen([PROGRAM, "record", "--scene", program.SCENE, "--performer", "skilled", "--seed", "9", "--seconds", "3", "--paced",
                                    "-o", self.inbox / "live.h5"], stdout=subprocess.DEVNULL)
        line = self.line(watcher)
        self.assertIsNotNone(process.poll())
        self.assertTrue(line["report"]["complete"])
        self.assertEqual(line["report"]["steps"], 300)
        self.quiet(watcher, 1.0)

    def test_recording_whose_writer_was_killed_is_taken_as_incomplete(self):
        process = subprocess.Popen([PROGRAM, "record", "--scene", program.SCENE, "--performer", "skilled", "--seed", "9", "--seconds", "60", "--paced",
                                    "-o", self.inbox / "live.h5"], stdout=subprocess.DEVNULL)
        recording_file.await_steps(self.inbox / "live.h5", process)
        process.kill()
        process.wait()
        answer, rows = self.once()
        if not rows:  # it had not rested long enough
            self.assertIn(": 1 recording\n", answer.err)
            time.sleep(2)
            answer, rows = self.once()
        self.assertEqual([(r["result"], r["report"]["complete"]) for r in rows], [("added", False)])

    def test_killed_in_mid_queue_nothing_is_lost_and_nothing_twice(self):
        for seed in range(1, 7):
            self.put(seed)
        told, killed = [], 0
        while len({line["file"] for line in told}) < 6:
            watcher = self.start()
            told.append(self.line(watcher))
            if killed < 3:
                time.sleep(0.05 * killed)
                self.end(watcher, signal.SIGKILL)
                killed += 1
            while len({line["file"] for line in told}) < 6 and watcher.poll() is None:
                told.append(self.line(watcher))
            while not watcher.lines.empty():
                told.append(watcher.lines.get())
        self.assertEqual(killed, 3)
        self.quiet(watcher, 1.0)
        self.end(watcher)
        self.assertEqual(query(self.cohort, "SELECT count(*), count(DISTINCT uuid) FROM attempt"), [(6, 6)])
        self.assertEqual(query(self.cohort, "SELECT count(*) FROM audit WHERE action = 'attempt-import'"), [(6,)])
        self.assertLessEqual(len(told), 6 + killed)  # a kill between storing and entering repeats one line
        self.assertEqual({line["result"] for line in told} - {"added", "known"}, set())
        self.assertEqual(self.once()[1], [])

    def test_damaged_file_is_told_once_until_it_changes(self):
        bad = self.put(1)
        recording_file.flip_stored_byte(bad, "/ticks/left/force", 0)
        time.sleep(1.6)
        answer, rows = self.once()
        self.assertEqual((answer.code, [r["result"] for r in rows]), (4, ["damaged"]))
        self.assertFalse(self.cohort.exists())
        self.assertIn("/ticks/left/force", rows[0]["message"])
        self.put(2)
        watcher = self.start()
        self.assertEqual(self.line(watcher)["file"], str(self.inbox / "2.h5"))
        self.quiet(watcher)
        self.put(1)
        self.assertEqual(self.line(watcher)["result"], "added")

    def test_copy_in_progress_is_no_damage(self):
        whole = attempt(1).read_bytes()
        target = self.inbox / "slow.h5"
        watcher = self.start(settle=5)
        with open(target, "wb") as file:
            for begin in range(0, len(whole), len(whole) // 6):
                file.write(whole[begin:begin + len(whole) // 6])
                file.flush()
                time.sleep(0.5)
        self.assertEqual(self.line(watcher)["result"], "added")
        self.quiet(watcher, 1.0)

    def test_conflicts_are_told_once(self):
        self.put(1)
        self.once()
        recording_file.set_attribute(self.copy(attempt(1), "other.h5"), "participant", b"P77")
        shutil.copy(self.path("other.h5"), self.inbox / "other.h5")
        before = content(self.cohort)
        answer, rows = self.once()
        self.assertEqual((answer.code, [r["result"] for r in rows]), (3, ["refused"]), answer)
        self.assertIn("conflict", rows[0]["message"])
        self.assertEqual(content(self.cohort), before)
        self.assertEqual(self.once()[1], [])

    def test_machine_in_the_way_is_tried_again(self):
        self.put(1)
        self.once()
        self.put(2)
        with closing(sqlite3.connect(self.cohort)) as database:
            database.execute("BEGIN IMMEDIATE")
            answer, rows = self.once()
            self.assertEqual((answer.code, [(r["result"], r["retry_in_seconds"]) for r in rows]), (1, [("failed", 10)]), answer)
            database.rollback()
        answer, rows = self.once()  # not due yet
        self.assertEqual((answer.code, rows), (1, []))
        text = self.path("c.db.intake").read_text()
        self.assertIn('"tries":1', text)
        time.sleep(10.5)
        self.assertEqual([r["result"] for r in self.once()[1]], ["added"])

    def test_journal_that_is_cut_off_or_lost_costs_no_second_storing(self):
        for seed in (1, 2, 3):
            self.put(seed)
        self.once()
        before = content(self.cohort)
        journal = self.path("c.db.intake")
        journal.write_bytes(journal.read_bytes()[:-10])
        self.assertEqual([r["result"] for r in self.once()[1]], ["known"])
        journal.unlink()
        self.assertEqual([r["result"] for r in self.once()[1]], ["known"] * 3)
        self.assertEqual(content(self.cohort), before)
        journal.write_text("my diary\n")
        self.refused(4, "verify", "--watch", self.inbox, "--cohort", self.cohort, "--once", names=(journal,))
        self.assertEqual(journal.read_text(), "my diary\n")

    def test_stops_at_once_and_keeps_the_queue(self):
        shutil.copyfile(recording("watched-long", "--performer", "skilled", "--seed", 5, "--seconds", 20), self.inbox / "long.h5")
        watcher = self.start()
        while not self.path("c.db.intake").exists():
            time.sleep(0.05)
        time.sleep(0.3)
        begin = time.monotonic()
        self.assertEqual(self.end(watcher), 0)
        self.assertLess(time.monotonic() - begin, 2.0)
        self.assertTrue(watcher.lines.empty())
        self.assertEqual([r["result"] for r in self.once()[1]], ["added"])

    def test_two_watchers_of_one_journal_and_usage(self):
        watcher = self.start()
        while not self.path("c.db.intake").exists():
            time.sleep(0.05)
        answer = self.once()[0]
        self.assertEqual(answer.code, 1)
        self.assertOneLine(answer, "c.db.intake")
        self.end(watcher)
        self.refused(2, "verify", "--cohort", self.cohort)
        self.refused(2, "verify", "--watch", self.inbox)
        self.refused(4, "verify", "--watch", self.path("none"), "--cohort", self.cohort, names=("none",))
        other = self.path("other.db")
        other.write_text("no database")
        self.put(9)
        self.refused(4, "verify", "--watch", self.inbox, "--cohort", other, "--once", names=(other,))
        self.assertEqual(sorted(p.name for p in self.folder.glob("other*")), ["other.db"], "a journal was left")
        (self.inbox / "9.h5").unlink()
        out = self.well("verify", "--watch", self.inbox, "--cohort", self.cohort, "--once").out
        self.assertEqual(out, "")
        self.put(1)
        out = self.well("verify", "--watch", self.inbox, "--cohort", self.cohort, "--once").out
        self.assertEqual(out, f"{self.inbox / '1.h5'}: verified, added\n")


if __name__ == "__main__":
    program.main()
