# SPDX-License-Identifier: GPL-3.0-or-later
"""Databases that were edited, damaged or copied at the wrong moment: calot cohort check finds each, and no figure is shown of them. Cohorts
on a file system that grants no locks."""

import json
import os
import shutil
import sqlite3
import struct
import subprocess
from contextlib import closing

import h5py
import program
import recording_file
from cohort_content import content, edited, figures, query
from program import PROGRAM, calot, recording, short

VALUE = "UPDATE checkpoint_value SET {} WHERE availability = 0 AND name = '{}'"


def runs():
    return [recording(f"checked-{who}-{seed}", "--performer", who, "--seed", seed, "--seconds", 1, "--mode", "assessment", "--purpose", "study")
            for who in ("skilled", "unskilled") for seed in (1, 2, 3)]


def unchecked(database, table, remove):
    """Takes a constraint out of a table's definition."""
    database.execute("PRAGMA writable_schema = ON")
    database.execute("UPDATE sqlite_master SET sql = replace(sql, ?, '') WHERE name = ?", (remove, table))


class Edited(program.ProgramTest):
    made = []  # a cohort with a norm, that each test copies

    def setUp(self):
        super().setUp()
        self.who = ("--group-by", "performer", "--include-synthetic")
        if not self.made:
            made = runs()[0].with_name("made.db")
            self.well("assess", *runs(), "--cohort", made)
            self.well("norm", "create", made, "n", "--by", "test", "--rule", "at-least:1", "--checkpoints", "all", *self.who)
            self.assertIn("sound", self.well("cohort", "check", made).out)
            self.made.append(made)
        self.cohort = self.copy(self.made[0], "c.db")

    def found(self, *words, code=4):
        """By the check, and by all that shows figures."""
        attempt = "0" * 8
        for command in (("cohort", "check", self.cohort), ("study", self.cohort, *self.who), ("grade", self.cohort, "--attempt", attempt),
                        ("norm", "create", self.cohort, "m", "--by", "test", "--rule", "at-least:1", "--checkpoints", "all", *self.who)):
            answer = calot(*command)
            self.assertEqual(answer.code, code, answer)
            self.assertOneLine(answer, self.cohort, *words)

    def edit(self, *statements):
        with edited(self.cohort) as database:
            database.execute("PRAGMA ignore_check_constraints = ON")
            for statement in statements:
                database.execute(statement)

    def test_one_bit_of_a_stored_figure(self):
        value = query(self.cohort, "SELECT value FROM checkpoint_value WHERE name = 'path-length' AND value > 0")[0][0]
        held = bytearray(self.cohort.read_bytes())
        at = held.index(struct.pack(">d", value))
        held[at + 6] ^= 4
        self.cohort.write_bytes(held)
        with closing(sqlite3.connect(self.cohort)) as database:
            self.assertEqual(database.execute("PRAGMA integrity_check").fetchall(), [("ok",)])  # SQLite sees nothing
        self.found(f"page {at // 4096 + 1} ", "restore a copy")

    def test_another_program_writes(self):
        with closing(sqlite3.connect(self.cohort)) as database:
            database.execute(VALUE.format("value = value * 2", "path-length"))
            database.commit()
        self.found("page", "another program")

    def test_another_programs_trigger(self):
        self.edit("CREATE TRIGGER gone AFTER INSERT ON attempt BEGIN DELETE FROM attempt; END")
        self.found("trigger gone is not one of Calot's")

    def test_further_table_view_and_index(self):
        self.edit("CREATE TABLE notes (x TEXT)", "CREATE VIEW seen AS SELECT 1", "CREATE INDEX quick ON attempt (seed)")
        said = calot("cohort", "check", self.cohort)
        for words in ("table notes", "view seen", "index quick"):
            self.assertIn(words + " is not one of Calot's", said.out)
        self.found("3 faults")

    def test_constraint_that_was_taken_out(self):
        with edited(self.cohort) as database:
            unchecked(database, "verification", " CHECK (verdict BETWEEN 0 AND 4)")
        with edited(self.cohort) as database:
            database.execute("UPDATE verification SET verdict = 7")
        self.found("table verification is not as Calot makes it")

    def test_value_that_a_constraint_forbids(self):
        self.edit("UPDATE verification SET verdict = 7 WHERE attempt = 1")
        self.found("CHECK constraint failed in verification")

    def test_figure_that_cannot_be(self):
        for sql, words in ((VALUE.format("value = 9e999", "path-length"), "checkpoint_value.value are not finite"),
                           (VALUE.format("value = -value", "path-length"), "values of path-length cannot be, as -"),
                           (VALUE.format("value = 2.5", "instrument-clashes"), "values of instrument-clashes cannot be, as 2.5"),
                           (VALUE.format("unit = 'mm'", "path-length"), "values of path-length cannot be, as 0.")):
            with self.subTest(words):
                whole = self.cohort.read_bytes()
                self.edit(sql)
                self.found(words)
                self.cohort.write_bytes(whole)

    def test_cut_off(self):
        whole = self.cohort.read_bytes()
        for keep in (len(whole) - 4096, len(whole) - 100, 5000):
            self.cohort.write_bytes(whole[:keep])
            self.found("")

    def test_copy_while_a_commit_is_under_way(self):
        held = bytearray(self.cohort.read_bytes())
        for at in range(4088, 4096):
            held[at] ^= 0xFF
        self.cohort.write_bytes(held)
        self.found("copy that was taken while a program wrote to it")

    def test_header_that_denies_the_sums(self):
        held = bytearray(self.cohort.read_bytes())
        held[20] = 0
        self.cohort.write_bytes(held)
        self.found("no checksums")

    def test_the_file_alone_is_the_database(self):
        self.assertEqual([p.name for p in self.folder.iterdir()], ["c.db"])
        copy = self.copy(self.cohort, "copy.db")
        self.assertEqual(content(copy), content(self.cohort))
        self.assertEqual(query(copy, "PRAGMA journal_mode"), [("delete",)])


