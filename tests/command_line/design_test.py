# SPDX-License-Identifier: GPL-3.0-or-later
"""calot study --design: of a table against R's values, of a cohort against closed forms; reports, and what is refused."""

import json
import math
import sqlite3
import unittest
import unittest.mock
from contextlib import closing

import manifest_test
import numpy
import program

PLANTS = {  # R's PlantGrowth
    "ctrl": (4.17, 5.58, 5.18, 6.11, 4.5, 4.61, 5.17, 4.53, 5.33, 5.14),
    "trt1": (4.81, 4.17, 4.41, 3.59, 5.87, 3.83, 6.03, 4.89, 4.32, 4.69),
    "trt2": (6.31, 5.12, 5.54, 5.5, 5.37, 5.29, 4.92, 6.15, 5.8, 5.26)}


class Table(program.ProgramTest):
    def setUp(self):
        super().setUp()
        rows = [(group, value) for group, values in PLANTS.items() for value in values]
        self.path("plants.csv").write_text("id,group,site,weight\n" + "".join(
            f"P{i},{group},{'north' if i % 2 else 'south'},{value}\n" for i, (group, value) in enumerate(rows)))
        self.study = ("study", "--table", self.path("plants.csv"), "--participant-column", "id", "--group-column", "group", "--outcome", "weight")

    def test_three_groups(self):
        three = (*self.study, "--groups", "ctrl,trt1,trt2")
        said = json.loads(self.well(*three, "--json").out)
        result = said["results"][0]
        # kruskal.test(weight ~ group, PlantGrowth) in R 4.2.2
        self.assertAlmostEqual(result["kruskal_wallis"]["h"], 7.98822874944367, delta=1e-11)
        self.assertAlmostEqual(result["kruskal_wallis"]["p"], 0.0184237557314721, delta=1e-13)
        self.assertEqual([(d["first"], d["second"]) for d in result["dunn"]], [("ctrl", "trt1"), ("ctrl", "trt2"), ("trt1", "trt2")])
        self.assertEqual(said["design"], "groups", "three names imply it")
        self.assertRegex(self.well(*three).out, r"(?m)^weight +10 +10 +10 +7\.988 +0\.0184")
        self.well(*three, "--html", self.path("s.html"), "--pdf", self.path("s.pdf"))
        page = self.path("s.html").read_text()
        for word in ("Kruskal-Wallis", "Dunn", "trt2"):
            self.assertIn(word, page)
        self.assertTrue(self.path("s.pdf").read_bytes().startswith(b"%PDF-"))

    def test_sites(self):
        said = json.loads(self.well(*self.study, "--groups", "ctrl,trt1", "--strata", "site", "--json").out)
        self.assertEqual(said["design"], "strata")
        one = said["results"][0]
        self.assertEqual(one["strata"], 2)
        wins = [(a > b) + 0.5 * (a == b) for i, a in enumerate(PLANTS["ctrl"]) for k, b in enumerate(PLANTS["trt1"]) if i % 2 == k % 2]
        self.assertAlmostEqual(one["a"], sum(wins) / len(wins), delta=1e-12)

    def test_what_is_refused(self):
        two = (*self.study, "--groups", "ctrl,trt1")
        self.refused(2, *two, "--criterion", 5, names=("--criterion", "learning"))
        self.refused(2, *two, "--design", "strata", names=("--strata",))
        self.refused(2, *two, "--strata", "site", "--csv", self.path("csv"), names=("--csv",))
        self.refused(2, *two, "--strata", "site", "--protocol", "cholecystectomy-2014-table2", names=("protocol",))
        self.refused(2, *two, "--design", "none", names=("none",))
        self.refused(2, *two, "--strata", "sites", names=("plants.csv", "sites"))
        self.refused(2, *two, "--design", "agreement", names=("--against",))


