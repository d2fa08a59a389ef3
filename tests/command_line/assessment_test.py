# SPDX-License-Identifier: GPL-3.0-or-later
"""calot protocol, power, rate, norm and grade: from recordings to a sheet, and what is refused."""

import base64
import json
import pathlib
import re
import shutil
import tempfile

import program
from program import calot, recording

PROTOCOL = {
    "format": "calot-protocol", "formatVersion": 1, "name": "pipeline", "version": 1, "title": "Skilled performers move less",
    "operators": "performers",
    "populations": [{"group": "skilled", "definition": "the skilled profile"}, {"group": "unskilled", "definition": "the unskilled profile"}],
    "better": "skilled", "unit": "participant", "attemptRule": "single", "exclusions": {"outcomes": [], "reasons": []},
    "missing": "complete-cases", "level": 0.05,
    "hypotheses": [{"checkpoint": "path-length", "subject": "left", "larger": "unskilled", "primary": True},
                   {"checkpoint": "path-length", "subject": "right", "larger": "unskilled", "primary": True}],
}
GOALS = ("depth-perception", "bimanual-dexterity", "efficiency", "tissue-handling", "autonomy")
_cohort = []


def cohort():
    """Four skilled and four unskilled performers' attempts in assessment mode, and the recordings beside the database."""
    if not _cohort:
        folder = pathlib.Path(tempfile.mkdtemp(prefix="calot-cli-"))
        program.atexit.register(shutil.rmtree, folder, ignore_errors=True)
        for profile in ("skilled", "unskilled"):
            for seed in range(4):
                made = recording(f"{profile}{seed}", "--performer", profile, "--seed", seed + 1, "--seconds", 5, "--mode", "assessment")
                shutil.copyfile(made, folder / made.name)
        answer = calot("assess", *sorted(folder.glob("*.h5")), "--cohort", folder / "c.db")
        if answer.code != 0:
            raise AssertionError(answer)
        _cohort.append(folder)
    return _cohort[0]


class Assessment(program.ProgramTest):
    def setUp(self):
        super().setUp()
        for file in cohort().iterdir():
            if file.suffix in (".h5", ".db"):
                shutil.copyfile(file, self.folder / file.name)
        self.database = self.path("c.db")

    def attempts(self, profile="unskilled"):
        """Uuids by name of the recording."""
        return [json.loads(self.well("inspect", f, "--json").out)["attempt"]["attempt_uuid"] for f in sorted(self.folder.glob(f"{profile}?.h5"))]

    def write(self, name, content):
        self.path(name).write_text(json.dumps(content))
        return self.path(name)


class Protocols(Assessment):
    def test_a_protocol_after_the_data_leaves_the_study_exploratory(self):
        protocol = self.write("p.json", PROTOCOL)
        said = json.loads(self.well("study", self.database, "--protocol", protocol, "--json").out)
        self.assertEqual((said["heading"], said["watermark"]), ("exploratory", "SYNTHETIC"))
        self.assertIn("not registered", said["protocol"]["why_exploratory"])
        self.well("protocol", "register", protocol, self.database, "--by", "test")
        said = json.loads(self.well("study", self.database, "--protocol", protocol, "--json").out)
        self.assertEqual(said["heading"], "exploratory")
        self.assertIn("the first attempt is of", said["protocol"]["why_exploratory"])
        roles = {(r["checkpoint"], r["subject"]): r["role"] for r in said["rows"]}
        self.assertEqual(roles[("path-length", "left")], "primary")
        self.assertEqual(set(roles.values()), {"primary", "exploratory"})
        for row in said["rows"]:
            if row["role"] != "primary":
                self.assertIsNone(row["mann_whitney"].get("p_holm"))
        self.well("study", self.database, "--protocol", protocol, "--html", self.path("s.html"), "--csv", self.path("csv"))
        self.assertIn("Methods. ", self.path("s.html").read_text())

    def test_what_is_refused(self):
        protocol = self.write("p.json", PROTOCOL)
        self.refused(2, "study", self.database, "--protocol", protocol, "--better", "skilled", names=("--protocol", "--better"))
        bad = json.loads(json.dumps(PROTOCOL))
        bad["hypotheses"][1]["larger"] = "experts"
        self.refused(4, "protocol", "check", self.write("bad.json", bad), names=("bad.json: /hypotheses/1/larger",))
        self.path("cut.json").write_text(json.dumps(PROTOCOL)[:100])
        self.refused(4, "protocol", "check", self.path("cut.json"), names=("cut.json: ", "line 1",))
        self.refused(4, "protocol", "check", self.path("none.json"), names=("none.json",))
        self.refused(2, "protocol", "check", "none", names=("cholecystectomy-2014-table2",))
        self.well("protocol", "register", protocol, self.database, "--by", "test")
        self.refused(3, "protocol", "register", self.write("p2.json", {**PROTOCOL, "level": 0.01}), self.database, "--by", "test",
                     names=(PROTOCOL["name"], f"version {PROTOCOL['version']}"))
        self.assertEqual(len(json.loads(self.well("protocol", "list", self.database, "--json").out)["protocols"]), 1)
        said = " ".join(self.well("protocol", "check", "cholecystectomy-2014-table2").out.split())
        # .05 over eight; 2 / C(10, 5) is .0079, 2 / C(12, 6) is .0022.
        self.assertIn("needs p <= 0.00625 (0.05, Holm over 8). Groups of 6 and 6 are the smallest", said)


