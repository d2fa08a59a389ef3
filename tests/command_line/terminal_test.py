# SPDX-License-Identifier: GPL-3.0-or-later
"""What commands show on a terminal: tables and sentences within its columns, numbers whole, progress from the beginning."""

import collections
import fcntl
import json
import os
import pathlib
import pty
import re
import select
import shutil
import struct
import subprocess
import tempfile
import termios
import time

import program
from program import PROGRAM, calot, recording

WIDTHS = (60, 80, 132)
NOTE = "Columns left out to fit "
NUMBER = re.compile(r"(?<![\w.-])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.])")
OF_PERFORMERS = ("--include-synthetic", "--group-by", "performer")
_cohort = []
_answers = {}


def cohort():
    """Two recordings of each profile in assessment mode beside their database with a norm."""
    if not _cohort:
        folder = pathlib.Path(tempfile.mkdtemp(prefix="calot-cli-"))
        program.atexit.register(shutil.rmtree, folder, ignore_errors=True)
        for profile in ("skilled", "unskilled"):
            for seed in range(3):
                made = recording(f"{profile}{seed}", "--performer", profile, "--seed", seed + 1, "--seconds", 3, "--mode", "assessment")
                shutil.copyfile(made, folder / made.name)
        for arguments in (("assess", *sorted(folder.glob("*.h5")), "--cohort", folder / "c.db"),
                          ("norm", "create", folder / "c.db", "clinic", "--by", "test", "--rule", "at-least:1", "--groups", "skilled,unskilled",
                           "--better", "skilled", "--fixed", "path-length left<=200", *OF_PERFORMERS)):
            answer = calot(*arguments)
            if answer.code != 0:
                raise AssertionError(answer)
        _cohort.append(folder)
    return _cohort[0]


class Shown:
    """What a terminal got: whole texts, and in which order the two streams began."""

    def __init__(self, code, out, err, began):
        self.code, self.out, self.err, self.began = code, out, err, began

    def __repr__(self):
        return f"exit {self.code}\n--- stdout\n{self.out}\n--- stderr\n{self.err!r}"


def terminal(columns, *arguments):
    """Runs the program with stdout and stderr on two terminals of this width."""
    streams = {}
    ends = []
    for name in ("err", "out"):
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
        streams[ours] = name
        ends.append(theirs)
    child = subprocess.Popen([str(PROGRAM), *map(str, arguments)], stdin=subprocess.DEVNULL, stderr=ends[0], stdout=ends[1])
    for end in ends:
        os.close(end)
    text = {"err": b"", "out": b""}
    began = []
    open_streams = list(streams)
    until = time.monotonic() + program.PATIENCE
    while open_streams:
        ready, _, _ = select.select(open_streams, [], [], max(0.0, until - time.monotonic()))
        if not ready:
            child.kill()
            raise AssertionError("the program hangs")
        for ours in sorted(ready):  # stderr first: what was there when the result began stands before it
            try:
                data = os.read(ours, 65536)
            except OSError:  # the last writer has closed it
                data = b""
            if not data:
                open_streams.remove(ours)
                os.close(ours)
                continue
            if not text[streams[ours]]:
                began.append(streams[ours])
            text[streams[ours]] += data
    return Shown(child.wait(), text["out"].decode().replace("\r\n", "\n"), text["err"].decode(), began)


def tables(text):
    """Of each table the titles of its columns, and those that a note below says are left out."""
    found = []
    lines = text.splitlines()
    for i, line in enumerate(lines):
        if i == 0 or not re.fullmatch(r"-+(  -+)*", line):
            continue
        titles = [lines[i - 1][at.start():at.end()].strip() or "remarks" for at in re.finditer("-+", line)]
        below = []
        for more in lines[i + 1:]:
            if not more or re.fullmatch(r"-+(  -+)*", more):
                break
            below.append(more)
        note = re.search(NOTE + r"\d+ characters: (.*?)\. ", " ".join(below) + " ")
        found.append((titles, note.group(1).split(", ") if note else []))
    return found


