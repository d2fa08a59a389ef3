# SPDX-License-Identifier: GPL-3.0-or-later
"""calot regrade and assess in shards: the same rows as one machine's, whatever is killed, missing, damaged or mixed up in between."""

import atexit
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import program
import recording_file
from cohort_content import content, query
from cohort_test import change
from program import PROGRAM, SOURCE, calot

COUNT = 16
_store = []


def recordings():
    """A folder of short attempts, made once."""
    if not _store:
        _store.append(pathlib.Path(tempfile.mkdtemp(prefix="calot-shards-")))
        atexit.register(shutil.rmtree, _store[0], ignore_errors=True)
        subprocess.run([sys.executable, SOURCE / "scripts/attempts.py", _store[0], "--count", str(COUNT), "--seconds", "0.3", "--calot", PROGRAM,
                        "--jobs", "2"], check=True, stdout=subprocess.DEVNULL)
        assessed = calot("assess", _store[0], "--cohort", _store[0] / "c.db")
        assert assessed.code == 0, assessed
    return _store[0]


class Shards(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.recordings = recordings()
        self.cohort = self.copy(self.recordings / "c.db", "c.db")

    def stale(self):
        """A cohort whose values are old, in several ways."""
        change(self.cohort, "UPDATE checkpoint_value SET version = 0, value = value * 2 WHERE name = 'path-length' AND attempt % 2 = 0")
        change(self.cohort, "DELETE FROM checkpoint_value WHERE name = 'max-force' AND attempt % 3 = 0")
        change(self.cohort, "UPDATE verification SET software = 'calot 0.0.1' WHERE attempt % 5 = 0")

    def values(self, number):
        return self.path(f"{number}.values")

    def compute(self, of, numbers=None, cohort=None, places=None):
        files = []
        for number in numbers or range(1, of + 1):
            self.well("regrade", cohort or self.cohort, places or self.recordings, "--shard", f"{number}/{of}", "--values-to", self.values(number),
                      "--jobs", 1 + number % 2)
            files.append(self.values(number))
        return files

    def take(self, files, cohort=None):
        return json.loads(self.well("regrade", cohort or self.cohort, "--take", *files, "--json").out)

    def test_rows_and_report_are_those_of_one_machine(self):
        self.stale()
        alone = self.copy(self.cohort, "alone.db")
        before = content(self.cohort)
        files = self.compute(7)
        self.assertEqual(content(self.cohort), before)  # a share writes no cohort
        report = self.take(files[3:] + files[:3])
        self.assertEqual(report, json.loads(self.well("regrade", alone, self.recordings, "--json").out))
        self.assertEqual({a["result"] for a in report["attempts"]}, {"changed", "unchanged"})
        self.assertEqual(content(self.cohort), content(alone))
        self.assertNotEqual(content(self.cohort), before)
        again = self.take(files)
        self.assertEqual({a["result"] for a in again["attempts"]}, {"unchanged"})
        self.assertEqual(content(self.cohort), content(alone))
        self.assertIn(f"{COUNT} attempts: 0 changed, {COUNT} unchanged", self.well("regrade", self.cohort, "--take", *files).out)

    def test_plan_is_even_and_whole(self):
        plan = json.loads(self.well("regrade", self.cohort, "--plan", 4, "--json").out)
        self.assertEqual((plan["shards"], plan["recordings"]), (4, COUNT))
        held = [share["recordings"] for share in plan["shares"]]
        self.assertEqual((sum(held), max(held) - min(held)), (COUNT, 0))
        seconds = [share["seconds"] for share in plan["shares"]]
        self.assertAlmostEqual(sum(seconds), plan["seconds"])
        self.assertLess(max(seconds) - min(seconds), 0.6)  # two of the longest
        many = json.loads(self.well("regrade", self.cohort, "--plan", 3 * COUNT, "--json").out)
        self.assertEqual(sum(share["recordings"] for share in many["shares"]), COUNT)
        self.assertIn("4 shards, 16 recordings, 4 to 4 in each", self.well("assess", self.recordings, "--plan", 4).out)

    def test_killed_share_goes_on(self):
        whole = self.compute(1)[0].read_text().splitlines()
        target = self.path("again.values")
        part = self.path("again.values.part")
        run = ("regrade", self.cohort, self.recordings, "--shard", "1/1", "--values-to", target, "--jobs", "1")
        process = subprocess.Popen([PROGRAM, *map(str, run)], stdout=subprocess.DEVNULL)
        while not part.exists() or part.read_bytes().count(b"\n") < 6:
            self.assertIsNone(process.poll())
            time.sleep(0.005)
        other = calot(*run)  # two of one share at a time
        self.assertEqual(other.code, 1, other)
        self.assertOneLine(other, part, "another program is writing it")
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.assertFalse(target.exists())
        with open(part, "ab") as file:
            file.write(b'{"sum":"0123456789abcdef","row":{"posit')  # torn
        done = part.read_bytes().count(b"\n") - 1
        self.assertIn(f"{COUNT} recordings ({done} of an earlier run)", self.well(*run).out)
        self.assertNothingHalfWritten()

        def rows(lines):
            out = [json.loads(line)["row"] for line in lines]
            for row in out:
                row.get("report", {}).pop("wall_seconds", None)
            return sorted(map(repr, out))
        self.assertEqual(rows(target.read_text().splitlines()), rows(whole))
        stamp = os.stat(target).st_mtime_ns
        self.assertIn(f"({COUNT} of an earlier run)", self.well(*run).out)  # complete: nothing is done
        self.assertEqual(os.stat(target).st_mtime_ns, stamp)

    def test_damage_in_an_unfinished_share_is_computed_again(self):
        target, part = self.path("d.values"), self.path("d.values.part")
        lines = self.compute(1)[0].read_bytes().splitlines(keepends=True)
        lines[4] = lines[4].replace(b'"position"', b'"posotion"')
        part.write_bytes(b"".join(lines[:9]))
        out = self.well("regrade", self.cohort, self.recordings, "--shard", "1/1", "--values-to", target).out
        self.assertIn("(3 of an earlier run)", out)
        part.write_bytes(b"".join(lines[:9]))
        target.unlink()
        out = self.well("regrade", self.cohort, self.recordings, "--shard", "1/2", "--values-to", target).out  # of another plan: from the start
        self.assertNotIn("earlier", out)

    def test_missing_shards_and_attempts_are_named(self):
        self.stale()
        files = self.compute(8, (1, 2, 4, 5, 6, 8))
        answer = calot("regrade", self.cohort, "--take", *files)
        self.assertEqual(answer.code, 4, answer)
        self.assertOneLine(answer, self.cohort, "2 of 8 shards missing: 3, 7")
        self.assertIn(", 4 missing", answer.out)
        self.take(self.compute(8, (3, 7)) + files)
        fewer = self.path("fewer.db")
        half = sorted(self.recordings.rglob("*.h5"))[:COUNT // 2]
        self.well("assess", *half, "--cohort", fewer)
        for file in files + [self.values(3), self.values(7)]:
            file.unlink(missing_ok=True)
        files = self.compute(2, cohort=fewer)
        self.well("assess", self.recordings, "--cohort", fewer)  # more came in meanwhile
        answer = calot("regrade", fewer, "--take", *files)
        self.assertEqual(answer.code, 4, answer)
        self.assertOneLine(answer, fewer, f"{COUNT // 2} attempts are in none of the shards")

    def test_recordings_that_are_missing_or_damaged_as_on_one_machine(self):
        places = self.path("places")
        shutil.copytree(self.recordings, places)
        files = sorted(places.rglob("*.h5"))
        files[0].unlink()
        recording_file.flip_stored_byte(files[1], "/ticks/left/force", 0)
        recording_file.set_attribute(files[2], "simulation_version", 999)
        files[3].rename(places / "renamed.h5")
        files[4].rename(places / "other")
        files[5].rename(files[4])  # under the name of another attempt
        self.stale()
        alone = self.copy(self.cohort, "alone.db")
        shards = self.compute(3, places=places)
        taken, here = calot("regrade", self.cohort, "--take", *shards), calot("regrade", alone, places)
        self.assertEqual((taken.code, taken.out.splitlines()[:-1], sorted(taken.err.replace("c.db", "alone.db").splitlines())),
                         (4, [line for line in here.out.splitlines() if not line.startswith("not read")][:-1], sorted(here.err.splitlines())))
        self.assertEqual(content(self.cohort), content(alone))

    def test_files_that_do_not_fit_are_refused_whole(self):
        files = self.compute(3)
        before = content(self.cohort)
        other = self.path("other.db")
        self.well("assess", program.short(), "--cohort", other)
        foreign = self.path("foreign.values")
        self.well("regrade", other, program.short(), "--shard", "1/1", "--values-to", foreign)
        self.refused(3, "regrade", self.cohort, "--take", foreign, names=(foreign, "another cohort"))
        self.refused(3, "assess", "--cohort", self.cohort, "--take", files[0], names=(files[0], "calot regrade"))
        self.refused(4, "regrade", self.cohort, "--take", self.recordings / "c.db", names=("c.db", "line 1"))
        self.refused(4, "regrade", self.cohort, "--take", self.path("none.values"), names=("none.values",))
        damaged = self.copy(files[1], "damaged.values")
        text = damaged.read_bytes()
        damaged.write_bytes(text.replace(b'"steps":', b'"stops":', 1))
        self.refused(4, "regrade", self.cohort, "--take", damaged, names=(damaged, "line 2", "checksum"))
        damaged.write_bytes(text[:-40])
        self.refused(4, "regrade", self.cohort, "--take", damaged, names=(damaged, "is cut off"))
        damaged.write_bytes(b"".join(text.splitlines(keepends=True)[:-1]))
        self.refused(4, "regrade", self.cohort, "--take", damaged, names=(damaged, "compute this shard again"))
        damaged.write_bytes(b"x" * (5 << 20))
        self.refused(4, "regrade", self.cohort, "--take", damaged, names=(damaged, "bytes"))
        self.assertEqual(content(self.cohort), before)
        # The others of a taking are stored all the same.
        answer = calot("regrade", self.cohort, "--take", *files, damaged, files[0])
        self.assertEqual(answer.code, 4, answer)
        self.assertEqual(len(answer.err.splitlines()), 2, answer)
        self.assertIn("is shard 1 of 3, as is", answer.err)
        self.assertIn(f"{COUNT} attempts: 0 changed, {COUNT} unchanged", answer.out)

    def test_attempts_withdrawn_meanwhile_stay_out(self):
        files = self.compute(2)
        who, = query(self.cohort, "SELECT pseudonym FROM participant ORDER BY id LIMIT 1")[0]
        gone = query(self.cohort, f"SELECT count(*) FROM attempt JOIN participant p ON p.id = participant WHERE pseudonym = '{who}'")[0][0]
        self.assertEqual(calot("participant", "withdraw", who, "--cohort", self.cohort, "--scope", "all", "--no-recordings", "--no-key").code, 0)
        before = content(self.cohort)
        answer = calot("regrade", self.cohort, "--take", *files)
        self.assertEqual(answer.code, 0, answer)
        self.assertIn(f"values of {gone} attempts were left out: withdrawn since", answer.err)
        self.assertEqual(content(self.cohort), before)

    def test_usage(self):
        target = self.path("v")
        for shard in ("0/3", "4/3", "1", "1/0", "a/b", "1/2/3", "-1/2", "1/9999999"):
            self.refused(2, "regrade", self.cohort, self.recordings, "--shard", shard, "--values-to", target)
        self.refused(2, "regrade", self.cohort, "--shard", "1/2")
        self.refused(2, "regrade", self.cohort, "--values-to", target)
        self.refused(2, "regrade", self.cohort, "--take", target, "--shard", "1/2", "--values-to", target)
        self.refused(2, "regrade", self.cohort, self.recordings, "--take", target)
        self.refused(2, "assess", "--take", target)
        self.refused(2, "assess", "--cohort", self.cohort)
        self.refused(2, "regrade", self.cohort, self.recordings, "--shard", "1/9", "--values-to", self.path("no/v"), names=("no/v",))
        target.write_text("mine\n")
        self.refused(2, "regrade", self.cohort, self.recordings, "--shard", "1/9", "--values-to", target, names=(target, "--force"))
        self.assertEqual(target.read_text(), "mine\n")
        self.well("regrade", self.cohort, self.recordings, "--shard", "1/9", "--values-to", target, "--force")
        self.assertIn('"calot-values"', target.read_text())
        self.refused(4, "regrade", self.path("none.db"), self.recordings, "--shard", "1/9", "--values-to", self.path("n"), names=("none.db",))


class AssessShards(program.ProgramTest):
    def test_rows_are_those_of_one_machine(self):
        places, alone, together = self.path("places"), self.path("alone.db"), self.path("together.db")
        shutil.copytree(recordings(), places)
        files = sorted(places.rglob("*.h5"))
        recording_file.flip_stored_byte(files[1], "/ticks/left/force", 0)
        recording_file.set_attribute(files[2], "simulation_version", 999)
        (places / "notes.txt").write_text("no recording")
        key = self.path("key.json")
        self.well("station", "init", "S1", "-o", key)
        self.well("record", "--scene", program.SCENE, "--performer", "skilled", "--seconds", 0.3, "--station-key", key, "-o", places / "signed.h5")
        here = calot("assess", places, "--cohort", alone, "--json")
        shards = []
        for number in range(1, 5):
            shards.append(self.path(f"{number}.values"))
            self.well("assess", places, "--shard", f"{number}/4", "--values-to", shards[-1], "--jobs", 2)
        taken = calot("assess", "--cohort", together, "--take", *shards, "--json")
        self.assertEqual((here.code, taken.code), (4, 4))

        def rows(answer):
            out = json.loads(answer.out)["recordings"]
            for row in out:
                row.pop("wall_seconds")
            return out
        self.assertEqual(rows(taken), rows(here))
        self.assertEqual(content(together), content(alone))
        self.assertEqual(query(together, "SELECT id, uuid FROM attempt"), query(alone, "SELECT id, uuid FROM attempt"))
        self.assertEqual(query(together, "SELECT count(*) FROM recording_signature"), [(1,)])
        again = json.loads(calot("assess", "--cohort", together, "--take", *shards, "--json").out)["recordings"]
        self.assertEqual({row["stored"] for row in again}, {"unchanged", "not stored"})
        self.assertEqual(content(together), content(alone))
        answer = calot("assess", "--cohort", together, "--take", *shards[:2])
        self.assertEqual(answer.code, 4, answer)
        self.assertIn("2 of 4 shards missing: 3, 4", answer.err)
        shutil.copy(files[0], places / "more.h5")  # another list: another plan
        self.well("assess", places, "--shard", "3/4", "--values-to", shards[2], "--force")
        answer = calot("assess", "--cohort", together, "--take", *shards)
        self.assertEqual(answer.code, 4, answer)
        self.assertIn(f"{shards[2]}: is of another plan", answer.err)


if __name__ == "__main__":
    program.main()
