# SPDX-License-Identifier: GPL-3.0-or-later
"""kill -9 at random moments of whatever writes: record, assess, regrade, import, merge, recover, render, withdraw. What is left opens
and is sound, nothing that was flushed is lost, and the same command, run again, completes. 10 kills, or 300 with CALOT_HEAVY=1."""

import json
import shutil
import signal
import subprocess
import time

import h5py
import numpy
import program
import recording_file
from cohort_content import content, edited, query
from import_test import synthetic, text_of
from program import PROGRAM, SCENE, calot, recording

WHO = "Withdrawn-Q7"


def attempts():
    return [recording(f"anywhere-{seed}", "--performer", "skilled", "--seed", seed, "--seconds", 0.5, "--purpose",
                      "study", "--participant", WHO if seed == 2 else f"P{seed}") for seed in range(1, 6)]


def without_audit(cohort):
    """Rows by what they say: numbers of rows tell the order of arrival, which a kill may change."""
    held = content(cohort)
    for table in ("audit", "export"):
        held.pop(table, None)
    return held


class Verb:
    """A command, what it works on in a folder of its own, and what must hold after it was killed and after it ended."""

    def __init__(self, test, original):
        self.test, self.original = test, original
        original.mkdir()
        self.prepare(original)

    def prepare(self, folder):
        """Makes what the command begins with."""

    def again(self, work):
        """The command as a person runs it after the kill."""
        return self.command(work)

    def killed(self, work):
        """@returns whether something had been done and something not"""
        raise NotImplementedError

    def ended(self, work):
        """What the command leaves, to be the same every time."""
        raise NotImplementedError


class Record(Verb):
    def command(self, work):
        return "record", "--scene", SCENE, "--performer", "unskilled", "--seed", 5, "--seconds", 8, "-o", work / "r.h5"

    def again(self, work):
        return *self.command(work), "--force"

    def killed(self, work):
        r = work / "r.h5"
        if not r.exists():
            return False
        with h5py.File(r, "r", libver="latest", swmr=True) as file:
            flushed, completed = int(file["/status"][-1]["steps"]), int(file["/status"][-1]["completed"])
        answer = calot("replay", r, "--json")
        said = json.loads(answer.out)["recordings"][0]
        self.test.assertEqual(answer.code, 0 if said["steps"] > 0 else 5, answer)
        self.test.assertGreaterEqual(said["steps"], flushed)
        return completed == 0 and flushed > 0

    def ended(self, work):
        self.test.assertNotIn("incomplete", self.test.well("replay", work / "r.h5").out)
        with h5py.File(work / "r.h5", "r") as file:
            return file["/steps/state_digest"][:].tobytes()  # the uuid is another each time


class Cohort(Verb):
    def sound(self, work, name="c.db"):
        """Of a cohort that may not be there yet: how many attempts it has."""
        if not (work / name).exists():
            return 0
        answer = calot("cohort", "check", work / name)  # takes back what a commit had begun
        if query(work / name, "SELECT count(*) FROM sqlite_master")[0][0] == 0:
            self.test.assertEqual(answer.code, 4, answer)
            return 0
        self.test.assertEqual(answer.code, 0, answer)
        bare = ("SELECT count(*) FROM attempt a WHERE NOT EXISTS (SELECT 1 FROM verification v WHERE v.attempt = a.id) OR NOT EXISTS "
                "(SELECT 1 FROM recording r WHERE r.attempt = a.id)")
        self.test.assertEqual(query(work / name, bare), [(0,)], "half an attempt")
        return query(work / name, "SELECT count(*) FROM attempt")[0][0]

    def ended(self, work):
        self.sound(work)
        return without_audit(work / "c.db")


class Assess(Cohort):
    def command(self, work):
        return "assess", *attempts(), "--cohort", work / "c.db"

    def killed(self, work):
        return 0 < self.sound(work) < len(attempts())