class Terminal(program.ProgramTest):
    def setUp(self):
        super().setUp()
        for file in cohort().iterdir():
            shutil.copyfile(file, self.folder / file.name)
        self.database = self.path("c.db")
        self.recording = sorted(self.folder.glob("unskilled*.h5"))[0]
        self.attempt = json.loads(self.well("inspect", self.recording, "--json").out)["attempt"]["attempt_uuid"]

    def commands(self):
        """Those that print tables or much text."""
        return {
            "assess": ("assess", self.recording, "--cohort", self.path("own.db")),
            "study": ("study", self.database, *OF_PERFORMERS),
            "study --all": ("study", self.database, *OF_PERFORMERS, "--all"),
            "grade": ("grade", self.database, "--attempt", self.attempt, "--norm", "clinic"),
            "norm show": ("norm", "show", "clinic", "--cohort", self.database),
            "norm list": ("norm", "list", self.database),
            "inspect": ("inspect", self.recording),
            "attempt list": ("attempt", "list", "--cohort", self.database),
            "cohort check": ("cohort", "check", self.database),
            "scenes": ("scenes",),
            "replay": ("replay", self.recording),
        }

    def answers(self, name):
        """What a command prints into a pipe, and on a terminal of each width: run once for all tests."""
        if name not in _answers:
            found = {}
            for columns in (None, *WIDTHS):
                self.path("own.db").unlink(missing_ok=True)
                found[columns] = calot(*self.commands()[name]) if columns is None else terminal(columns, *self.commands()[name])
                self.assertEqual(found[columns].code, 0, found[columns])
            _answers[name] = found
        return _answers[name][None], {columns: _answers[name][columns] for columns in WIDTHS}

    def test_every_line_fits_and_every_number_is_whole(self):
        for name in self.commands():
            whole, narrow = self.answers(name)
            for columns, shown in narrow.items():
                with self.subTest(command=name, columns=columns):
                    for line in shown.out.splitlines():
                        self.assertTrue(len(line) <= columns or len(line.split()) == 1, f"{len(line)}: {line}")
                    self.assertNumbersOf(whole.out, shown.out, columns)

    def assertNumbersOf(self, whole, shown, columns):
        """All numbers of a narrow text are those of the whole one; where nothing is left out, both have all."""
        def numbers(text):
            return collections.Counter(NUMBER.findall(re.sub(NOTE + r"\d+|[\d.]+ x real time", "", " ".join(text.split()))))

        got, wanted = numbers(shown), numbers(whole)
        self.assertEqual(got - wanted, collections.Counter())
        left = [note for _, note in tables(shown) if note]
        if not left:
            self.assertEqual(wanted - got, collections.Counter())
        self.assertEqual(len(left), " ".join(shown.split()).count(NOTE + str(columns)))

    def test_the_note_names_the_columns_that_are_missing(self):
        seen = 0
        for name in self.commands():
            pipe, narrow = self.answers(name)
            whole = tables(pipe.out)
            for columns, answer in narrow.items():
                with self.subTest(command=name, columns=columns):
                    shown = tables(answer.out)
                    self.assertEqual(len(shown), len(whole))
                    for (titles, left), (all_titles, none) in zip(shown, whole):
                        self.assertEqual(none, [], "a pipe has every column")
                        self.assertEqual(collections.Counter(titles + left), collections.Counter(all_titles))
                        self.assertEqual(titles[0], all_titles[0])
                        seen += len(left)
        self.assertGreater(seen, 0)

    def test_counts_are_whole(self):
        values = json.loads(self.well("assess", self.recording, "--cohort", self.path("j.db"), "--json").out)["recordings"][0]["checkpoints"]
        counts = {v["subject"]: v["value"] for v in values if v["name"] == "movements"}
        self.assertTrue(counts)
        for arguments in (self.commands()["assess"], self.commands()["grade"]):
            said = self.well(*arguments).out
            for hand, value in counts.items():
                row = re.search(rf"^movements {hand} .*$", said, re.MULTILINE).group()
                self.assertIn(f"{value:.0f}", row.split())
                self.assertNotRegex(row, rf" {value:.0f}\.")

    def test_progress_begins_before_the_work_and_is_taken_away(self):
        longer = {
            "assess several": ("assess", *sorted(self.folder.glob("*.h5")), "--cohort", self.path("own.db")),
            "replay several": ("replay", *sorted(self.folder.glob("*.h5")), "--jobs", 2),
            "norm create": ("norm", "create", self.database, "again", "--by", "test", "--rule", "at-least:1", "--groups", "skilled,unskilled",
                            "--better", "skilled", "--fixed", "path-length left<=200", *OF_PERFORMERS),
            "regrade": ("regrade", self.database),
            "record": ("record", "--scene", "touch-liver", "--performer", "skilled", "--seconds", 0.2, "-o", self.path("new.h5")),
            "export": ("export", self.recording, "--csv", self.path("csv")),
        }
        quick = ("norm show", "norm list", "attempt list", "scenes")
        for name, arguments in {**longer, **{n: a for n, a in self.commands().items() if n not in quick}}.items():
            self.path("own.db").unlink(missing_ok=True)
            with self.subTest(command=name):
                shown = terminal(60, *arguments)
                self.assertEqual(shown.code, 0, shown)
                self.assertEqual(shown.began, ["err", "out"], "words of progress come before any result")
                drawn = shown.err.split("\r\x1b[K")
                self.assertEqual((drawn[0], drawn[-1]), ("", ""), "drawn at the line's beginning, taken away at the end")
                self.assertRegex(drawn[1], r"^[A-Z][^%\n]* \.\.\.$", "said before the first part is done")
                for line in drawn:
                    self.assertLess(len(line), 60)
                    self.assertNotIn("\n", line)

    def test_progress_of_one_recording_goes_on_while_it_is_simulated(self):
        longer = recording("longer", "--performer", "unskilled", "--seed", 1, "--seconds", 20)
        shown = terminal(80, "assess", longer, "--cohort", self.path("own.db"))
        shares = [int(s) for s in re.findall(r": (\d+) %", shown.err)]
        self.assertEqual(shares, sorted(shares))
        self.assertTrue(any(0 < s < 100 for s in shares), shares)

    def test_no_progress_in_a_pipe_nor_with_json(self):
        for name, arguments in self.commands().items():
            with self.subTest(command=name):
                self.assertEqual(self.answers(name)[0].err, "")
                self.path("own.db").unlink(missing_ok=True)
                shown = terminal(60, *(a for a in arguments if a != "--all"), "--json")
                self.assertEqual(shown.err, "")
                json.loads(shown.out)


if __name__ == "__main__":
    program.main()
