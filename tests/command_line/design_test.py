# SPDX-License-Identifier: GPL-3.0-or-later
"""calot study --design: of a table against R's values, of a cohort against closed forms; reports, and what is refused."""

import json
import math
import sqlite3
import unittest
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
        """Of balanced data the mixed model's fixed effects are those of each person's own line."""
        result = self.of("repeated")["results"][0]
        slope = {who: (v[2] - v[0]) / 2.0 for who, v in self.values.items()}
        first = {who: v.mean() - slope[who] for who, v in self.values.items()}

        def mean(what, group):
            return numpy.mean([what[who] for who in what if self.group[who] == group])
        self.assertAlmostEqual(result["group"]["estimate"], mean(first, "expert") - mean(first, "novice"), delta=1e-8)
        self.assertAlmostEqual(result["occasion"][0]["estimate"], mean(slope, "novice"), delta=1e-8)
        self.assertAlmostEqual(result["interaction"][0]["estimate"], mean(slope, "expert") - mean(slope, "novice"), delta=1e-8)
        self.assertEqual((result["participants"], result["attempts"]), (8, 24))

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


if __name__ == "__main__":
    program.main()