class Regrade(Cohort):
    def prepare(self, folder):
        (folder / "data").mkdir()
        for file in attempts():
            shutil.copy(file, folder / "data")
        self.test.well("assess", *attempts(), "--cohort", folder / "c.db")
        with edited(folder / "c.db") as database:
            database.execute("DELETE FROM checkpoint_value")

    def command(self, work):
        return "regrade", work / "c.db", work / "data"

    def killed(self, work):
        self.test.assertEqual(self.sound(work), len(attempts()))
        done = query(work / "c.db", "SELECT count(DISTINCT attempt) FROM checkpoint_value")[0][0]
        each = query(work / "c.db", "SELECT DISTINCT count(*) FROM checkpoint_value GROUP BY attempt")
        self.test.assertLessEqual(len(each), 1, "half of an attempt's values")
        return 0 < done < len(attempts())


class Import(Cohort):
    def prepare(self, folder):
        generator = numpy.random.default_rng(1)
        for i in range(6):
            (folder / f"{i}.txt").write_text(text_of(synthetic(5.0, generator)))

    def command(self, work):
        return "import", *sorted(work.glob("*.txt")), "--task", "knot-tying", "--participant", "P1", "--mode", "assessment", "--cohort", work / "c.db"

    def killed(self, work):
        return 0 < self.sound(work) < 6


class Merge(Cohort):
    def prepare(self, folder):
        self.test.well("assess", *attempts()[:3], "--cohort", folder / "c.db")
        self.test.well("assess", *attempts()[2:], "--cohort", folder / "from.db")
        self.test.well("participant", "set", "P4", "--cohort", folder / "from.db", "--group", "novice")

    def command(self, work):
        return "cohort", "merge", work / "c.db", work / "from.db"

    def killed(self, work):
        self.test.assertIn(self.sound(work), (3, 5), "a part of a merge")
        self.test.assertEqual(content(work / "from.db"), content(self.original / "from.db"))
        return False  # all or nothing


