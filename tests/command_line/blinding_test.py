# SPDX-License-Identifier: GPL-3.0-or-later
"""calot rate pack and --take, study --masked and protocol lock: who rates knows no one, and who analyses knows no group."""

import base64
import hashlib
import json
import re
import sqlite3
import struct
from contextlib import closing

import manifest_test
import program
from manifest_test import ITEMS

_film = []


TITLE = b"novice P3, filmed by Miller"


def titled(film):
    """The same film with a title: a box more at the end of its moov box, which is the last one, and a box of its own behind it."""
    box = lambda kind, content: struct.pack(">I", 8 + len(content)) + kind + content
    at = 0
    while film[at + 4:at + 8] != b"moov":
        at += struct.unpack(">I", film[at:at + 4])[0]
    moov = film[at + 8:at + struct.unpack(">I", film[at:at + 4])[0]]
    title = box(b"udta", box(b"\xa9nam", struct.pack(">HH", len(TITLE), 0) + TITLE))
    return film[:at] + box(b"moov", moov + title) + box(b"free", TITLE)


def film(test):
    """A short film that others share."""
    if not _film:
        made = program.short().with_suffix(".mp4")
        test.well("render", program.short(), "-o", made, "--size", "320x180")
        made.write_bytes(titled(made.read_bytes()))
        _film.append(made)
    return _film[0]


class Blinded(manifest_test.Manifest):
    def setUp(self):
        super().setUp()
        rows = self.make(8, 1)
        self.write(rows)
        self.well("import", "--manifest", self.table, "--cohort", self.cohort)
        self.pack = self.path("pack")

    def query(self, sql):
        with closing(sqlite3.connect(f"file:{self.cohort}?mode=ro", uri=True)) as database:
            return database.execute(sql).fetchall()