class Power(Assessment):
    def test_power_grows_with_n_and_repeats_with_its_seed(self):
        ask = ("power", "--effect", "1.5", "--n", "5,10,20", "--simulations", 2000, "--json")
        said = json.loads(self.well(*ask).out)
        powers = [s["checkpoints"][0]["power"] for s in said["sizes"]]
        self.assertEqual(powers, sorted(powers))
        self.assertAlmostEqual(powers[1], 0.85184, delta=0.03)  # R 4.2.2, tests/analytics/statistics/power_test.cpp
        self.assertEqual(said["enough"], 10)
        self.assertEqual(said, json.loads(self.well(*ask).out))
        self.assertAlmostEqual(said["sizes"][0]["smallest_p"], 2 / 252, 12)
        three = self.well("power", "--effect", "9,9", "--n", "3,5", "--simulations", 100).out
        self.assertIn("n = 3 + 3: nothing can be rejected, the smallest p of a rank test is 0.1 and 0.025 is needed.", " ".join(three.split()))
        self.assertNotIn("n = 5 + 5", three)
        self.assertNotEqual(said["sizes"], json.loads(self.well(*ask, "--seed", 2).out)["sizes"])

    def test_from_people_at_hand(self):
        said = json.loads(self.well("power", self.database, "--protocol", self.write("p.json", PROTOCOL), "--n", 4, "--simulations", 200,
                                    "--json").out)
        self.assertTrue(said["synthetic"])
        self.assertEqual([c["checkpoint"] for c in said["sizes"][0]["checkpoints"]], ["path-length left", "path-length right"])

    def test_what_is_refused(self):
        self.refused(2, "power", names=("--effect",))
        self.refused(2, "power", "--effect", "1", "--checkpoint", "a:1,1,2,1", names=("--effect", "--checkpoint"))
        self.refused(2, "power", "--checkpoint", "a:1,0,2,1", names=("a:1,0,2,1",))
        self.refused(2, "power", "--checkpoint", "a:1,2", names=("NAME:MEAN,SD,MEAN,SD",))
        self.refused(2, "power", "--checkpoint", "a:-1,1,2,1", "--shape", "lognormal", names=("positive",))
        for sizes in ("0", "5:3", "5:900", "x", "5:10:0", "1:2:3:4"):
            self.refused(2, "power", "--effect", "1", "--n", sizes, names=("--n",))


