# SPDX-License-Identifier: GPL-3.0-or-later
"""calot dossier: an argument from what a cohort holds, with what is missing; and a norm that another site applies, whose signed figures
come back."""

import json
import math
import random
import re
import subprocess
import sys

import program

GOALS = ("depth-perception", "bimanual-dexterity", "efficiency", "tissue-handling", "autonomy")
EYE = [1, 0, 0, 0, 1, 0, 0, 0, 1]


def motion(seconds, reach, chance):
    """Two hands at 30 Hz, 76 columns."""
    phase = [[chance.uniform(0, 6) for _ in range(3)] for _ in range(2)]
    rows = []
    for k in range(int(seconds * 30)):
        hands = [[reach * math.sin(2.1 * k / 30 + p) for p in phase[hand]] for hand in range(2)]
        rows.append(" ".join(repr(float(x)) for group in range(4) for x in (hands[group - 2] if group > 1 else [0, 0, 0]) + EYE + [0] * 7))
    return "\n".join(rows) + "\n"


class Dossier(program.ProgramTest):
    def cohort(self, name, people=5, attempts=2, seed=1):
        """Imported trials of as many experts as novices, who take longer and reach farther."""
        chance = random.Random(seed)
        lines = ["file,participant,group,task,start,outcome"]
        for group, seconds, reach in (("expert", 8, 0.02), ("novice", 13, 0.03)):
            for p in range(people):
                own = math.exp(chance.gauss(0, 0.1))
                for a in range(attempts):
                    file = f"{name}-{group}{p}-{a}.txt"
                    self.path(file).write_text(motion(seconds * own * math.exp(chance.gauss(0, 0.04)), reach * own, chance))
                    lines.append(f"{file},{name}{group[0]}{p},{group},knots,2026-03-{p + 1:02d}T1{a}:00:00Z,completed")
        self.path(f"{name}.csv").write_text("\n".join(lines) + "\n")
        self.well("import", "--manifest", self.path(f"{name}.csv"), "--mode", "assessment", "--purpose", "study", "--cohort",
                  self.path(f"{name}.db"))
        return self.path(f"{name}.db")

    def norm(self, database):
        self.well("norm", "create", database, "clinic", "--by", "T", "--rule", "all", "--checkpoints", "elapsed-time", "--attempt-rule",
                  "first", "--better", "expert")

    def dossier(self, database, *more):
        return json.loads(self.well("dossier", database, "--attempt-rule", "first", "--better", "expert", "--json", *more).out)

    def item(self, dossier, section, item):
        for s in dossier["sections"]:
            if s["title"].startswith(section):
                for i in s["items"]:
                    if i["item"].startswith(item):
                        return i
        raise AssertionError((section, item))

    def test_an_empty_argument_says_what_is_missing(self):
        database = self.cohort("a", people=3, attempts=1)
        made = self.dossier(database)
        self.assertEqual(len([i for s in made["sections"] if "Cheng" in s["title"] for i in s["items"]]), 21)
        self.assertEqual(len([i for s in made["sections"] if "GRRAS" in s["title"] for i in s["items"]]), 15)
        self.assertEqual(len([i for s in made["sections"] if "Messick" in s["title"] for i in s["items"]]), 5)
        for section, item, state in (("Kane", "generalisation", "part"), ("Kane", "decision", "no"), ("Raters", "description", "no"),
                                     ("Reporting: simulation", "CONSORT 17", "no"), ("Reporting: simulation", "CONSORT 1 ", "author"),
                                     ("Messick", "consequences", "no")):
            with self.subTest(item=item):
                found = self.item(made, section, item)
                self.assertEqual(found["state"], state, found)
                self.assertTrue(found["missing"])
        # Expert against novice alone: held, and called weak.
        self.assertIn("Cook 2015", self.item(made, "Messick", "relations")["caution"])
        self.assertIn("Cook 2015", " ".join(made["about"]))

    def test_what_a_cohort_holds_is_filled_in(self):
        database = self.cohort("a")
        self.norm(database)
        attempts = [a["attempt"] for a in json.loads(self.well("attempt", "list", database, "--json").out)["attempts"]]
        for n, attempt in enumerate(attempts[:6]):
            for r, rater in enumerate(("R1", "R2")):
                self.well("rate", database, "--form", "goals", "--attempt", attempt, "--rater", rater,
                          *[a for i, g in enumerate(GOALS) for a in ("--answer", f"{g}={1 + (n + r * (i == 0)) % 5}")])
        self.assertEqual(self.item(self.dossier(database), "Raters", "description")["state"], "part")
        for rater in ("R1", "R2"):
            self.well("rate", database, "--rater", rater, "--describe", "experience=surgeon, 12 years", "--describe", "training=10 films",
                      "--describe", "independence=knows nobody")
        self.refused(2, "rate", database, "--rater", "R1", "--describe", "experience", names=("--describe", "experience"))
        made = self.dossier(database)
        self.assertEqual(self.item(made, "Raters", "description")["state"], "yes")
        self.assertIn("R1: experience surgeon, 12 years", " ".join(self.item(made, "Raters", "description")["found"]))
        self.assertEqual(self.item(made, "Kane", "generalisation")["state"], "yes")
        self.assertEqual(self.item(made, "Kane", "decision")["state"], "yes")
        self.assertIn("ICC(2,1)", " ".join(self.item(made, "Reporting: simulation", "CONSORT 17")["found"]))
        norm = made["facts"]["norms"][0]
        self.assertEqual((norm["false_pass"]["of"], norm["false_fail"]["of"], norm["agreement"]["of"], norm["graded"]), (5, 5, 10, 20))
        # The error of measurement is that of the reliability design.
        sem = {e["figure"]: e["sem"] for e in json.loads(self.well("study", database, "--design", "reliability", "--json").out)
               ["measurement_error"] if e["of"] == "all"}["elapsed-time"]
        self.assertIn(f"{sem:.4g}", " ".join(self.item(made, "Kane", "generalisation")["found"]))

    def test_text_and_page_hold_the_same(self):
        database = self.cohort("a", people=3)
        text = self.well("dossier", database, "--attempt-rule", "first", "--better", "expert", "--html", self.path("d.html")).out
        page = self.path("d.html").read_text()
        for words in ("Kane's argument", "Messick's five sources", "GRRAS", "STROBE 22"):
            self.assertIn(words, text)
            self.assertIn(words.replace("'", "&#39;"), page.replace("&apos;", "&#39;"))
        self.refused(2, "dossier", database, "--html", self.path("d.html"), names=("d.html",))
        self.refused(4, "dossier", self.path("none.db"), names=("none.db",))

    def test_what_cannot_be_compared_is_said_and_the_rest_stands(self):
        made = json.loads(self.well("dossier", self.cohort("a", people=3), "--json").out)  # two attempts each, and no rule for them
        self.assertIn("reason", made["facts"]["study"])
        self.assertIn(made["facts"]["study"]["reason"][:30], " ".join(self.item(made, "The data", "comparison")["found"]))
        self.assertEqual(self.item(made, "Kane", "scoring")["state"], "part")

    def exchange(self, code, *words):
        """Runs python/examples/exchange_norm.py."""
        done = subprocess.run([sys.executable, program.SOURCE / "python/examples/exchange_norm.py", "--calot", program.PROGRAM, *words],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1 if code else 0, done.stderr)
        return done.stderr

    def test_a_frozen_norm_travels_and_signed_figures_come_back(self):
        here, there = self.cohort("a"), self.cohort("b", seed=2)
        self.norm(here)
        self.exchange(0, "freeze", here, "clinic", "-o", self.path("clinic.json"))
        self.exchange(0, "apply", self.path("clinic.json"), there, "--better", "expert", "-o", self.path("f.json"))
        for file in ("clinic.json", "f.json"):
            text = self.path(file).read_text()
            self.assertNotRegex(text, r"[0-9a-f]{8}-[0-9a-f]{4}-")  # uuids
            self.assertNotRegex(text, r'"[ab][en]\d"')  # people
            self.assertNotIn("2026-03-", text)
        sent = json.loads(self.path("f.json").read_text())
        self.assertEqual((sent["false_pass"]["of"], sent["false_fail"]["of"]), (5, 5))
        self.assertEqual(sent["program"], sent["norm_program"])
        # The same people by the same norm here: what the norm's own rule says of its members.
        self.exchange(0, "apply", self.path("clinic.json"), here, "--better", "expert", "-o", self.path("own.json"))
        own, rates = json.loads(self.path("own.json").read_text()), json.loads(self.well("norm", "show", here, "clinic", "--json").out)["pass_rate"]
        self.assertEqual((own["false_fail"]["of"] - own["false_fail"]["count"], own["false_pass"]["count"]),
                         (rates["competent"][0], rates["others"][0]))

        self.well("station", "init", "north", "-o", self.path("key.json"))
        self.well("station", "sign", self.path("f.json"), "--station-key", self.path("key.json"), "-o", self.path("s.json"))
        found = " ".join(self.item(self.dossier(here, "--external", self.path("s.json")), "Kane", "extrapolation")["found"])
        for words in ("clinic version 1 at north", "not registered here", "; the norm of this cohort; the same program"):
            self.assertIn(words, found)
        key = re.search(r"[0-9a-f]{64}", self.well("station", "show", self.path("key.json")).out)[0]
        self.well("cohort", "station", "north", "--cohort", here, "--public-key", key)
        found = " ".join(self.item(self.dossier(here, "--external", self.path("s.json")), "Messick", "relations")["found"])
        self.assertIn("its registered key", found)

        # A number changed on the way; a norm changed on the way; another station's key; another norm.
        signed = json.loads(self.path("s.json").read_text())
        self.write("t.json", {**signed, "text": signed["text"].replace('"of": 5', '"of": 9')})
        self.refused(4, "dossier", here, "--external", self.path("t.json"), names=("t.json",))
        frozen = json.loads(self.path("clinic.json").read_text())
        frozen["norm"]["checkpoints"][0]["cut_si"] = 99.0
        self.write("bent.json", frozen)
        self.assertIn("bent.json", self.exchange(4, "apply", self.path("bent.json"), there, "--better", "expert", "-o", self.path("g.json")))
        self.well("station", "init", "north", "-o", self.path("other.json"))
        self.well("station", "sign", self.path("f.json"), "--station-key", self.path("other.json"), "-o", self.path("u.json"))
        self.refused(3, "dossier", here, "--external", self.path("u.json"), names=("u.json", "north"))
        self.norm(there)
        found = " ".join(self.item(self.dossier(there, "--external", self.path("s.json")), "Kane", "extrapolation")["found"])
        self.assertIn("NOT the norm of this cohort", found)

    def write(self, name, content):
        self.path(name).write_text(json.dumps(content))

    def test_too_few_people_send_no_figures(self):
        here, there = self.cohort("a"), self.cohort("b", people=4, seed=2)
        self.norm(here)
        self.exchange(0, "freeze", here, "clinic", "-o", self.path("clinic.json"))
        said = self.exchange(3, "apply", self.path("clinic.json"), there, "--better", "expert", "-o", self.path("f.json"))
        self.assertIn("4 and 4", said)
        self.assertFalse(self.path("f.json").exists())


if __name__ == "__main__":
    program.main()