class Packs(Blinded):
    def setUp(self):
        super().setUp()
        self.uuids = dict(self.query("SELECT p.pseudonym, a.uuid FROM attempt a JOIN participant p ON p.id = a.participant"))
        self.path("films.csv").write_text("attempt,film\n" + "".join(f"{u},{film(self)}\n" for u in self.uuids.values()))

    def make_pack(self, *more, raters="R1,R2", films=None):
        return ("rate", "pack", self.cohort, "--form", "goals", "--films", films or self.path("films.csv"), "--raters", raters, "-o", self.pack, *more)

    def data(self, rater):
        page = (self.pack / rater / "rate.html").read_text()
        return json.loads(re.search(r'id="data">(.*?)</script>', page).group(1))

    def answers(self, rater, blank=()):
        """As the page saves them, by a calculation of its own."""
        data = self.data(rater)
        films = [{"film": f, "scores": {i["key"]: "-" if n in blank else str(1 + (n + k) % 5) for k, i in enumerate(data["items"])}}
                 for n, f in enumerate(data["films"])]
        return {"format": "calot-answers", "formatVersion": 1, "pack": data["pack"], "rater": rater, "films": films}

    def take(self, answers, *more):
        self.path("answers.json").write_text(json.dumps(answers))
        return ("rate", self.cohort, "--take", self.path("answers.json"), *more)

    def test_a_pack_says_nothing_of_the_attempts(self):
        self.assertIn("8 films for 2 raters", self.well(*self.make_pack()).out)
        self.assertEqual(sorted(p.name for p in self.pack.iterdir()), ["R1", "R2"])
        words = [*self.uuids.values(), "expert", "novice", "short.mp4", "unskilled", "Miller", "Lavf", "motion"]
        files = [p for p in self.pack.rglob("*") if p.is_file()]
        self.assertEqual(len(files), 2 * 9)
        self.assertEqual(len({p.stat().st_mtime for p in files}), 1, "their times tell their order")
        for file in files:
            content = file.read_bytes()
            for word in words:
                self.assertNotIn(word.encode(), content, f"{word} in {file.name}")
            if file.suffix == ".html":  # in a film's bytes two letters stand by chance
                for word in (*self.uuids, *(f"p{i}-0" for i in range(8))):
                    self.assertIsNone(re.search(rf"(?<![\w/+]){word}(?![\w/+=])", content.decode()), f"{word} in {file.name}")
        one, two = self.data("R1"), self.data("R2")
        key = {(r, n): a for r, n, a in self.query("SELECT rater, name, uuid FROM rating_pack_film JOIN attempt ON attempt.id = attempt")}
        self.assertFalse(set(one["films"]) & set(two["films"]))
        self.assertNotEqual([key["R1", f] for f in one["films"]], [key["R2", f] for f in two["films"]])
        for rater, data in (("R1", one), ("R2", two)):
            self.assertEqual(sorted(key[rater, f] for f in data["films"]), sorted(self.uuids.values()))
            self.assertEqual({p.stem for p in (self.pack / rater / "films").iterdir()}, set(data["films"]))
        self.refused(2, *self.make_pack(), names=(self.pack, "exists"))

    def test_the_page_loads_and_sends_nothing(self):
        self.well(*self.make_pack(raters="R1"))
        page = (self.pack / "R1/rate.html").read_text()
        policy = re.search(r'Content-Security-Policy" content="(.*?)"', page).group(1)
        self.assertTrue(policy.startswith("default-src 'none'; "))
        self.assertNotIn("unsafe", policy)
        self.assertIsNone(re.search(r"https?://|//[a-z]|\son\w+=|style=|import\(|fetch\(|XMLHttpRequest|WebSocket|sendBeacon", page))
        for kind, tag in (("script", "script"), ("style", "style")):
            text = re.search(rf"<{tag}>(.*?)</{tag}>", page, re.S).group(1)
            digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
            self.assertIn(f"{kind}-src 'sha256-{digest}'", policy)

    def test_answers_come_back(self):
        self.well(*self.make_pack())
        key = dict(self.query("SELECT name, uuid FROM rating_pack_film JOIN attempt ON attempt.id = attempt WHERE rater = 'R1'"))
        answers = self.answers("R1", blank=(2,))
        said = self.well(*self.take(answers)).out
        self.assertIn("7 ratings by R1 with goals version 2 stored, 1 films could not be judged", said)
        want = sorted((key[f["film"]], k, int(v)) for f in answers["films"] for k, v in f["scores"].items() if v != "-")
        stored = lambda: sorted(self.query("SELECT uuid, item, score FROM rating JOIN attempt ON attempt.id = attempt WHERE rater = 'R1'"))
        self.assertEqual(stored(), want)
        self.refused(3, *self.take(answers), names=("R1", "--force"))
        self.well(*self.take({**answers, "seal": "0" * 64}, "--force"))  # as pages of earlier versions save them
        self.assertEqual(stored(), want)

    def test_answers_that_are_refused(self):
        self.well(*self.make_pack())
        good = self.answers("R1")
        self.refused(3, *self.take({**good, "rater": "R2"}), names=("answers.json", "films"))
        self.refused(3, *self.take({**good, "rater": "R3"}), names=('"R3"',))
        self.refused(3, *self.take({**good, "pack": "0" * 8 + good["pack"][8:]}), names=("answers.json", "0" * 8))
        self.refused(3, *self.take({**good, "films": good["films"][1:]}), names=("1 films",))
        self.refused(4, *self.take({**good, "more": 1}), names=("answers.json: /more",))
        self.refused(4, *self.take({**good, "films": []}), names=("answers.json: /films",))
        self.path("answers.json").write_text("{")
        self.refused(4, "rate", self.cohort, "--take", self.path("answers.json"), names=("answers.json", "line 1"))
        self.assertEqual(self.query("SELECT * FROM rating"), [])
        other = self.path("other.db")
        self.well("import", self.path("motion/p0-0.txt"), "--cohort", other)
        self.path("answers.json").write_text(json.dumps(good))
        self.refused(3, "rate", other, "--take", self.path("answers.json"), names=("answers.json",))

    def test_who_withdraws_leaves_the_answers(self):
        self.well(*self.make_pack())
        answers = self.answers("R2")
        listed = self.well("participant", "withdraw", "P3", "--cohort", self.cohort, "--scope", "all", "--no-recordings").out
        self.assertIn(str(self.pack), listed)
        self.assertIn("7 ratings by R2 with goals version 2 stored, 1 films of withdrawn attempts left out", self.well(*self.take(answers)).out)

    def test_recordings_are_rendered(self):
        folder = self.path("recordings")
        folder.mkdir()
        made = self.copy(program.short(), "recordings/short.h5")
        cohort = self.path("performers.db")
        self.well("assess", made, "--cohort", cohort)
        self.well("rate", "pack", cohort, "--form", "osats", "--films", folder, "--raters", "R1", "-o", self.pack)
        films = list((self.pack / "R1/films").iterdir())
        self.assertEqual(len(films), 1)
        self.assertIn(b"ftyp", films[0].read_bytes()[:16])

    def test_what_no_pack_is_made_of(self):
        uuid = self.uuids["P0"]
        self.refused(2, *self.make_pack(raters="R1,R1"), names=("--raters", "R1"))
        self.refused(2, *self.make_pack(raters="../R1"), names=("--raters",))
        self.refused(2, "rate", "pack", self.cohort, "--form", "questionnaire-2014", "--films", self.path("films.csv"), "--raters", "R1", "-o",
                     self.pack, names=("questionnaire-2014",))
        self.refused(4, *self.make_pack(films=self.path("motion")), names=("--attempts",))
        self.path("films.csv").write_text(f"attempt,film\n{uuid},none.mp4\n")
        self.refused(4, *self.make_pack(), names=("films.csv", "line 2", "none.mp4"))
        self.path("films.csv").write_text(f"attempt,film\n{uuid},motion/p0-0.txt\n")
        self.refused(4, *self.make_pack(), names=("p0-0.txt",))
        self.assertFalse(self.pack.exists())
        self.assertEqual(self.query("SELECT * FROM rating_pack"), [])
        self.assertEqual([p.name for p in self.folder.iterdir() if ".part" in p.name], [])