class Recover(Verb):
    def prepare(self, folder):
        r = folder / "r.h5"
        process = subprocess.Popen([str(PROGRAM), "record", "--scene", SCENE, "--performer", "unskilled", "--seed", "3", "--paced", "-o", str(r)],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        recording_file.await_steps(r, process)
        time.sleep(2.0)
        process.kill()
        process.wait()

    def command(self, work):
        return "recover", work / "r.h5", "-o", work / "whole.h5"

    def again(self, work):
        return *self.command(work), "--force"

    def killed(self, work):
        self.test.assertEqual((work / "r.h5").read_bytes(), (self.original / "r.h5").read_bytes())
        if (work / "whole.h5").exists():
            self.test.well("replay", work / "whole.h5")
        return not (work / "whole.h5").exists()

    def ended(self, work):
        self.test.well("replay", work / "whole.h5")
        return recording_file.last_status(work / "whole.h5")["chain"].tobytes()


class Render(Verb):
    def prepare(self, folder):
        shutil.copy(attempts()[0], folder / "r.h5")

    def command(self, work):
        return "render", work / "r.h5", "-o", work / "film.mp4", "--size", "320x240"

    def again(self, work):
        return *self.command(work), "--force"

    def killed(self, work):
        self.test.assertEqual((work / "r.h5").read_bytes(), (self.original / "r.h5").read_bytes())
        return not (work / "film.mp4").exists()  # a film that has its name is whole: it is the same as at the end

    def ended(self, work):
        return (work / "film.mp4").read_bytes()


class Withdraw(Cohort):
    def prepare(self, folder):
        (folder / "data").mkdir()
        for file in attempts():
            shutil.copy(file, folder / "data")
        self.test.well("assess", *attempts(), "--cohort", folder / "c.db")
        self.test.well("branch", attempts()[1], "--at", 0.2, "--performer", "unskilled", "--seconds", 0.1, "-o", folder / "data" / "branch.h5")
        self.words = [WHO, *(u for (u,) in query(folder / "c.db", "SELECT uuid FROM attempt WHERE participant = (SELECT id FROM participant "
                                                                  f"WHERE pseudonym = '{WHO}')"))]

    def command(self, work):
        return ("participant", "withdraw", WHO, "--cohort", work / "c.db", "--scope", "all", "--recordings", work / "data")

    def killed(self, work):
        left = self.sound(work)
        self.test.assertIn(left, (len(attempts()) - 1, len(attempts())))
        return len(list((work / "data").iterdir())) < len(attempts()) + 1 and left == len(attempts())

    def ended(self, work):
        held = [str(p) for p in work.rglob("*") if p.is_file() and any(w.encode() in p.read_bytes() for w in self.words)]
        self.test.assertEqual(held, [])
        held = super().ended(work)
        for table in ("tombstone", "tombstone_attempt"):  # a random number of its own each time
            held[table] = len(held[table])
        return held, sorted(p.name for p in (work / "data").iterdir())


def state_of(folder):
    state = []
    for path in folder.rglob("*"):
        try:
            about = path.stat()
        except FileNotFoundError:  # gone since
            continue
        state.append((str(path), about.st_size, about.st_mtime_ns))
    return sorted(state)


class KilledAnywhere(program.ProgramTest):
    def run_killed(self, command, work, full, draw):
        """Half of the kills come at any moment, half after the first change of a file: there is most to be lost.
        @returns seconds that it took where it ended by itself, or None"""
        before = state_of(work)
        process = subprocess.Popen([str(PROGRAM), *map(str, command)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        begin = time.monotonic()
        if draw.random() < 0.5:
            while process.poll() is None and state_of(work) == before:
                time.sleep(0.001)
            end = time.monotonic() + draw.uniform(0.0, 0.4 * full) ** 2 / full
        else:
            end = begin + draw.uniform(0.0, full)
        while process.poll() is None and time.monotonic() < end:
            time.sleep(0.001)
        if process.poll() is not None:
            return time.monotonic() - begin
        process.send_signal(signal.SIGKILL)
        return time.monotonic() - begin if process.wait() != -signal.SIGKILL else None

    def test_at_random_moments(self):
        draw = program.seeded("killed anywhere")
        kinds = (Record, Assess, Regrade, Import, Merge, Recover, Render, Withdraw)
        verbs, full, reference, kills, partly = {}, {}, {}, {}, {}
        for kind in kinds:
            name = kind.__name__
            verb = verbs[name] = kind(self, self.path(name))
            work = shutil.copytree(verb.original, self.path("work"))
            begin = time.monotonic()
            self.well(*verb.command(work))
            full[name] = time.monotonic() - begin
            reference[name] = verb.ended(work)
            kills[name] = partly[name] = 0
            shutil.rmtree(work)
        wanted = 300 if program.HEAVY else 10
        rounds = 0
        while sum(kills.values()) < wanted:
            self.assertLess(rounds, 4 * wanted, "what is to be killed has always ended before")
            name = kinds[rounds % len(kinds)].__name__
            rounds += 1
            verb, work = verbs[name], self.path("work")
            shutil.copytree(verb.original, work)
            took = self.run_killed(verb.command(work), work, full[name], draw)
            if took is not None:
                full[name] = min(full[name], took)  # the machine was busy when it was timed
            kills[name] += took is None
            with self.subTest(verb=name, round=rounds):
                partly[name] += verb.killed(work)
                again = calot(*verb.again(work))
                if name == "Withdraw" and again.code == 3:  # the rows had gone: what they left in free pages goes on request
                    self.well("cohort", "scrub", work / "c.db")
                else:
                    self.assertEqual((again.code, again.err), (0, ""), again)
                self.assertEqual(verb.ended(work), reference[name])
            shutil.rmtree(work)
        print("kills: " + ", ".join(f"{name} {count} ({partly[name]} in the middle)" for name, count in kills.items()), flush=True)


if __name__ == "__main__":
    program.main()