class Ratings(Assessment):
    def rate(self, attempt, rater, scores, *more):
        return ("rate", self.database, "--form", "goals", "--attempt", attempt, "--rater", rater,
                *[a for item, score in zip(GOALS, scores) for a in ("--answer", f"{item}={score}")], *more)

    def test_ratings_come_back_with_agreement(self):
        for i, attempt in enumerate(self.attempts()):
            for r, rater in enumerate(("R1", "R2")):
                self.well(*self.rate(attempt, rater, [1 + (i + r) % 5] * 5))
        said = json.loads(self.well("rate", self.database, "--json").out)["forms"]
        self.assertEqual((said[0]["form"], said[0]["filled"]), ("goals", 8))
        # Subjects 1 to 4 and 2 to 5: the raters differ by one throughout. S = 10/3, R = 2, E = 0:
        # ICC(2,1) = S / (S + 2 R / 4) = 10/13, of which the residual's rounding leaves nothing.
        self.assertAlmostEqual(said[0]["agreement"][0]["icc_2_1"]["value"], 10 / 13, 9)
        self.refused(3, *self.rate(self.attempts()[0], "R1", [3] * 5), names=("--force replaces",))
        self.well(*self.rate(self.attempts()[0], "R1", ["-", 3, 3, 3, 3], "--force"))
        said = json.loads(self.well("rate", self.database, "--json").out)["forms"]
        self.assertEqual(said[0]["incomplete"], 1)
        shown = self.well("rate", self.database).out
        self.assertIn("Agreement between raters on goals", shown)
        self.assertIn("agreement over the first attempt of each that every rater rated (1 were not, 0 are later ones)", " ".join(shown.split()))

    def test_answers_in_one_option(self):
        attempt = self.attempts()[0]
        answers = ",".join(f"{item}={score}" for item, score in zip(GOALS, (1, 2, 3, 4, "-")))
        self.well("rate", self.database, "--form", "goals", "--attempt", attempt, "--rater", "R1", "--answer", answers)
        items = json.loads(self.well("rate", self.database, "--json").out)["forms"][0]["items"]
        given = [(sum(g["n"] for g in i["groups"]), sum(g["blank"] for g in i["groups"])) for i in items]
        self.assertEqual(given, [(1, 0)] * 4 + [(0, 1)])

    def test_what_is_refused(self):
        attempt = self.attempts()[0]
        self.refused(2, *self.rate(attempt, "R1", [3] * 4), names=("autonomy",))
        self.refused(2, *self.rate(attempt, "R1", [9] * 5), names=("from 1 to 5",))
        self.refused(3, *self.rate(attempt[:-4] + "0000", "R1", [3] * 5), names=(attempt[:-4] + "0000",))
        self.refused(2, "rate", self.database, "--form", "goals", "--participant", "P1", "--answer", "efficiency=1", names=("--rater",))
        self.refused(4, "rate", self.database, "--form", "goals", "--attempt", attempt, "--rater", "R1", "--answers",
                     self.write("a.json", [1, 2]), names=("a.json",))
        self.refused(2, "rate", self.database, "--rater", "R1", names=("--form",))
        self.refused(4, "rate", self.path("none.db"), names=("none.db",))
        self.assertEqual(len(json.loads(self.well("rate", "--forms", "--json").out)["forms"]), 5)


class Angoff(program.ProgramTest):
    def test_the_mark_of_two_judges(self):
        table = self.path("judges.csv")
        table.write_text("judge,a,b,c\nx,.5,.6,.7\ny,.4,.8,.9\n")
        answer = json.loads(self.well("norm", "angoff", table, "--json").out)
        self.assertEqual([round(item["mean"], 12) for item in answer["items"]], [0.45, 0.7, 0.8])
        self.assertAlmostEqual(answer["cut"], 1.95)
        rows = [line.split() for line in self.well("norm", "angoff", table).out.splitlines()]
        self.assertIn(["b", "0.70", "0.60", "0.80"], rows)
        self.assertIn("at-least:2.", rows[-1])
        table.write_text("judge,a\nx,1.5\n")
        self.refused(4, "norm", "angoff", table, names=(table, "1.5"))