class Refused(program.ProgramTest):
    def test_refused_recording_leaves_no_database(self):
        bad = self.path("bad.h5")
        bad.write_bytes(short().read_bytes()[:5000])
        for refused in (bad, self.path("none.h5")):
            self.assertEqual(calot("assess", refused, "--cohort", self.path("c.db")).code, 4)
            self.assertFalse(self.path("c.db").exists())

    def test_no_steps_prove_nothing(self):
        none = self.copy(recording("one-step", "--performer", "skilled", "--seconds", 0.001), "none.h5")
        with h5py.File(none, "r+") as file:
            file.visititems(lambda name, part: part.resize(0, axis=0)
                            if isinstance(part, h5py.Dataset) and part.maxshape[:1] == (None,) and name != "status" else None)
            last = file["/status"][-1]
            last["ticks"] = last["steps"] = 0
            file["/status"][-1] = last
            recording_file.reseal(file)
        self.refused(5, "replay", none, names=(none,))
        self.refused(5, "assess", none, "--cohort", self.path("c.db"), names=(none,))
        self.assertFalse(self.path("c.db").exists())

    def test_changed_simulation_version_breaks_the_chain(self):
        for version in (0, 1, 11, 12, 999):
            r = self.copy(short(), f"{version}.h5")
            with h5py.File(r, "r+") as file:
                recording_file.put_attribute(file, "simulation_version", version)
            answer = calot("replay", r)
            self.assertIn(answer.code, (3, 4), answer)  # 4: nor does its scene fit that version
            self.assertOneLine(answer, r, "content chain broken")


class NoLocks(program.ProgramTest):
    def setUp(self):
        super().setUp()
        if not shutil.which("cc"):
            self.skipTest("no C compiler")
        library = self.path("no_locks.so")
        subprocess.run(["cc", "-shared", "-fPIC", "-o", library, program.SOURCE / "tests/command_line/no_locks.c", "-ldl"], check=True)
        self.without = {"LD_PRELOAD": str(library)}
        self.cohort = self.path("c.db")
        self.lock = self.path("c.db.lock")

    def add(self, name):
        return ("participant", "add", name, "--cohort", self.cohort)

    def test_written_and_read(self):
        with_locks = self.path("with.db")
        self.well("assess", *runs(), "--cohort", with_locks)
        self.well("cohort", "merge", self.cohort, with_locks, environment=self.without)
        self.assertIn("sound", self.well("cohort", "check", self.cohort, environment=self.without).out)
        study = ("--group-by", "performer", "--include-synthetic", "--json")
        said = [json.loads(self.well("study", file, *study, environment=self.without).out)["rows"] for file in (self.cohort, with_locks)]
        self.assertEqual(*said)
        self.assertFalse(self.lock.exists())
        self.assertEqual(figures(self.cohort), figures(with_locks))

    def test_one_writer_at_a_time(self):
        self.well(*self.add("P0"), environment=self.without)
        many = [subprocess.Popen([str(PROGRAM), *map(str, self.add(f"P{i}"))], env={**os.environ, **self.without}, stderr=subprocess.PIPE,
                                 stdout=subprocess.DEVNULL) for i in range(1, 7)]
        for process in many:
            error = process.communicate()[1]
            self.assertEqual((process.returncode, error), (0, b""))
        self.assertEqual(query(self.cohort, "SELECT count(*) FROM participant"), [(7,)])
        self.assertFalse(self.lock.exists())

    def test_locks_of_others(self):
        self.well(*self.add("P0"), environment=self.without)
        gone = subprocess.Popen(["true"])
        gone.wait()
        host = os.uname().nodename
        self.lock.mkdir()
        (self.lock / f"{host}.{gone.pid}").touch()
        self.well(*self.add("P1"), environment=self.without)  # whose process is dead
        self.assertFalse(self.lock.exists())
        self.lock.mkdir()
        for holder in (f"{host}.{os.getpid()}", "elsewhere.77"):
            (self.lock / holder).touch()
            self.refused(1, *self.add("P2"), environment=self.without, names=(self.lock, holder, "remove"))
            (self.lock / holder).unlink()
        self.lock.rmdir()
        self.well(*self.add("P2"), environment=self.without)


if __name__ == "__main__":
    program.main()