PROTOCOL = {
    "format": "calot-protocol", "formatVersion": 1, "name": "tremor", "version": 1, "title": "Steady hands", "operators": "people",
    "populations": [{"group": "expert", "definition": "two hundred operations"}, {"group": "novice", "definition": "none"}],
    "better": "expert", "unit": "participant", "attemptRule": "single", "exclusions": {"outcomes": [], "reasons": []},
    "missing": "complete-cases", "level": 0.05,
    "hypotheses": [{"checkpoint": "path-length", "subject": "left", "larger": "novice", "primary": True}],
}


class Masked(Blinded):
    def setUp(self):
        super().setUp()
        self.protocol = self.path("p.json")
        self.protocol.write_text(json.dumps(PROTOCOL))
        self.study = ("study", self.cohort, "--protocol", self.protocol)

    def test_masked_until_locked(self):
        plain = json.loads(self.well(*self.study, "--json").out)
        self.well("protocol", "register", self.protocol, self.cohort, "--by", "me")
        masked = json.loads(self.well(*self.study, "--masked", "--json").out)
        self.assertEqual(masked["groups"], ["group 1", "group 2"])
        self.assertTrue(masked["protocol"]["masked"])
        text = self.well(*self.study, "--masked", "--all", "--html", self.path("m.html"), "--csv", self.path("m")).out
        shown = text + self.path("m.html").read_text() + json.dumps(masked) + "".join(f.read_text() for f in self.path("m").iterdir())
        self.assertIsNone(re.search(r"expert(?!_mean)|novice(?!_mean)|two hundred|\bP\d\b", shown))
        row = lambda study: next(r for r in study["rows"] if (r["checkpoint"], r["subject"]) == ("path-length", "left"))
        self.assertIsNone(row(masked)["hypothesis"])
        self.assertIsNone(row(masked)["supported"])
        # The same figures under drawn names, the same ones each time.
        means = sorted(g["mean"] for g in row(masked)["groups"])
        self.assertEqual(means, sorted(g["mean"] for g in row(plain)["groups"]))
        self.assertEqual(row(masked)["mann_whitney"]["p"], row(plain)["mann_whitney"]["p"])
        self.assertEqual(json.loads(self.well(*self.study, "--masked", "--json").out)["rows"], masked["rows"])
        swapped = self.query("SELECT swapped FROM group_mask")[0][0]
        self.assertEqual([g["mean"] for g in row(masked)["groups"]],
                         [g["mean"] for g in row(plain)["groups"]][::-1 if swapped else 1])
        # Once masked, it stays so for who doesn't ask.
        self.assertEqual(json.loads(self.well(*self.study, "--json").out)["groups"], ["group 1", "group 2"])

        # Nor is it unmasked by another analysis of the same cohort.
        other = self.path("other.json")
        other.write_text(json.dumps({**PROTOCOL, "name": "other"}))
        for more in (("study", self.cohort), ("study", self.cohort, "--protocol", other), ("study", self.cohort, "--design", "reliability"),
                     ("study", self.cohort, "--design", "strata", "--strata", "site")):
            with self.subTest(" ".join(map(str, more[2:]))):
                self.refused(3, *more, names=(self.cohort, "masked", "tremor version 1"))

        locked = self.well("protocol", "lock", self.protocol, self.cohort, "--by", "me").out
        self.assertIn("locked on", locked)
        self.well("study", self.cohort)
        self.well("study", self.cohort, "--protocol", other)
        self.assertIn("was locked on", self.well("protocol", "lock", self.protocol, self.cohort, "--by", "you").out)
        for more in ((), ("--masked",)):
            named = json.loads(self.well(*self.study, *more, "--json").out)
            self.assertEqual((named["groups"], named["protocol"]["masked"]), (["expert", "novice"], False))
            self.assertEqual((named["protocol"]["lock"]["by"], named["protocol"]["lock"]["changed"]), ("me", []))
        self.assertIn("nothing has changed since", " ".join(self.well(*self.study).out.split()))

        self.well("participant", "set", "P1", "--cohort", self.cohort, "--experience", "laparoscopies=3")
        named = json.loads(self.well(*self.study, "--phases", "--json").out)
        self.assertEqual(named["protocol"]["lock"]["changed"], ["data", "options"])
        self.assertIn("changed since: data", " ".join(self.well(*self.study).out.split()))

    def test_what_is_refused(self):
        self.refused(2, "study", self.cohort, "--masked", names=("--masked", "--protocol"))
        self.refused(3, "protocol", "lock", self.protocol, self.cohort, "--by", "me", names=("protocol register",))
        self.well("protocol", "register", self.protocol, self.cohort, "--by", "me")
        self.refused(2, "protocol", "lock", self.protocol, self.cohort, "--by", "", names=("protocol: ",))
        self.refused(4, "protocol", "lock", self.protocol, self.path("none.db"), "--by", "me", names=("none.db",))
        self.assertEqual(self.query("SELECT * FROM analysis_lock"), [])
        self.well("protocol", "lock", self.protocol, self.cohort, "--by", "me")
        changed = self.path("p2.json")
        changed.write_text(json.dumps({**PROTOCOL, "version": 2}))
        self.assertEqual(json.loads(self.well("study", self.cohort, "--protocol", changed, "--masked", "--json").out)["groups"], ["group 1", "group 2"])

    def test_a_merge_keeps_its_own_masks(self):
        self.well(*self.study, "--masked")
        into = self.path("into.db")
        self.well("import", self.path("motion/p0-0.txt"), "--participant", "P0", "--mode", "assessment", "--task", "reaching", "--outcome", "completed",
                  "--start", "2026-01-01T09:00:00Z", "--purpose", "demo", "--cohort", into)
        self.well("participant", "set", "P0", "--group", "expert", "--cohort", into)
        self.well("cohort", "merge", into, self.cohort)
        with closing(sqlite3.connect(into)) as database:
            self.assertEqual(database.execute("SELECT count(*) FROM group_mask").fetchone(), (0,))


if __name__ == "__main__":
    program.main()