class Grades(Assessment):
    def make(self, *more):
        return ("norm", "create", self.database, "pipeline", "--by", "test", "--group-by", "performer", "--include-synthetic", "--rule",
                "at-least:1", *(() if "--checkpoints" in more else ("--checkpoints", "all")), *more)

    def test_a_sheet_from_recordings(self):
        self.well(*self.make())
        norm = json.loads(self.well("norm", "show", self.database, "pipeline", "--json").out)
        self.assertEqual((norm["members"], norm["synthetic"], norm["version"]), (8, True, 1))
        weak = 0
        for attempt in self.attempts():
            said = json.loads(self.well("grade", self.database, "--attempt", attempt[:18], "--json").out)
            self.assertEqual((said["use"], said["synthetic"]), ("formative", True))
            self.assertEqual(said["moments_missing"], "")
            for figure in said["figures"]:
                if figure["passed"] is False:
                    weak += 1
                    self.assertTrue(figure["moments"] or figure["no_moments"], figure)
                for moment in figure["moments"]:
                    self.assertTrue(0 <= moment["begin"] < moment["end"] <= 5.0 and 0 < moment["share"] <= 1.0, moment)
                if figure["cut"] is not None and figure["value"] is not None:
                    better = figure["value"] <= figure["cut"] if figure["direction"] == "lower" else figure["value"] >= figure["cut"]
                    self.assertEqual(figure["passed"], better)
        self.assertGreater(weak, 0)
        sheet = self.path("sheet.html")
        text = self.well("grade", self.database, "--attempt", attempt, "--html", sheet).out
        self.assertIn("FORMATIVE", text)
        page = sheet.read_text()
        self.assertIn("SYNTHETIC", page)
        self.assertNotIn("http", page.replace("http-equiv", ""))
        self.refused(2, "grade", self.database, "--attempt", attempt, "--html", sheet, names=("sheet.html",))
        self.refused(2, "grade", self.database, "--attempt", attempt, "--with-replay", names=("--html",))
        # The page carries the recording, byte for byte, as data that no browser runs.
        self.well("grade", self.database, "--attempt", attempt, "--html", sheet, "--with-replay", "--force")
        carried = re.search(r'<script type="application/x-calot-recording" id="recording" data-name="([^"]+)">\n(\S+)\n</script>', sheet.read_text())
        self.assertEqual(base64.b64decode(carried[2]), (self.folder / carried[1]).read_bytes())

    def test_without_its_recording_a_sheet_says_so(self):
        self.well(*self.make())
        attempt = self.attempts()[0]
        other = sorted(self.folder.glob("skilled?.h5"))[0]
        answers = json.loads(self.well("grade", self.database, "--attempt", attempt, "--json").out)
        if any(f["passed"] is False for f in answers["figures"]):
            self.refused(3, "grade", self.database, "--attempt", attempt, "--recording", other, names=(other, attempt))
            own = sorted(self.folder.glob("unskilled?.h5"))[0]
            own.write_bytes(own.read_bytes()[:5000])
            self.refused(4, "grade", self.database, "--attempt", attempt, names=(own.name,))
            own.unlink()
            said = json.loads(self.well("grade", self.database, "--attempt", attempt, "--json").out)
            self.assertIn("is not beside the database", said["moments_missing"])

    def test_evidence_and_versions(self):
        self.well(*self.make())
        self.well(*self.make("--seed", 2))
        self.assertEqual(len(json.loads(self.well("norm", "list", self.database, "--json").out)["norms"]), 2)
        document = self.path("v.txt")
        document.write_text("shown")
        self.well("norm", "evidence", self.database, "pipeline", "--file", document, "--statement", "Agrees with raters", "--by", "test")
        said = self.well("grade", self.database, "--attempt", self.attempts()[0]).out
        self.assertNotIn("FORMATIVE", said)
        self.assertIn("Agrees with raters", said)
        said = self.well("grade", self.database, "--attempt", self.attempts()[0], "--norm", "pipeline", "--norm-version", 1).out
        self.assertIn("FORMATIVE", said)

    def test_what_is_refused(self):
        attempt = self.attempts()[0]
        self.refused(3, "grade", self.database, "--attempt", attempt, names=(self.database,))
        self.refused(3, "norm", "create", self.database, "n", "--by", "t", "--rule", "all", names=("group",))
        self.refused(2, "norm", "create", self.database, "n", "--by", "t", "--rule", "some", names=("at-least:K",))
        judged = ("norm", "create", self.database, "n", "--by", "t", "--rule", "all", "--judged-by", "competence")
        self.refused(3, *judged, names=("competence",))
        # Raters make the groups: what else would make them is refused, as is what a protocol chooses.
        self.refused(2, *judged, "--group-by", "performer", names=("--judged-by excludes --group-by",))
        self.refused(2, *self.make("--protocol", "cholecystectomy-2014-table2"), names=("--protocol",))
        self.refused(2, "norm", "create", self.database, "n", "--by", "t", "--rule", "all", "--protocol", "none", names=("cholecystectomy-2014-table2",))
        self.refused(3, "norm", "create", self.database, "n", "--by", "t", "--group-by", "performer", "--include-synthetic", "--rule", "at-least:900",
                     names=("900",))
        self.refused(2, *self.make("--checkpoints", "nothing"), names=("nothing",))
        self.well(*self.make())
        self.refused(3, "grade", self.database, "--attempt", attempt, "--norm", "other", names=("pipeline 1",))
        self.refused(3, "grade", self.database, "--attempt", "z\nz", names=(self.database, "z?z"))
        self.refused(4, "norm", "evidence", self.database, "pipeline", "--file", self.path("none"), "--statement", "x", "--by", "t",
                     names=("none",))
        self.assertEqual(len(json.loads(self.well("norm", "list", self.database, "--json").out)["norms"]), 1)


if __name__ == "__main__":
    program.main()
