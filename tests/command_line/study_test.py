# SPDX-License-Identifier: GPL-3.0-or-later
"""calot study --table: a table from elsewhere, its figures held against a calculation of the test's own, and what is refused."""

import csv
import html.parser
import io
import itertools
import json
import math

import numpy as np
import program
from program import calot

PEOPLE = 8  # of which 4 in each group: all 70 assignments are gone through below
COLUMNS = ["id", "arm", "stage", "time", "score", "seconds"]
OPTIONS = ("--participant-column", "id", "--group-column", "arm")
AT_LAST = ("--occasion-column", "stage", "--occasion", "last")
OUTCOMES = ("--outcome", "score:higher", "--outcome", "seconds:lower")


def rows_of(draw):
    """Eight people at two occasions; whole scores, so that there are ties."""
    rows = []
    for i in range(PEOPLE):
        arm = "trained" if i % 2 else "control"
        for stage in ("first", "last"):
            rows.append({"id": f"P{i}", "arm": arm, "stage": stage, "time": "am", "score": draw.randint(0, 6),
                         "seconds": round(draw.uniform(20, 200), 3)})
    return rows


def text_of(rows, columns=COLUMNS):
    out = io.StringIO()
    writer = csv.DictWriter(out, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def mid_ranks(values):
    return [sum(w < v for w in values) + (sum(w == v for w in values) + 1) / 2 for v in values]


def exact_p(x, y):
    """Share of all assignments whose rank sum is as far from its expectation."""
    ranks = mid_ranks(x + y)
    middle = len(x) * (len(ranks) + 1) / 2
    far = abs(sum(ranks[:len(x)]) - middle)
    sums = [sum(c) for c in itertools.combinations(ranks, len(x))]
    return sum(abs(s - middle) >= far - 1e-9 for s in sums) / len(sums)


def holm(p):
    order = sorted(range(len(p)), key=p.__getitem__)
    adjusted, so_far = [0.0] * len(p), 0.0
    for place, i in enumerate(order):
        so_far = max(so_far, min(1.0, (len(p) - place) * p[i]))
        adjusted[i] = so_far
    return adjusted


def at_one_baseline(x, y, x_before, y_before):
    """Coefficient of the group, its HC3 error, and the slope, from the normal equations."""
    design = np.array([[1, 1, b] for b in x_before] + [[1, 0, b] for b in y_before], float)
    outcome = np.array(x + y, float)
    inverse = np.linalg.inv(design.T @ design)
    coefficients = inverse @ design.T @ outcome
    residuals = outcome - design @ coefficients
    leverage = np.diag(design @ inverse @ design.T)
    middle = design.T @ np.diag((residuals / (1 - leverage)) ** 2) @ design
    return coefficients[1], math.sqrt((inverse @ middle @ inverse)[1, 1]), coefficients[2]


class Tables(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.rows = rows_of(program.seeded("study of a table"))
        self.table = self.path("t.csv")

    def write(self, rows=None, columns=COLUMNS):
        self.table.write_text(text_of(self.rows if rows is None else rows, columns))
        return self.table

    def values(self, arm, stage, column):
        return [r[column] for r in self.rows if r["arm"] == arm and r["stage"] == stage]

    def study(self, *more):
        return ("study", "--table", self.table, *OPTIONS, *more)

    def test_figures_are_those_of_the_table(self):
        self.write()
        said = json.loads(self.well(*self.study(*AT_LAST, "--baseline-occasion", "first", *OUTCOMES, "--better", "trained", "--json")).out)
        self.assertEqual((said["heading"], said["groups"], said["source"]), ("exploratory", ["control", "trained"], "table"))
        self.assertEqual((said["participants"], said["attempts"]), ([4, 4], [4, 4]))
        self.assertEqual((said["flow"]["recruited"], said["flow"]["analysed"]), (16, 8))
        tests, adjusted = [], []
        for row, column in zip(said["rows"], ("score", "seconds")):
            x, y = self.values("control", "last", column), self.values("trained", "last", column)
            self.assertEqual([g["n"] for g in row["groups"]], [4, 4])
            for group, values in zip(row["groups"], (x, y)):
                self.assertAlmostEqual(group["median"], np.median(values), 9)
                self.assertAlmostEqual(group["lower_quartile"], np.percentile(values, 25), 9)
                self.assertAlmostEqual(group["mean"], np.mean(values), 9)
                self.assertAlmostEqual(group["sd"], np.std(values, ddof=1), 9)
            if len(set(x + y)) > 1:
                self.assertAlmostEqual(row["mann_whitney"]["p"], exact_p(x, y), 12)
                tests.append((row["mann_whitney"]["p"], row["mann_whitney"]["p_holm"]))
            self.assertAlmostEqual(row["shift"]["hodges_lehmann"], np.median([a - b for a in x for b in y]), 9)
            wins = [(b > a) - (b < a) for a in x for b in y]
            if column == "seconds":
                wins = [-w for w in wins]
            share = 0.5 + sum(wins) / 32
            self.assertAlmostEqual(row["area"]["a"], share, 12)
            self.assertEqual(row["hypothesis"]["as_expected"], None if share == 0.5 else share > 0.5)
            before = self.values("control", "first", column), self.values("trained", "first", column)
            if row["at_one_baseline"].get("p") is not None:
                difference, error, slope = at_one_baseline(x, y, *before)
                self.assertAlmostEqual(row["at_one_baseline"]["difference"], difference, 7)
                self.assertAlmostEqual(row["at_one_baseline"]["error"], error, 7)
                self.assertAlmostEqual(row["at_one_baseline"]["slope"], slope, 7)
                # 2.570581835636314: the quantile of Student's t at .975 with five degrees of freedom
                self.assertAlmostEqual(row["at_one_baseline"]["interval"]["upper"], difference + 2.570581835636314 * error, 6)
                adjusted.append((row["at_one_baseline"]["p"], row["at_one_baseline"]["p_holm"]))
        for family in (tests, adjusted):
            for got, want in zip([p for _, p in family], holm([p for p, _ in family])):
                self.assertAlmostEqual(got, want, 12)
        self.assertGreater(len(adjusted), 0)

    def test_rows_are_no_units(self):
        self.write()
        self.refused(3, *self.study(*OUTCOMES), names=(self.table, "line 3", '"P0" has 2 rows', "8 participants", "--attempt-rule"))
        said = json.loads(self.well(*self.study("--outcome", "seconds", "--attempt-rule", "mean", "--json")).out)
        both = [(a + b) / 2 for a, b in zip(self.values("control", "first", "seconds"), self.values("control", "last", "seconds"))]
        self.assertAlmostEqual(said["rows"][0]["groups"][0]["mean"], np.mean(both), 9)
        self.assertEqual(said["attempts_rule"], "the mean of a participant's rows")
        said = json.loads(self.well(*self.study("--outcome", "seconds", "--attempt-rule", "first", "--json")).out)
        self.assertAlmostEqual(said["rows"][0]["groups"][0]["mean"], np.mean(self.values("control", "first", "seconds")), 9)
        self.assertEqual(said["flow"]["excluded"], [{"reason": "later row of a participant (the first counts)", "attempts": 8, "participants": {}}])
        # The same person twice at the occasion itself.
        self.write([*self.rows, self.rows[1]])
        self.refused(3, *self.study(*AT_LAST, *OUTCOMES), names=("line 18", '"P0"', "2"))

    def test_absent_rows_are_named(self):
        self.write([r for r in self.rows if (r["id"], r["stage"]) not in (("P3", "first"), ("P4", "last"))])
        answer = self.well(*self.study("--occasion-column", "time,stage", "--occasion", "am/last", "--baseline-occasion", "am/first",
                                       "--outcome", "seconds"))
        text = " ".join(answer.out.split())
        self.assertIn("Absent rows: P3 (trained) at am/first; P4 (control) at am/last.", text)
        self.assertIn("seconds: 1 of 4 control without a value (no row at am/last)", text)
        self.assertIn("seconds: 1 of 4 trained have no baseline", text)
        said = json.loads(self.well(*self.study(*AT_LAST, "--outcome", "seconds", "--json")).out)
        self.assertEqual(said["absent"], [{"participant": "P3", "group": "trained", "occasion": "first"},
                                          {"participant": "P4", "group": "control", "occasion": "last"}])

    def test_empty_cells_are_missing_values(self):
        self.rows[1]["seconds"] = ""
        self.write()
        said = json.loads(self.well(*self.study(*AT_LAST, *OUTCOMES, "--json")).out)
        self.assertEqual([r["groups"][0]["n"] for r in said["rows"]], [4, 3])
        self.assertEqual(said["rows"][1]["groups"][0]["missing_reason"], "empty cell")

    def test_wrong_cells(self):
        for wrong, says in (("fast", "is not a number"), ("nan", "is not a finite number"), ("inf", "is not a finite number"),
                            ("1e999", "is not a number"), ("12,5", "is not a number"), ("0x10", "is not a number"), ("N/A", "leave the cell empty"),
                            ("-1e200", "is larger than")):
            with self.subTest(wrong):
                rows = [dict(r) for r in self.rows]
                rows[4]["seconds"] = wrong
                self.write(rows)
                self.refused(4, *self.study(*AT_LAST, *OUTCOMES), names=(self.table, "line 6", '"seconds"', says))
        for column in ("id", "stage"):
            with self.subTest(column):
                rows = [dict(r) for r in self.rows]
                rows[4][column] = ""
                self.write(rows)
                self.refused(4, *self.study(*AT_LAST, *OUTCOMES), names=("line 6", f'"{column}"'))
        for wrong in ("two\nlines", "\x1b[2J"):
            with self.subTest(wrong):
                rows = [dict(r) for r in self.rows]
                rows[4]["arm"] = wrong
                self.write(rows)
                self.refused(4, *self.study(*AT_LAST, *OUTCOMES), names=("line 6", '"arm"', "control character"))

    def test_semicolons_decimal_commas_and_na(self):
        self.rows[3]["seconds"] = ""
        self.write()
        want = json.loads(self.well(*self.study(*AT_LAST, *OUTCOMES, "--json")).out)
        lines = [line.replace(",", ";").replace(".", ",") for line in text_of([dict(r, seconds=r["seconds"] or "NA") for r in self.rows]).splitlines()]
        self.table.write_text("\n".join(lines) + "\n")
        self.assertIn("NA", self.table.read_text())
        said = json.loads(self.well(*self.study(*AT_LAST, *OUTCOMES, "--json")).out)
        self.assertEqual(said["rows"], want["rows"])
        self.assertEqual(sum(g["missing"] for g in said["rows"][1]["groups"]), 1)

    def test_wrong_files(self):
        draw = program.seeded("wrong tables")
        for name, content in {"empty": b"", "only a header": b"id,arm,score\n", "bars": b"id|arm|score\n1|a|2\n",
                              "uneven": b"id,arm,score\n1,a\n", "bytes": b"id,arm,score\n" + draw.randbytes(300) + b"\0",
                              "quote": b'id,arm,score\n"1,a,2\n'}.items():
            with self.subTest(name):
                self.table.write_bytes(content)
                self.refused(4, *self.study("--outcome", "score"), names=(self.table,))
        self.refused(4, "study", "--table", self.path("missing.csv"), *OPTIONS, "--outcome", "score", names=(self.path("missing.csv"),))
        self.refused(4, "study", "--table", self.folder, *OPTIONS, "--outcome", "score", names=(self.folder,))

    def test_groups(self):
        self.write([r for r in self.rows if r["arm"] == "trained"])
        self.refused(3, *self.study(*AT_LAST, *OUTCOMES), names=(self.table, "trained"))
        third = [dict(r, arm="other") if r["id"] in ("P0", "P1") else r for r in self.rows]
        self.write(third)
        self.refused(3, *self.study(*AT_LAST, *OUTCOMES), names=("3 groups", "--groups"))
        said = json.loads(self.well(*self.study(*AT_LAST, *OUTCOMES, "--groups", "trained,control", "--json")).out)
        self.assertEqual((said["groups"], said["participants"]), (["trained", "control"], [3, 3]))
        self.assertIn({"reason": "another group", "attempts": 4, "participants": {}}, said["flow"]["excluded"])
        moved = [dict(r, arm="trained") if (r["id"], r["stage"]) == ("P0", "last") else r for r in self.rows]
        self.write(moved)
        self.refused(3, *self.study(*AT_LAST, *OUTCOMES), names=("line 3", '"P0"'))

    def test_wrong_use(self):
        self.write()
        table = ("study", "--table", self.table)
        for arguments, names in (
                (self.study(*AT_LAST), ("--outcome",)),
                ((*table, "--group-column", "arm", *OUTCOMES), ("--participant-column",)),
                ((*table, "--participant-column", "id", *OUTCOMES), ("--group-column",)),
                (self.study(*AT_LAST, "--outcome", "speed"), (self.table, "line 1", '"speed"', "score, seconds")),
                (self.study(*AT_LAST, "--outcome", "score:more"), ("lower or higher",)),
                (self.study(*AT_LAST, "--outcome", "score", "--outcome", "score:lower"), ("twice",)),
                (self.study("--occasion-column", "when", "--occasion", "last", *OUTCOMES), ('"when"',)),
                (self.study("--occasion-column", "stage", "--occasion", "middle", *OUTCOMES), ('"middle"', "first, last")),
                (self.study("--occasion", "last", *OUTCOMES), ("--occasion-column",)),
                (self.study(*AT_LAST, "--baseline-occasion", "last", *OUTCOMES), ("baseline",)),
                (self.study(*AT_LAST, "--better", "nobody", *OUTCOMES), ("nobody",)),
                (self.study(*AT_LAST, "--family", "nothing", *OUTCOMES), ("nothing",)),
                (self.study(*AT_LAST, "--attempt-rule", "best", *OUTCOMES), ("--attempt-rule",)),
                (self.study(self.path("c.db"), *AT_LAST, *OUTCOMES), ()),
                (self.study("--include-practice", *AT_LAST, *OUTCOMES), ()),
                (("study",), ("--table",)), (("study", "c.db", "--group-column", "arm"), ("--table",))):
            with self.subTest(" ".join(map(str, arguments[1:]))):
                self.refused(2, *arguments, names=names)

    def test_options_take_no_more_than_theirs(self):
        self.write()
        said = json.loads(self.well("study", *OPTIONS, *OUTCOMES, *AT_LAST, "--groups", "control,trained", "--json", "--table", self.table).out)
        self.assertEqual(len(said["rows"]), 2)
        self.refused(4, "study", "--groups", "a,b", self.path("missing.db"), names=(self.path("missing.db"),))

    def test_page(self):
        for row in self.rows:
            row["arm"] = row["arm"].replace("trained", "<i>trained</i> & 'late'")
        self.write()
        page = self.path("p.html")
        command = self.study(*AT_LAST, *OUTCOMES, "--html", page, "--all")
        shown = self.well(*command).out
        first = self.well(*self.study(*AT_LAST, *OUTCOMES)).out.splitlines()
        self.assertLessEqual(len(first), 40, "one screen")
        self.assertLessEqual(max(map(len, first)), 120)
        said = json.loads(self.well(*command, "--force", "--json").out)
        self.refused(2, *command, names=(page, "--force"))
        self.well(*command, "--force")
        self.refused(2, *self.study(*AT_LAST, *OUTCOMES, "--html", self.path("no/where.html")), names=("where.html",))
        content = page.read_text(encoding="utf-8")
        figures = []
        words = []

        class Reader(html.parser.HTMLParser):
            open_tags = []

            def handle_starttag(self, tag, attributes):
                given = dict(attributes)
                case.assertNotIn(tag, ("script", "link", "iframe", "img", "object", "i"))
                case.assertFalse([a for a in given if a.startswith("on") or a in ("src", "href")], given)
                if tag == "svg":
                    figures.append([])
                if tag == "circle":
                    figures[-1].append(given)
                if tag not in ("meta",):
                    self.open_tags.append(tag)

            def handle_startendtag(self, tag, attributes):
                self.handle_starttag(tag, attributes)
                self.handle_endtag(tag)

            def handle_endtag(self, tag):
                case.assertEqual(self.open_tags.pop(), tag)

            def handle_data(self, data):
                words.append(data)

        case = self
        reader = Reader()
        reader.feed(content)
        self.assertEqual(reader.open_tags, [])
        # The forest plot, then box plots: every person is a point in each, and each outcome has one.
        self.assertEqual(len(figures[0]), len(said["rows"]))
        self.assertEqual({len(points) for points in figures[1:]}, {PEOPLE})
        self.assertGreaterEqual(len(figures[1:]), len(said["rows"]))
        self.assertNotIn("SYNTHETIC", content)
        self.assertIn("exploratory", content)
        # Whatever figure the terminal shows is on the page.
        on_page = " ".join(words).split()
        for line in shown.splitlines()[2:]:
            for word in line.split():
                if any(c.isdigit() for c in word):
                    self.assertIn(word, on_page)

    def test_width_and_csv(self):
        self.write()
        folder = self.path("out")
        shown = self.well(*self.study(*AT_LAST, "--baseline-occasion", "first", *OUTCOMES, "--csv", folder, "--all")).out
        self.assertLessEqual(max(map(len, shown.splitlines())), 120)
        with open(folder / "study.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        # The columns that there were first stand first, and in their order.
        self.assertEqual(list(rows[0])[:6] + list(rows[0])[33:37], ["checkpoint", "subject", "unit", "direction", "group_a", "n_a",
                                                                    "watermark", "hypothesis", "as_expected", "area"])
        said = json.loads(self.well(*self.study(*AT_LAST, "--baseline-occasion", "first", *OUTCOMES, "--json")).out)
        for row, want in zip(rows, said["rows"]):
            self.assertEqual(None in row or None in row.values(), False)
            self.assertEqual(float(row["area_lower"] or "nan"), want["area"]["interval"]["lower"])
            self.assertEqual(float(row["baseline_p"] or "nan"), want["at_one_baseline"]["p"])
            self.assertEqual(float(row["g_upper"] or "nan"), want["hedges"]["interval"]["upper"])

    def test_no_text_crashes_it(self):
        draw = program.seeded("tables of anything")
        for _ in range(40):
            text = list(text_of(self.rows))
            for _ in range(draw.randint(1, 6)):
                text[draw.randrange(len(text))] = draw.choice(['"', ",", "\n", "-", "e", "", "9", "\u00e9", "\r"])
            self.table.write_text("".join(text), encoding="utf-8")
            answer = calot(*self.study(*AT_LAST, *OUTCOMES, "--json"))
            self.assertIn(answer.code, (0, 2, 3, 4), answer)
            if answer.code:
                self.assertOneLine(answer)
            else:
                json.loads(answer.out)


class RealTable(program.ProgramTest):
    """A suturing study that others made: figures by R 4.2.2 (all assignments, lm with HC3 by hand, p.adjust)."""

    FILE = program.SHARED / "studies/bimanual-coordination.csv"
    OPTIONS = ("--participant-column", "participant_id", "--group-column", "group")
    LAST = ("--occasion-column", "stage,occasion", "--occasion", "transfer/delayed_day7", "--baseline-occasion", "transfer/baseline")
    EXPECTED = {  # p, Hodges-Lehmann, adjusted difference, its p
        "suture_completion_score": (0.09070186779, -1.5, -2.261958357, 0.1099119),
        "mean_active_suture_duration_s": (0.03997550437, 57.63115, 61.49934125, 0.07876864),
        "lt_rn_duration_s": (0.3316492589, -26.661, -14.57886394, 0.637578),
        "rt_ln_count": (0.4253762234, 1.0, 0.8709721651, 0.6967056),
    }

    def setUp(self):
        super().setUp()
        if not self.FILE.exists():
            self.skipTest(f"{self.FILE} is not here")

    def test_last_occasion_by_group(self):
        outcomes = [word for name in self.EXPECTED for word in ("--outcome", name)]
        said = json.loads(self.well("study", "--table", self.FILE, *self.OPTIONS, *self.LAST, *outcomes, "--json").out)
        self.assertEqual((said["groups"], said["participants"]), (["uniform", "workload_adapted"], [11, 11]))
        self.assertEqual(said["absent"], [{"participant": "S02", "group": "uniform", "occasion": "training/day1_session1"}])
        for row in said["rows"]:
            p, shift, difference, adjusted = self.EXPECTED[row["checkpoint"]]
            self.assertAlmostEqual(row["mann_whitney"]["p"], p, 9)
            self.assertAlmostEqual(row["shift"]["hodges_lehmann"], shift, 4)
            self.assertAlmostEqual(row["at_one_baseline"]["difference"], difference, 7)
            self.assertAlmostEqual(row["at_one_baseline"]["p"], adjusted, 6)
        self.assertEqual([round(r["mann_whitney"]["p_holm"], 6) for r in said["rows"]], [0.272106, 0.159902, 0.663299, 0.663299])
        self.assertEqual([round(r["at_one_baseline"]["p_holm"], 6) for r in said["rows"]], [0.329736, 0.315075, 1.0, 1.0])

    def test_rows_are_no_units(self):
        self.refused(3, "study", "--table", self.FILE, *self.OPTIONS, "--outcome", "lt_rn_count", names=("S01", "9 rows", "22 participants"))


if __name__ == "__main__":
    program.main()