class Cohort(manifest_test.Manifest):
    """Eight people with three attempts each."""

    def setUp(self):
        super().setUp()
        self.write(self.make(8, 3))
        self.well("import", "--manifest", self.table, "--cohort", self.cohort)
        self.group = {f"P{i}": ("expert", "novice")[i % 2] for i in range(8)}
        self.values = {name: numpy.empty(3) for name in self.group}  # mm, by participant and attempt
        with closing(sqlite3.connect(f"file:{self.cohort}?mode=ro", uri=True)) as database:
            for who, start, value in database.execute(
                    "SELECT p.pseudonym, a.start_utc, v.value FROM attempt a JOIN participant p ON p.id = a.participant "
                    "JOIN checkpoint_value v ON v.attempt = a.id WHERE v.name = 'path-length' AND v.subject = 'left'"):
                self.values[who][int(start[8:10]) - 1] = 1000.0 * value

    def of(self, design, *more):
        return json.loads(self.well("study", self.cohort, "--design", design, "--family", "path-length left", *more, "--json").out)

    def test_repeated_attempts(self):
        """Each person's own slope, compared by ranks."""
        said = self.of("repeated")
        slope = {who: (v[2] - v[0]) / 2.0 for who, v in self.values.items()}
        expert, novice = ([slope[who] for who in slope if self.group[who] == group] for group in ("expert", "novice"))
        change = said["changes"][0]
        self.assertAlmostEqual(change["groups"][0]["median"], numpy.median(expert), delta=1e-9)
        self.assertAlmostEqual(change["shift"], numpy.median([x - y for x in expert for y in novice]), delta=1e-9)
        self.assertAlmostEqual(change["a"], numpy.mean([x > y for x in expert for y in novice]), delta=1e-12)
        mean = {group: numpy.mean([v.mean() for who, v in self.values.items() if self.group[who] == group]) for group in ("expert", "novice")}
        result = said["results"][0]
        self.assertAlmostEqual(result["overall"]["difference"], mean["expert"] - mean["novice"], delta=1e-8)
        self.assertEqual(result["attempts"], 24)

    def test_error_of_measurement(self):
        said = self.of("reliability")
        error = said["measurement_error"][0]
        sem = math.sqrt(sum(((v - v.mean())**2).sum() for v in self.values.values()) / 16.0)
        self.assertAlmostEqual(error["sem"], sem, delta=1e-9)
        self.assertAlmostEqual(error["sdc"], 1.959963984540054 * math.sqrt(2.0) * sem, delta=1e-8)
        self.assertEqual((error["people"], error["df"]), (8, 16.0))

    def test_learning(self):
        middle = float(numpy.median(numpy.concatenate(list(self.values.values()))))
        said = self.of("learning", "--criterion", middle)
        reached = {group: sum((v <= middle).any() for who, v in self.values.items() if self.group[who] == group) for group in ("expert", "novice")}
        text = self.well("study", self.cohort, "--design", "learning", "--family", "path-length left", "--criterion", middle).out
        for group, count in reached.items():
            self.assertRegex(text, rf"(?m)^{group} +4 +{count} ")
        self.assertEqual(said["participants"], 8)

    def test_one_value_of_each(self):
        correlation = ("study", self.cohort, "--design", "correlation", "--against", "path-length right")
        self.refused(3, *correlation, names=("P0", "--attempt-rule"))
        said = json.loads(self.well(*correlation, "--attempt-rule", "mean", "--family", "path-length left,path-length right", "--json").out)
        self.assertEqual(said["attempt_rule"], "the mean of a participant's attempts")
        self.refused(2, "study", self.cohort, "--design", "repeated", "--masked", names=("--masked",))
        self.refused(2, "study", self.cohort, "--design", "reliability", "--family", "none", names=("none", "path-length left"))


