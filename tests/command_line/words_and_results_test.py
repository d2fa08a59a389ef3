# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line itself: the nearest right word for a wrong one, the cohort named in one way, lists of what a cohort holds, results
in one style, writers that obey --force, and progress that never mixes with results on a terminal."""

import json
import os
import pty
import re
import select
import shutil
import subprocess
import time
import xml.etree.ElementTree as xml

import program
import recording_file
from program import ProgramTest, calot, short

SNAKE = re.compile(r"[a-z][a-z0-9_]*$")
# Names that the data has, not the program: of datasets in a recording, criteria of experience, purposes of consent, factors of a study.
FREE = {"bytes_by_group", "experience", "consent", "attempt", "counts", "levels", "answers", "strata"}


class WrongWords(ProgramTest):
    def test_the_nearest_right_one_is_named(self):
        for words, nearest in ((["recrod"], "record"), (["stduy"], "study"), (["particpant"], "participant"), (["golden", "chek"], "check"),
                               (["attempt", "lst"], "list"), (["assess", "r.h5", "--cohrot", "c.db"], "--cohort"),
                               (["replay", "r.h5", "--jnuit=x.xml"], "--junit"), (["record", "--scen", "touch-liver"], "--scene"),
                               (["record", "--scene", "touch-livr", "--performer", "skilled", "-o", self.path("o.h5")], "touch-liver"),
                               (["record", "--scene", "touch-liver", "--performer", "skiled", "-o", self.path("o.h5")], "skilled"),
                               (["record", "--scene", "touch-liver", "--device", "gampad", "-o", self.path("o.h5")], "gamepad"),
                               (["record", "--scene", "touch-liver", "--mode", "asessment", "-o", self.path("o.h5")], "assessment"),
                               (["mesh", "x.obj", "--unit", "mmm", "-o", "x.vtk"], "mm"),
                               (["rate", "c.db", "--form", "gaols", "--attempt", "1", "--rater", "R1", "--answer", "A=1"], "goals")):
            with self.subTest(words=words):
                self.refused(2, *words, names=(f'"{nearest}"?',))

    def test_what_is_like_nothing_gets_no_advice(self):
        for words in (["xyzzy"], ["assess", "--quixotic"], ["record", "--scene", "xyzzy", "--performer", "skilled", "-o", self.path("o.h5")]):
            with self.subTest(words=words):
                self.assertNotIn("\"?", self.refused(2, *words).err)

    def test_a_command_without_its_second_word_says_which_there_are(self):
        self.refused(2, "attempt", names=("list, exclude, include",))
        self.refused(2, "golden", names=("check, update, values",))


def hard_to_miss(value, path=""):
    """Keys of a result that are not in its style."""
    if isinstance(value, dict):
        for key, below in value.items():
            free = any(part in FREE for part in path.split("/"))
            if not free and not SNAKE.match(key):
                yield f"{path}/{key}"
            yield from hard_to_miss(below, f"{path}/{key}")
    elif isinstance(value, list):
        for each in value[:3]:
            yield from hard_to_miss(each, path)


class Cohort(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.recordings = [program.recording(f"p{n}", "--performer", "skilled", "--seed", n, "--seconds", 0.4, "--participant", f"P{n}",
                                            "--mode", "assessment") for n in (1, 2, 3)]

    def setUp(self):
        super().setUp()
        self.cohort = self.path("c.db")
        self.well("participant", "add", "P1", "--cohort", self.cohort, "--group", "novice", "--experience", "laparoscopies=3")
        self.well("participant", "add", "P2", "--cohort", self.cohort, "--group", "expert", "--consent", "study:2026-01-31")
        self.well("assess", *self.recordings, "--cohort", self.cohort)

    def test_attempt_list(self):
        rows = json.loads(self.well("attempt", "list", "--cohort", self.cohort, "--json").out)["attempts"]
        self.assertEqual(sorted(r["participant"] for r in rows), ["P1", "P2", "P3"])
        rows.sort(key=lambda r: r["participant"])
        self.assertEqual({(r["scene"], r["verdict"], r["excluded"]) for r in rows}, {("touch-liver", "verified", False)})
        out = self.well("attempt", "list", "--cohort", self.cohort).out
        self.assertIn(f"{self.cohort}: 3 attempts\n", out)
        # What stands in the table is what other commands take.
        beginning = re.search(rf"^({rows[0]['attempt'][:8]}\S*) ", out, re.M).group(1)
        self.well("attempt", "exclude", beginning, "--cohort", self.cohort, "--reason", "camera failed", "--by", "A. Instructor")
        self.assertIn("2 attempts, 1 not listed (--all: excluded, too)", self.well("attempt", "list", self.cohort).out)
        everything = self.well("attempt", "list", self.cohort, "--all").out
        self.assertIn(f"{beginning} is excluded: camera failed", everything)
        one = json.loads(self.well("attempt", "list", self.cohort, "--participant", "P2", "--json").out)["attempts"]
        self.assertEqual([r["participant"] for r in one], ["P2"])
        novices = json.loads(self.well("attempt", "list", self.cohort, "--group", "novice", "--all", "--json").out)["attempts"]
        self.assertEqual([(r["excluded"], r["exclusion_reason"].startswith("camera failed")) for r in novices], [(True, True)])
        self.refused(4, "attempt", "list", "--cohort", self.path("none.db"), names=("none.db",))

    def test_participant_list(self):
        rows = json.loads(self.well("participant", "list", "--cohort", self.cohort, "--json").out)["participants"]
        self.assertEqual([(r["participant"], r["group"], r["attempts"]) for r in rows], [("P1", "novice", 1), ("P2", "expert", 1), ("P3", "", 1)])
        self.assertEqual((rows[0]["experience"], rows[1]["consent"]), ({"laparoscopies": "3"}, {"study": "2026-01-31"}))
        out = self.well("participant", "list", self.cohort, "--group", "expert").out
        self.assertIn("study:2026-01-31", out)
        self.assertNotIn("novice", out)
        self.assertIn(": 1 participant\n", out)

    def test_the_database_is_named_in_one_way(self):
        """Every command that works on one database takes --cohort; the word alone does, too, where it did."""
        def commands(at, words=()):
            if not at["commands"]:
                yield words, at
            for each in at["commands"]:
                yield from commands(each, (*words, each["name"]))
        takes = {}
        for words, command in commands(json.loads(self.well("--help-json").out)):
            names = {name for option in command["options"] for name in option["names"]}
            lone = {option["positional"] for option in command["options"] if not option["names"]}
            self.assertNotIn("cohort", lone, words)
            takes[" ".join(words)] = "--cohort" in names
        for each in ("assess", "verify", "study", "power", "regrade", "grade", "protocol list", "protocol register", "norm list", "norm show",
                     "cohort check", "cohort list", "cohort export", "cohort scrub", "participant list", "attempt list", "attempt exclude"):
            self.assertTrue(takes[each], each)
        for named, alone in ((["cohort", "check", "--cohort", self.cohort], ["cohort", "check", self.cohort]),
                             (["norm", "list", f"--cohort={self.cohort}"], ["norm", "list", self.cohort]),
                             (["protocol", "list", "--cohort", self.cohort], ["protocol", "list", self.cohort]),
                             (["regrade", self.recordings[0].parent, "--cohort", self.cohort], ["regrade", self.cohort, self.recordings[0].parent])):
            with self.subTest(named=named):
                self.assertEqual(self.well(*named).out, self.well(*alone).out)

    def test_results_have_one_style(self):
        other = self.path("other.db")
        shutil.copyfile(self.cohort, other)
        r = self.recordings[0]
        self.well("state", r, "--step", 3, "-o", self.path("s.h5"))
        asked = {"calot-replay": ["replay", r], "calot-inspect": ["inspect", r], "calot-scenes": ["scenes"], "calot-checkpoints": ["checkpoints"],
                 "calot-devices": ["devices"], "calot-engines": ["engine", "list"], "calot-cache": ["cache"],
                 "calot-diff": ["diff", self.path("s.h5"), self.path("s.h5")], "calot-assess": ["assess", r, "--cohort", self.cohort],
                 "calot-regrade": ["regrade", self.cohort, r.parent],
                 "calot-norms": ["norm", "list", self.cohort], "calot-forms": ["rate", "--forms"], "calot-ratings": ["rate", self.cohort],
                 "calot-protocols": ["protocol", "list"], "calot-cohort-check": ["cohort", "check", self.cohort],
                 "calot-cohort-list": ["cohort", "list", self.cohort], "calot-cohort-merge": ["cohort", "merge", self.cohort, other],
                 "calot-cohort-export": ["cohort", "export", self.cohort, "-o", self.path("x")],
                 "calot-cohort-bundle": ["cohort", "bundle", self.cohort, "-o", self.path("b"), "--include-synthetic"],
                 "calot-attempt-list": ["attempt", "list", self.cohort], "calot-participant-list": ["participant", "list", self.cohort],
                 "calot-record": ["record", "--scene", program.SCENE, "--performer", "skilled", "--seconds", 0.1, "-o", self.path("n.h5")],
                 "calot-power": ["power", "--effect", 1.5, "--n", "4", "--simulations", 100],
                 "calot-mesh": ["mesh", program.SOURCE / "assets/organs/gallbladder.obj", "--unit", "m", "--surface-output", self.path("g.obj")]}
        book = (program.SOURCE / "schemas/results.md").read_text(encoding="utf-8")
        for schema, words in asked.items():
            with self.subTest(schema=schema):
                said = json.loads(self.well(*words, "--json").out)
                self.assertEqual(list(said)[:2], ["schema", "version"])
                self.assertEqual((said["schema"], said["version"]), (schema, 1))
                self.assertEqual(list(hard_to_miss(said)), [])
                self.assertIn(f"`{schema}`", book)
        with_json = {" ".join(words) for words, command in self.leaves() if "--json" in command}
        self.assertEqual({name for name in with_json if f"`{name}`" not in book}, set(), "commands whose results the page does not describe")

    def leaves(self):
        def walk(at, words=()):
            yield words, {name for option in at["options"] for name in option["names"]}
            for each in at["commands"]:
                yield from walk(each, (*words, each["name"]))
        return walk(json.loads(self.well("--help-json").out))


class Force(ProgramTest):
    def test_every_writer_obeys_it(self):
        r = self.copy(short())
        cohort = self.path("c.db")
        self.well("assess", r, "--cohort", cohort)
        gallbladder = program.SOURCE / "assets/organs/gallbladder.obj"
        writers = {"j.xml": ["replay", r, "--junit"], "m.obj": ["mesh", gallbladder, "--unit", "m", "--surface-output"], "s.h5": ["state", r, "--step", 3, "-o"],
                   "n.h5": ["record", "--scene", program.SCENE, "--performer", "skilled", "--seconds", 0.1, "-o"],
                   "out": ["cohort", "export", cohort, "-o"], "motion": ["export", r, "--motion"]}
        for name, words in writers.items():
            with self.subTest(name=name):
                target = self.path(name)
                self.well(*words, target)
                first = {p.relative_to(self.folder): p.read_bytes() for p in [target, *target.rglob("*")] if p.is_file()}
                self.refused(2, *words, target, names=(name, "--force"))
                self.assertEqual({p: (self.folder / p).read_bytes() for p in first}, first)
                self.well(*words, target, "--force")

    def test_a_folder_with_other_files_is_never_replaced(self):
        r = self.copy(short())
        self.well("export", r, "--motion", self.path("motion"))
        (self.path("motion") / "mine.txt").write_text("mine")
        self.refused(2, "export", r, "--motion", self.path("motion"), "--force", names=("mine.txt",))
        self.assertEqual((self.path("motion") / "mine.txt").read_text(), "mine")

    def test_junit_of_another_version_is_not_green_unless_asked(self):
        other = self.copy(short(), "other.h5")
        recording_file.set_attribute(other, "simulation_version", 999)
        for more, errors, skipped in (((), 1, 0), (("--skip-other-versions",), 0, 1)):
            target = self.path(f"j{skipped}.xml")
            answer = calot("replay", other, "--junit", target, *more)
            self.assertEqual(answer.code, 5, answer)
            suite = xml.parse(target).getroot()
            self.assertEqual((int(suite.get("errors")), int(suite.get("skipped"))), (errors, skipped))

    def test_golden_check_writes_junit(self):
        golden = self.path("golden")
        golden.mkdir()
        source = program.SOURCE / "assets/golden"
        listed = json.loads((source / "golden.json").read_text())
        first = min(listed["recordings"], key=lambda r: (source / r["file"]).stat().st_size)
        listed["recordings"] = [first]
        (golden / "golden.json").write_text(json.dumps(listed))
        shutil.copyfile(source / first["file"], golden / first["file"])
        answer = calot("golden", "check", "--folder", golden, "--junit", self.path("g.xml"))
        self.assertEqual(answer.code, 0, answer)
        suite = xml.parse(self.path("g.xml")).getroot()
        self.assertEqual((suite.get("name"), suite.get("tests"), suite.get("failures"), suite.get("errors")), ("calot golden check", "1", "0", "0"))
        self.assertEqual([case.get("name") for case in suite], [first["file"]])
        self.refused(2, "golden", "check", "--folder", golden, "--junit", self.path("g.xml"), names=("--force",))
        self.path("g.xml").write_text("")
        self.assertEqual(calot("golden", "check", "--folder", golden, "--junit", self.path("g.xml"), "--force").code, 0)
        self.assertEqual(xml.parse(self.path("g.xml")).getroot().get("tests"), "1")


class Screen:
    """What a terminal of many columns shows of a stream: line breaks, carriage returns, erased lines."""

    def __init__(self):
        self.lines, self.column, self.drawn = [""], 0, 0

    def feed(self, text):
        for part in re.findall(r"\x1b\[K|\r|\n|[^\x1b\r\n]+", text):
            if part == "\n":
                self.lines.append("")
                self.column = 0
            elif part == "\r":
                self.column = 0
            elif part == "\x1b[K":
                self.lines[-1] = self.lines[-1][:self.column]
            else:
                line = self.lines[-1].ljust(self.column)
                self.lines[-1] = line[:self.column] + part + line[self.column + len(part):]
                self.column += len(part)
                self.drawn += 1

    def shown(self):
        return [line.rstrip() for line in self.lines if line.strip()]


def on_terminal(*words):
    """Runs the program with stdout and stderr on one terminal. @return its exit code, the Screen, and the stream"""
    main, other = pty.openpty()
    process = subprocess.Popen([str(program.PROGRAM), *map(str, words)], stdin=subprocess.DEVNULL, stdout=other, stderr=other)
    os.close(other)
    stream, end = b"", time.monotonic() + program.PATIENCE
    while time.monotonic() < end:
        if select.select([main], [], [], 0.2)[0]:
            try:
                stream += os.read(main, 65536)
            except OSError:  # the program ended
                break
    os.close(main)
    code = process.wait(timeout=10)
    text = stream.decode().replace("\r\n", "\n")
    screen = Screen()
    screen.feed(text)
    return code, screen, text


class ProgressAndResults(ProgramTest):
    def setUp(self):
        super().setUp()
        self.r = program.skilled()

    def commands(self):
        yield "record", ["record", "--scene", program.SCENE, "--performer", "skilled", "--seconds", 5, "-o", self.path("a.h5")], 1
        yield "replay", ["replay", self.r], 1
        yield "replay of several", ["replay", self.r, self.r, self.r], 4
        yield "assess", ["assess", self.r, self.r, "--cohort", self.path("c.db")], None
        yield "export", ["export", self.r, "--csv", self.path("csv")], None

    def test_what_the_terminal_shows_is_what_a_pipe_gets(self):
        progress = 0
        for name, words, lines in self.commands():
            with self.subTest(name):
                code, screen, stream = on_terminal(*words)
                self.assertEqual(code, 0, stream)
                progress += stream.count("\x1b[K")
                shown = screen.shown()
                if lines is not None:
                    self.assertEqual(len(shown), lines, shown)
                for line in shown:
                    self.assertNotRegex(line, r"\(\d+ %\)|: \d+ of \d+", "left of a line of progress")
        self.assertGreater(progress, 0, "no command showed progress: nothing was tested")

    def test_json_on_a_terminal_is_json(self):
        code, _, stream = on_terminal("replay", self.r, "--json")
        self.assertEqual(code, 0)
        self.assertEqual(json.loads(stream)["schema"], "calot-replay")

    def test_a_pipe_gets_no_progress(self):
        answer = calot("replay", self.r)
        self.assertEqual((answer.code, answer.err), (0, ""))
        self.assertNotIn("\x1b", answer.out)

    def test_tmux_shows_results_alone(self):
        if not shutil.which("tmux"):
            self.skipTest("tmux is not installed")
        socket, done = self.path("tmux"), self.path("done")
        script = self.path("run.sh")
        script.write_text(f'"{program.PROGRAM}" replay "{self.r}" "{self.r}"\n"{program.PROGRAM}" replay "{self.r}"\ntouch "{done}"\nsleep 60\n')
        tmux = ["tmux", "-S", str(socket)]
        subprocess.run([*tmux, "-f", "/dev/null", "new-session", "-d", "-x", "160", "-y", "30", f"sh {script}"], check=True,
                       env={**os.environ, "TERM": "xterm", "LC_ALL": "C.UTF-8"})
        try:
            end = time.monotonic() + program.PATIENCE
            while not done.exists() and time.monotonic() < end:
                time.sleep(0.1)
            screen = subprocess.run([*tmux, "capture-pane", "-p", "-J"], check=True, capture_output=True, text=True).stdout
        finally:
            subprocess.run([*tmux, "kill-server"], check=False)
        lines = [line.rstrip() for line in screen.splitlines() if line.strip()]
        self.assertEqual(len(lines), 4, screen)
        for at, line in enumerate(lines):
            self.assertRegex(line, r"^2 recordings, 2 bit-exact$" if at == 2 else rf"^{re.escape(str(self.r))}: bit-exact, [\d.]+ s \(\d+ steps\), [\d.]+ x real time$")


if __name__ == "__main__":
    program.main()
