# SPDX-License-Identifier: GPL-3.0-or-later
"""What a study prints of its people, and what it must not: flow, Table 1, confounding, consent, p without a hypothesis."""

import json
import re

import numpy as np
import program
from blinding_test import PROTOCOL
from cohort_content import edited
from manifest_test import Manifest


class People(Manifest):
    def fill(self, people=10, each=2, change=lambda rows: rows):
        self.write(change(self.make(people, each)))
        self.well("import", "--manifest", self.table, "--cohort", self.cohort)

    def set(self, who, *more):
        self.well("participant", "set", who, "--cohort", self.cohort, *more)

    def said(self, *more, rule=("--attempt-rule", "mean")):
        return json.loads(self.well("study", self.cohort, *rule, "--json", *more).out)

    def text(self, *more):
        return self.well("study", self.cohort, "--attempt-rule", "mean", *more).out

    def test_people_flow_to_the_analysis_by_group_and_reason(self):
        def change(rows):
            for row in rows:
                if row["participant"] == "P3":
                    row["mode"] = "practice"
            rows[1]["mode"] = "practice"  # one of P0's two: P0 stays
            return rows
        self.fill(change=change)
        self.well("participant", "add", "P90", "--cohort", self.cohort, "--group", "novice")
        self.well("participant", "add", "P91", "--cohort", self.cohort)
        flow = self.said()["flow"]
        self.assertEqual((flow["recruited"], flow["analysed"]), (20, 17))
        self.assertEqual(flow["recruited_participants"], {"no group": 1, "expert": 5, "novice": 6})
        self.assertEqual(flow["analysed_participants"], {"expert": 5, "novice": 4})
        self.assertEqual(flow["excluded"], [{"reason": "no attempt", "attempts": 0, "participants": {"no group": 1, "novice": 1}},
                                            {"reason": "practice", "attempts": 3, "participants": {"novice": 1}}])
        self.assertRegex(self.text(), r"left out: practice +1 +1 +3\n")

    def test_who_has_not_consented_stays_out_and_is_counted(self):
        self.fill(each=3)
        self.assertEqual(self.said()["flow"]["analysed"], 30)
        self.assertIn("No consent is recorded", self.text())
        for i in range(9):
            self.set(f"P{i}", "--consent", ("study" if i % 2 else "research") + ":2026-01-01")
        self.set("P9", "--consent", "training:2026-01-01")
        for more in (("--attempt-rule", "mean"), ("--design", "reliability", "--family", "path-length")):
            flow = self.said(*more, rule=())["flow"]
            left = flow.get("excluded") or flow["left_out"]
            self.assertEqual((flow["analysed"], left[0]["reason"], len(left)), (27, "no consent to research", 1))
        self.assertNotIn("No consent is recorded", self.text())

    def test_table_1(self):
        def change(rows):
            return [{**row, "handedness": "left" if row["participant"] == "P2" else "right"} for row in rows]
        self.fill(change=change)
        for i in range(10):
            self.set(f"P{i}", "--arm", "early" if i < 5 else "late")
        table = {row["characteristic"]: row["groups"] for row in self.said()["table_1"]}
        self.assertEqual(table["participants"], ["5", "5"])
        self.assertEqual(table["attempts"], ["10", "10"])
        self.assertEqual(table["laparoscopies"], ["204 [202, 206]", "5.00 [3.00, 7.00]"])
        self.assertEqual(table["handedness"], ["left 1, right 4", "right 5"])
        self.assertEqual(table["arm"], ["early 3, late 2", "early 2, late 3"])
        self.assertNotIn("site", table, "nobody has one")
        self.set("P0", "--site", "north")
        table = {row["characteristic"]: row["groups"] for row in self.said()["table_1"]}
        self.assertEqual(table["site"], ["north 1, not recorded 4", "not recorded 5"])
        self.assertIn("Table 1", self.text())

    def test_site_and_device_that_go_with_the_group_are_a_warning(self):
        self.fill()
        for i in range(10):
            self.set(f"P{i}", "--site", ("north", "south")[i % 2])
        text = " ".join(self.text().split())
        self.assertIn("Warning: site is confounded with group (expert: north 5; novice: south 5)", text)
        self.set("P0", "--site", "south")
        self.assertIn("Warning: site goes with group", self.text())
        for i in range(10):
            self.set(f"P{i}", "--site", ("north", "south")[i // 2 % 2])
        self.assertNotIn("Warning: site", self.text())
        with edited(self.cohort) as database:  # as two stations would give it
            database.execute("UPDATE attempt SET device = (SELECT study_group FROM participant p WHERE p.id = participant) || ' device', "
                             "comparability_key = comparability_key || (participant % 2)")
        self.assertIn("Warning: device is confounded with group", " ".join(self.text("--mix-keys").split()))

    def test_unequal_numbers_of_attempts_are_a_warning(self):
        self.fill(change=lambda rows: [r for r in rows if r["participant"] != "P1" or r["start"].startswith("2026-01-01")])
        self.assertIn("numbers of attempts are unequal, 1 to 2 a participant", " ".join(self.text().split()))
        first = self.well("study", self.cohort, "--attempt-rule", "first").out
        self.assertNotIn("are unequal", first)

    def test_no_p_without_a_hypothesis(self):
        self.fill()
        for more in ((), ("--all",)):
            text = self.text(*more)
            self.assertNotIn("1.0000", text)
            self.assertIsNone(re.search(r"Holm| p  ", text), text)
            self.assertIn("not simultaneous", " ".join(text.split()))
        self.assertTrue(all(r["mann_whitney"].get("p_holm") is None for r in self.said()["rows"]))
        text = self.text("--family", "path-length")
        self.assertRegex(text, r" p +Holm")
        self.assertRegex(text, r"(?m)^figure .*expert +novice", "medians")

    def test_a_figure_without_a_direction_is_never_against_the_hypothesis(self):
        self.fill()
        page = self.path("p.html")
        text = " ".join(self.text("--family", "path-length,hand-ratio", "--html", page).split())
        self.assertIn("for hand-ratio, without a direction: that a member of expert has the larger value", text)
        plots = re.findall(r"<svg.*?</svg>", page.read_text(), re.S)
        forests = [plot for plot in plots if "novice better" in plot or "novice larger" in plot]
        self.assertEqual(len(forests), 2, "one of figures with a direction, one of those without")
        for plot in forests:
            self.assertEqual("novice better" in plot, "hand-ratio" not in plot)
            self.assertEqual("novice larger" in plot, "hand-ratio" in plot)

    def test_three_hypotheses_are_two_pages(self):
        if "--pdf" not in program.calot("study", "--help").out:
            self.skipTest("no PDF in this build")
        self.fill(20)
        for i in range(20):
            self.set(f"P{i}", "--site", ("north", "south")[i // 2 % 2], "--arm", "early", "--consent", "study:2026-01-01")
        hypotheses = [{"checkpoint": c, "subject": "left", "larger": "novice", "primary": True} for c in ("path-length", "depth-path", "speed-p95")]
        self.path("p.json").write_text(json.dumps({**PROTOCOL, "attemptRule": "mean", "hypotheses": hypotheses}))
        self.well("protocol", "register", self.path("p.json"), self.cohort, "--by", "me")
        pages = lambda *more: len(re.findall(rb"/Type\s*/Page\b", self.pdf(*more)))
        self.assertLessEqual(pages(), 2)
        self.assertGreater(pages("--all"), 3)
        text = self.well("study", self.cohort, "--protocol", self.path("p.json")).out
        self.assertRegex(text, r"(?m)^hypothesis .*expert +H +novice", "medians, and what is expected of them")
        self.assertRegex(text, r"path-length left +10 \+ 10 +[\d.]+ +< +[\d.]+ ")

    def pdf(self, *more):
        self.well("study", self.cohort, "--protocol", self.path("p.json"), "--pdf", self.path("s.pdf"), "--force", *more)
        return self.path("s.pdf").read_bytes()

    def test_reliability_within_groups_stands_beside_the_pooled_one(self):
        rng = np.random.default_rng(7)
        shift = {"expert": 0.0, "novice": 40.0}
        values = {(g, i): shift[g] + rng.normal(0, 5) + rng.normal(0, 5, 3) for g in shift for i in range(6 if g == "expert" else 8)}
        rows = [f"{g}{i},{g},{a},{v[a]!r}" for (g, i), v in values.items() for a in range(3)]
        self.path("t.csv").write_text("id,level,attempt,seconds\n" + "\n".join(rows) + "\n")
        answer = json.loads(self.well("study", "--table", self.path("t.csv"), "--design", "reliability", "--participant-column", "id", "--group-column",
                                      "level", "--occasion-column", "attempt", "--outcome", "seconds", "--json").out)
        squares = lambda x: (3 * ((x.mean(1) - x.mean()) ** 2).sum(), ((x - x.mean(1, keepdims=True) - x.mean(0) + x.mean()) ** 2).sum())

        def g_of(*tables):
            df = sum(len(t) - 1 for t in tables)
            people, rest = (sum(squares(t)[i] for t in tables) for i in (0, 1))
            return 1 - (rest / (2 * df)) / (people / df)

        by = {g: np.array([v for (h, _), v in values.items() if h == g]) for g in shift}
        want = {"all": g_of(np.concatenate(list(by.values()))), "within groups": g_of(*by.values()), **{g: g_of(t) for g, t in by.items()}}
        found = {c["of"]: c["decisions"][2]["g"] for c in answer["components"]}
        self.assertEqual(list(found), ["all", "within groups", "expert", "novice"])
        for of, g in want.items():
            self.assertAlmostEqual(found[of], max(g, 0.0), 10, of)
        self.assertGreater(found["all"], 0.9)
        self.assertLess(found["within groups"], 0.85)
        self.assertEqual([e["of"] for e in answer["measurement_error"]], ["all", "expert", "novice"])
        self.assertIn("in a mixture of groups", " ".join(answer["notes"]))
        # Of a cohort, whose groups nobody names.
        self.fill(8, 3)
        answer = self.said("--design", "reliability", "--family", "path-length", rule=())
        self.assertEqual({c["of"] for c in answer["components"]} - {"within groups"}, {"all", "expert", "novice"})


if __name__ == "__main__":
    program.main()