class Unfinished(manifest_test.Manifest):
    """Five experts finish; of five novices two finish, and faster, and three give up. A sixth expert's file only ends."""

    def setUp(self):
        super().setUp()
        generator = program.seeded("unfinished")
        times = [("expert", t, "completed") for t in (10.0, 10.2, 10.4, 10.8, 11.0)] + [("expert", 5.0, "")]
        times += [("novice", t, "completed") for t in (9.6, 9.8)] + [("novice", 20.0, "abandoned")] * 3
        rows = []
        for i, (group, seconds, outcome) in enumerate(times):
            with unittest.mock.patch.object(manifest_test, "ROWS", round(30 * seconds) + 1):
                self.path(f"p{i}.txt").write_text(manifest_test.motion(generator, 0.002))
            rows.append({"file": f"p{i}.txt", "participant": f"P{i}", "group": group, "task": "reaching",
                         "start": f"2026-01-01T09:{i:02}:00Z", "outcome": outcome, "purpose": "demo", "mode": "assessment"})
        self.write(rows)
        self.well("import", "--manifest", self.table, "--cohort", self.cohort)
        people = [{"group": group, "definition": group} for group in ("expert", "novice")]
        self.path("p.json").write_text(json.dumps({
            "format": "calot-protocol", "formatVersion": 1, "name": "times", "version": 1, "title": "Experts finish sooner",
            "populations": people, "better": "expert", "unit": "participant", "attemptRule": "single",
            "exclusions": {"outcomes": [], "reasons": []}, "missing": "worst-rank", "level": 0.05,
            "hypotheses": [{"checkpoint": "elapsed-time", "larger": "novice", "primary": True}]}))

    def test_the_outcome_ranks_in_every_design(self):
        study = ("study", self.cohort, "--protocol", self.path("p.json"))
        rows = {(r["checkpoint"], r["subject"]): r for r in json.loads(self.well(*study, "--json").out)["rows"]}
        time, path = rows["elapsed-time", ""], rows["path-length", "left"]
        self.assertEqual((time["groups"][0]["n"], time["groups"][1]["n"], time["worst_ranked"]), (5, 2, [0, 3]))
        self.assertAlmostEqual(time["area"]["a"], 0.6, delta=1e-12)
        self.assertEqual((path["unfinished"], path["worst_ranked"]), ([0, 3], [0, 0]))
        text = self.well(*study, "--all").out
        self.assertIn("path-length left *", text)
        self.assertIn("3 novice", text)
        first = json.loads(self.well("study", self.cohort, "--design", "time-to-criterion", "--json").out)["results"][0]
        self.assertAlmostEqual(first["worst_rank"]["a"], 0.6, delta=1e-12)
        self.assertEqual((first["not_ranked"], first["groups"][0]["n"]), (1, 6))

    def test_strata_have_the_direction_of_two_groups(self):
        table = self.path("t.csv")
        table.write_text("id,group,site,seconds\n" + "".join(
            f"P{i},{('expert', 'novice')[i % 2]},{'ab'[i // 2 % 2]},{10 + i % 2 * 5 + i / 10}\n" for i in range(12)))
        study = ("study", "--table", table, "--participant-column", "id", "--group-column", "group", "--outcome", "seconds:lower")
        two = json.loads(self.well(*study, "--json").out)["rows"][0]
        strata = json.loads(self.well(*study, "--strata", "site", "--json").out)["results"][0]
        self.assertEqual((two["area"]["a"], strata["a"], strata["a_of"]), (1.0, 1.0, "expert better"))

    def test_groups_that_scatter_differently(self):
        table = self.path("t.csv")
        generator = program.seeded("spread")
        table.write_text("id,group,seconds\n" + "".join(
            f"P{i},{'expert' if i < 24 else 'novice'},{generator.gauss(0, 1 if i < 24 else 4)}\n" for i in range(32)))
        study = ("study", "--table", table, "--participant-column", "id", "--group-column", "group", "--outcome", "seconds")
        said = json.loads(self.well(*study, "--json").out)["rows"][0]
        self.assertTrue(any("Munzel" in warning for warning in said["coverage_warnings"]))
        chosen = json.loads(self.well(*study, "--unequal-spread", "--json").out)["rows"][0]
        self.assertEqual(chosen["mann_whitney"]["p"], said["brunner_munzel"]["p"])
        self.assertTrue(chosen["brunner_munzel"]["decides"])
        self.refused(2, *study, "--design", "repeated", "--unequal-spread", names=("--unequal-spread",))


if __name__ == "__main__":
    program.main()
