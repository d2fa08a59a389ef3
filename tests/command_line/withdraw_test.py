# SPDX-License-Identifier: GPL-3.0-or-later
"""calot participant withdraw: nothing of a person is left in any store, byte for byte."""

import os
import pathlib
import shutil
import signal
import subprocess
import time

import program
import recording_file
from cohort_content import content, query
from import_test import synthetic, text_of
from program import calot, recording

WHO = "Withdrawn-Q7"

def of(participant, seed, purpose="study", mode="practice"):
    return recording(f"w-{participant}-{seed}", "--performer", "skilled", "--seed", seed, "--seconds", 0.5, "--mode", mode,
                     "--purpose", purpose, "--participant", participant)


class Withdraw(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort, self.data = self.path("c.db"), self.path("data")
        (self.data / "deep").mkdir(parents=True)
        self.mine = [shutil.copy(of(WHO, 1), self.data / "deep" / "a.h5"), shutil.copy(of(WHO, 2, "training"), self.data / "b.h5")]
        self.other = shutil.copy(of("P2", 3), self.data / "c.h5")
        self.branch = self.data / "branch.h5"
        self.well("branch", self.mine[0], "--at", 0.2, "--performer", "unskilled", "--seconds", 0.1, "-o", self.branch)
        self.well("participant", "add", WHO, "--group", "novice", "--experience", "laparoscopies=2", "--consent", "research:2026-01-01",
                  "--cohort", self.cohort)
        self.well("assess", *self.mine, self.other, self.branch, "--cohort", self.cohort)
        self.uuids = [u for (u,) in query(self.cohort, "SELECT uuid FROM attempt WHERE participant = (SELECT id FROM participant WHERE "
                                                       f"pseudonym = '{WHO}')")]
        self.assertEqual(len(self.uuids), 3)  # a branch keeps its parent's participant
        self.well("attempt", "exclude", self.uuids[0], "--cohort", self.cohort, "--reason", "late", "--by", "me")
        self.well("export", self.mine[0], "--csv", self.path("handed-out"), "--cohort", self.cohort)
        self.well("render", self.mine[0], "-o", self.path("picture.png"), "--size", "64x48", "--cohort", self.cohort)
        shutil.copy(self.path("picture.png"), self.data / "deep" / "a.png")
        # A backup, as a migration leaves one.
        shutil.copyfile(self.cohort, self.path("c.db.schema-2.bak"))

    def withdraw(self, *more, scope="all"):
        return self.well("participant", "withdraw", WHO, "--cohort", self.cohort, "--scope", scope, "--recordings", self.data, *more)

    def left(self, *words):
        """Files of the test's folder that hold one of the words anywhere in their bytes, or as text in the other endings."""
        found = []
        for file in sorted(p for p in self.folder.rglob("*") if p.is_file()):
            held = file.read_bytes()
            if any(w.encode(code) in held for w in words for code in ("utf-8", "utf-16-le", "utf-16-be")):
                found.append(str(file.relative_to(self.folder)))
        return found

    def test_all_of_it_goes(self):
        self.assertIn("c.db", "".join(self.left(WHO)))
        self.assertGreater(len(self.left(*self.uuids)), 4)
        others = [r for r in content(self.cohort)["participant"] if "'P2'" in r]
        said = self.withdraw().out
        self.assertIn(str(self.path("handed-out")), said)
        for uuid in self.uuids:
            self.assertIn(uuid, said)
        # What was handed out is listed, not reached.
        self.assertIn("was handed out: recording-csv", said)
        shutil.rmtree(self.path("handed-out"))
        self.assertEqual(self.left(WHO, *self.uuids), [])
        self.assertEqual(sorted(p.name for p in self.data.rglob("*") if p.is_file()), ["c.h5"])
        self.assertFalse(self.path("picture.png").exists())
        self.assertFalse(self.path("c.db.schema-2.bak").exists())
        self.well("cohort", "check", self.cohort)
        self.assertEqual([r for r in content(self.cohort)["participant"] if "'P2'" in r], others)
        self.assertEqual(query(self.cohort, "SELECT count(*) FROM attempt"), [(1,)])
        self.assertEqual(query(self.cohort, "SELECT scope, attempts FROM tombstone"), [("all", 3)])
        # It does not come back: not its recordings, not by a merge.
        self.refused(3, "participant", "withdraw", WHO, "--cohort", self.cohort, "--scope", "all", "--recordings", self.data, names=(WHO,))
        answer = calot("assess", of(WHO, 1), "--cohort", self.cohort)
        self.assertEqual(answer.code, 3, answer)
        self.assertIn("withdrawn", answer.err)
        elsewhere = self.path("b.db")
        self.well("assess", of(WHO, 1), of(WHO, 2), "--cohort", elsewhere)
        self.assertIn("2 withdrawn attempts stay out", self.well("cohort", "merge", self.cohort, elsewhere).out)
        elsewhere.unlink()
        self.assertEqual(self.left(WHO, *self.uuids), [])

    def test_a_database_that_still_has_it_is_told(self):
        elsewhere = self.path("b.db")
        shutil.copyfile(self.cohort, elsewhere)
        self.withdraw()
        answer = calot("cohort", "merge", elsewhere, self.cohort)
        self.assertEqual(answer.code, 3, answer)
        self.assertIn(str(elsewhere), answer.err)

    def test_research_only(self):
        self.withdraw(scope="research")
        self.assertEqual(sorted(p.name for p in self.data.rglob("*") if p.is_file()), ["b.h5", "c.h5"])
        self.assertEqual(query(self.cohort, "SELECT study_group FROM participant WHERE pseudonym = ?".replace("?", f"'{WHO}'")), [("",)])
        self.assertEqual(query(self.cohort, "SELECT count(*) FROM consent"), [(0,)])
        training = query(self.cohort, "SELECT uuid FROM attempt WHERE purpose = 'training'")
        gone = [u for u in self.uuids if (u,) not in training]
        shutil.rmtree(self.path("handed-out"))
        self.assertEqual(self.left(*gone), [])
        # New attempts stay out of studies, too.
        self.well("participant", "set", WHO, "--group", "novice", "--cohort", self.cohort)
        later = of(WHO, 9, mode="assessment")
        self.well("assess", later, "--cohort", self.cohort)
        answer = calot("study", self.cohort, "--include-synthetic", "--include-practice")
        self.assertEqual(answer.code, 3)
        self.assertIn("2 withdrawn", answer.err)

    def motion(self, number, *more):
        path = self.path(f"motion{number}.txt")
        path.write_text(text_of(synthetic(2.0 + number, program.seeded(f"motion{number}"))))
        self.well("import", path, "--participant", "M1", *more, "--cohort", self.cohort)

    def test_research_takes_what_studies_analyse(self):
        """The purpose follows the consent; an assessment of purpose training goes with a consent, or is asked for."""
        self.well("participant", "add", "M1", "--group", "novice", "--consent", "study:2026-01-01", "--cohort", self.cohort)
        self.motion(1, "--mode", "assessment")
        self.motion(2, "--mode", "assessment", "--purpose", "training")
        self.motion(3, "--purpose", "training")
        rows = "SELECT purpose, mode FROM attempt WHERE participant = (SELECT id FROM participant WHERE pseudonym = 'M1') ORDER BY 1, 2"
        self.assertEqual(query(self.cohort, rows), [("study", 1), ("training", 0), ("training", 1)])
        (stays,) = query(self.cohort, "SELECT a.uuid FROM attempt a JOIN recording r ON r.attempt = a.id WHERE r.file_name = 'motion3.txt'")
        self.well("cohort", "export", self.cohort, "-o", self.path("tables"))
        command = ("participant", "withdraw", "M1", "--cohort", self.cohort, "--scope", "research", "--no-recordings")
        said = self.well(*command).out
        self.assertIn(f"stays: attempt {stays[0]}, practice", said)
        self.assertIn("stays: participant M1", said)
        self.assertIn("was handed out: cohort-export", said)
        self.assertEqual(query(self.cohort, rows), [("training", 0)])
        # What is left is training, and an export that holds it is listed still.
        self.refused(3, *command, names=("M1",))
        self.motion(4, "--mode", "assessment")
        self.refused(2, *command, names=("--assessments",))
        self.refused(3, *command, "--assessments", "keep", names=("M1",))
        self.well(*command, "--assessments", "remove")
        self.assertEqual(query(self.cohort, rows), [("training", 0)])
        self.assertIn("tables", self.well("participant", "withdraw", "M1", "--cohort", self.cohort, "--scope", "all", "--no-recordings").out)

    def test_nothing_to_remove_is_said(self):
        self.well("participant", "add", "M2", "--cohort", self.cohort)
        said = self.well("participant", "withdraw", "M2", "--cohort", self.cohort, "--scope", "research", "--no-recordings").out
        self.assertIn("no attempt and no file is there to remove", said)

    def test_a_branch_that_no_row_names_is_known_by_its_tombstone(self):
        """Killed behind the file's removal, whenever that is: a copy of the branch does not come in again."""
        loose = self.data / "loose.h5"
        self.well("branch", self.branch, "--at", 0.25, "--performer", "skilled", "--seconds", 0.1, "-o", loose)
        copy = shutil.copy(loose, self.path("copy.h5"))
        command = [str(program.PROGRAM), "participant", "withdraw", WHO, "--cohort", str(self.cohort), "--scope", "all",
                   "--recordings", str(self.data)]
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while loose.exists() and process.poll() is None:
            pass
        process.send_signal(signal.SIGKILL)
        process.wait()
        again = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
        self.assertIn(again.returncode, (0, 3), again)
        self.refused(3, "assess", copy, "--cohort", self.cohort, names=("withdrawn",))
        self.assertEqual(query(self.cohort, "SELECT scope, attempts FROM tombstone"), [("all", 4)])

    def test_says_first_what_it_would_do(self):
        before = {p: p.read_bytes() for p in self.folder.rglob("*") if p.is_file()}
        held = content(self.cohort)
        said = self.withdraw("--dry-run").out
        self.assertIn("nothing was changed", said)
        self.assertEqual(content(self.cohort), held)
        for file, data in before.items():
            if not file.name.startswith("c.db"):
                self.assertEqual(file.read_bytes(), data, file)

    def test_stores_must_be_named(self):
        base = ("participant", "withdraw", WHO, "--cohort", self.cohort, "--scope", "all")
        self.refused(2, *base, names=("--recordings",))
        self.refused(2, *base[:-2], "--no-recordings")
        self.refused(4, *base, "--recordings", self.path("nowhere"), names=("nowhere",))
        self.assertEqual(len(self.left(WHO)), len(self.left(WHO)))

    def test_damaged_recordings_and_notes(self):
        recording_file.flip_stored_byte(self.mine[0], "/ticks/left/force", 0)
        cut = self.data / "cut.h5"
        cut.write_bytes(self.mine[1].read_bytes()[:20000])
        note = self.data / "note.txt"
        note.write_text(f"call {WHO} on Monday")
        similar = self.data / "similar.txt"
        similar.write_text(f"x{WHO}9 is someone else")
        said = self.withdraw().out
        self.assertIn(f"still names it: {note}", said)
        self.assertNotIn("similar", said)
        self.assertEqual(sorted(p.name for p in self.data.rglob("*") if p.is_file()), ["c.h5", "note.txt", "similar.txt"])

    def test_search_by_identity(self):
        # Two characters are somewhere in any megabyte, and in any table of numbers.
        who, cohort, data = "07", self.path("o.db"), self.path("other")
        data.mkdir()
        mine, other = shutil.copy(of(who, 1), data / "mine.h5"), shutil.copy(of("P2", 3), data / "other.h5")
        self.well("participant", "add", who, "--cohort", cohort)
        self.well("assess", mine, other, "--cohort", cohort)
        elsewhere = data / "elsewhere.db"
        self.well("participant", "add", who, "--cohort", elsewhere)
        (data / "film.mp4").write_bytes(bytes(range(32)) + b" 07 " + bytes(5000) + b"\n07\n")
        (data / "numbers.csv").write_text("time,x\n07:30,0.07\n2026-07-01,-07e3\n1.07,107\n")
        (data / "people.csv").write_text("participant,group\n07,novice\n")
        (data / "answers.json").write_text('{"participant": "07"}')
        (data / "note.txt").write_text("x" * ((1 << 20) - 8) + " seen: 07. Call back\n")  # across two pieces of a megabyte
        (data / "longer.txt").write_text("x" * ((1 << 20) - 2) + " 0712\n")
        named = [data / name for name in ("answers.json", "elsewhere.db", "note.txt", "people.csv")]
        command = ("participant", "withdraw", who, "--cohort", cohort, "--scope", "all", "--recordings", data)
        dry, wet = self.well(*command, "--dry-run").out.splitlines(), self.well(*command).out.splitlines()
        self.assertEqual([line for line in dry if line.startswith("still names it")],
                         [f"still names it: {path}; not removed, look into it" for path in named])
        self.assertEqual(sum(line.startswith("file ") for line in dry), 1)
        self.assertEqual(dry[:-1], wet[:-1], "--dry-run shows the same list")
        self.assertIn("nothing was changed", dry[-1])
        self.assertIn("1 attempt and 1 file removed", wet[-1])

    def test_the_same_list_first(self):
        note = self.data / "note.txt"
        note.write_text(f"call {WHO} on Monday")
        (others,) = query(self.cohort, "SELECT uuid FROM attempt WHERE participant = (SELECT id FROM participant WHERE pseudonym = 'P2')")
        self.well("attempt", "exclude", others[0], "--cohort", self.cohort, "--reason", f"sat beside {WHO}", "--by", "me")
        dry = self.withdraw("--dry-run").out.splitlines()
        wet = self.withdraw().out.splitlines()
        self.assertEqual(dry[:-1], wet[:-1])
        for words in ("was handed out: recording-csv", f"still names it: {note}", f"still names it: {self.cohort} ",
                      "backup " + str(self.path("c.db.schema-2.bak"))):
            self.assertTrue(any(line.startswith(words) for line in dry), (words, dry))

    def test_killed_at_any_moment_and_run_again(self):
        draw = program.seeded("withdraw killed")
        for _ in range(12 if program.HEAVY else 4):
            work = self.path("work")
            shutil.copytree(self.data, work / "data")
            shutil.copyfile(self.cohort, work / "c.db")
            command = [str(program.PROGRAM), "participant", "withdraw", WHO, "--cohort", str(work / "c.db"), "--scope", "all",
                       "--recordings", str(work / "data")]
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(draw.uniform(0.0, 0.25))
            process.send_signal(signal.SIGKILL)
            process.wait()
            again = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
            if again.returncode == 3:  # the rows had gone: what they left in free pages goes on request
                self.well("cohort", "scrub", work / "c.db")
            else:
                self.assertEqual(again.returncode, 0, again)
            held = [str(p) for p in work.rglob("*") if p.is_file() and any(w.encode() in p.read_bytes() for w in (WHO, *self.uuids))]
            self.assertEqual(held, [])
            self.well("cohort", "check", work / "c.db")
            shutil.rmtree(work)


if __name__ == "__main__":
    program.main()
