# SPDX-License-Identifier: GPL-3.0-or-later
"""calot protocol: what ships fits the present program, what names nothing is refused, what was registered can be withdrawn without data,
and "confirmatory" rests on evidence in the cohort."""

import json
import re
import shutil
import sqlite3
import time
from contextlib import closing

import program
from assessment_test import PROTOCOL
from cohort_content import query
from devices_test import whole_stream
from import_test import synthetic, text_of

ASSETS = program.SOURCE / "assets"
MAP = re.compile(r"```json\n(\{\s*\"format\": \"calot-columns\".*?)```", re.S)


def changed(**values):
    return {**json.loads(json.dumps(PROTOCOL)), **values}


class Protocol(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort = self.path("c.db")

    def write(self, name, content):
        self.path(name).write_text(json.dumps(content))
        return self.path(name)

    def attempt(self, who, group, scene="touch-liver", **experience):
        """A person's assessment, from motion: a calibrated device that plays the hands of a file."""
        motion, recording, calibration = self.path(f"{who}.txt"), self.path(f"{who}.h5"), self.path("calibration.json")
        motion.write_text(text_of(synthetic(2.0, program.seeded(who))))
        if not calibration.exists():
            self.path("stream.json").write_text(whole_stream())
            self.well("devices", "calibrate", f"scripted:{motion}", "--from", self.path("stream.json"), "-o", calibration)
        self.well("record", "--scene", scene, "--device", f"scripted:{motion}", "--calibration", calibration, "--participant", who, "--mode", "assessment", "--seconds", 0.3, "-o", recording)
        self.well("participant", "add", who, "--group", group, "--cohort", self.cohort,
                  *[a for name, value in experience.items() for a in ("--experience", f"{name.replace('_', '-')}={value}")])
        self.well("assess", recording, "--cohort", self.cohort)

    def performers(self):
        for profile in ("skilled", "unskilled"):
            made = self.path(f"{profile}.h5")
            self.well("record", "--scene", "touch-liver", "--performer", profile, "--seconds", 0.3, "--mode", "assessment", "-o", made)
            self.well("assess", made, "--cohort", self.cohort)

    def study(self, protocol):
        return json.loads(self.well("study", self.cohort, "--protocol", protocol, "--json").out)


class Shipped(Protocol):
    def test_protocols(self):
        files = sorted((ASSETS / "protocols").glob("*.json"))
        self.assertTrue(files)
        for file in files:
            with self.subTest(file.stem):
                protocol = json.loads(file.read_text())
                self.cohort = self.path(f"{file.stem}.db")
                self.well("protocol", "check", file.stem)
                self.well("protocol", "register", file.stem, self.cohort, "--by", "test")
                scene = protocol["scene"].split("/")[0]
                for number, population in enumerate(protocol["populations"]):
                    self.attempt(f"{'EN'[number]}{number}", population["group"], scene,
                                 **{c["criterion"].replace("-", "_"): c.get("atLeast", c.get("atMost")) for c in population["criteria"]})
                said = self.study(file.stem)
                self.assertEqual(said["participants"], [1, 1])
                named = {(h["checkpoint"], h.get("subject", "")) for h in protocol["hypotheses"]}
                self.assertEqual({(r["checkpoint"], r["subject"]) for r in said["rows"] if r["role"] == "primary"}, named)

    def test_forms(self):
        self.performers()
        attempt = query(self.cohort, "SELECT uuid FROM attempt")[0][0]
        self.well("participant", "add", "P1", "--cohort", self.cohort)
        for file in sorted((ASSETS / "forms").glob("*.json")):
            with self.subTest(file.stem):
                form = json.loads(file.read_text())
                about = ("--attempt", attempt, "--rater", "R1") if form["about"] == "attempt" else ("--participant", "P1")
                answers = ",".join(f"{item['key']}={form['scale']['least']}" for section in form["sections"] for item in section["items"])
                self.well("rate", self.cohort, "--form", file.stem, *about, "--answer", answers)

    def test_courses_and_scenes(self):
        scenes = {file.stem for file in (ASSETS / "scenes").glob("*.json")}
        for file in sorted((ASSETS / "curricula").glob("*.json")):
            for task in json.loads(file.read_text())["tasks"]:
                self.assertIn(task["scene"], scenes)
                self.well("record", "--scene", task["scene"], "--performer", "skilled", "--seconds", 0.02, "-o", self.path(task["scene"] + ".h5"))

    def test_maps_of_the_documentation(self):
        found = 0
        for page in sorted((program.SOURCE / "docs").rglob("*.md")):
            for text in MAP.findall(page.read_text()):
                columns = json.loads(text)
                names = [columns["time"]["column"]] if "time" in columns else []
                cells = ["{t}"] if names else []
                for hand in ("left", "right"):
                    for kind, values in (("position", "{t} 1 2"), ("quaternion", "1 0 0 0"), ("matrix", "1 0 0 0 1 0 0 0 1")):
                        if kind in columns.get(hand, {}):
                            names += columns[hand][kind]
                            cells += values.split()
                data = self.path(f"{found}.csv")
                separator = {"tab": "\t"}.get(columns.get("delimiter"), columns.get("delimiter", ","))
                data.write_text("\n".join([separator.join(names), *(separator.join(cells).format(t=t) for t in range(1, 90))]) + "\n")
                self.well("import", data, "--columns", self.write(f"{found}.json", columns), "--cohort", self.cohort)
                found += 1
        self.assertGreater(found, 0)


class Checked(Protocol):
    def test_scenes_subjects_and_groups(self):
        organ = {"checkpoint": "organ-burned", "subject": "spleen", "larger": "unskilled", "primary": True}
        hand = {"checkpoint": "path-length", "subject": "lfet", "larger": "unskilled", "primary": True}
        for name, wrong, place in (("nosuch/7", {"scene": "nosuch/7"}, "/scene"), ("touch-liver/99", {"scene": "touch-liver/99"}, "/scene"),
                                   ("gallbladder", {"scene": "touch-liver/2", "hypotheses": [organ]}, "/hypotheses/0/subject"),
                                   ("left, right", {"hypotheses": [hand]}, "/hypotheses/0")):
            file = self.write("p.json", changed(**wrong))
            for command in (("check", file), ("register", file, self.cohort, "--by", "me")):
                self.refused(4, "protocol", *command, names=(f"p.json: {place}", name))
        self.assertFalse(self.cohort.exists())
        self.well("protocol", "check", self.write("p.json", changed(scene="knot-tying/0")))
        own = json.loads((ASSETS / "scenes/touch-liver.json").read_text())
        own["name"] = "own"
        (self.path("scenes")).mkdir()
        shutil.copytree(ASSETS / "organs", self.path("organs"))
        scene = self.write("scenes/own.json", own)
        file = self.write("p.json", changed(scene=f"own/{own['version']['major']}"))
        self.refused(4, "protocol", "check", file, names=("own/",))
        self.well("protocol", "check", file, "--scene", scene)
        self.performers()
        groups = changed()
        groups["populations"][0]["group"] = groups["better"] = "expert"
        answer = program.calot("protocol", "register", self.write("p.json", groups), self.cohort, "--by", "me")
        self.assertEqual(answer.code, 0)
        self.assertIn("warning", answer.err)
        self.assertIn('"expert"', answer.err)

    def test_a_study_names_the_scene_wanted_and_found(self):
        self.performers()
        protocol = self.write("p.json", changed(scene="knot-tying/0"))
        self.refused(3, "study", self.cohort, "--protocol", protocol, names=("knot-tying/0", "touch-liver/"))

    def test_withdrawn_without_data(self):
        first = self.write("p.json", changed(scene="knot-tying/0", version=7))
        self.well("protocol", "register", first, self.cohort, "--by", "me")
        base = ("--by", "me", "--reason", "no such task")
        self.refused(3, "protocol", "withdraw", "pipeline/1", self.cohort, *base, names=("pipeline/1",))
        self.performers()
        self.well("protocol", "withdraw", "pipeline/7", self.cohort, *base)
        self.refused(3, "protocol", "withdraw", "pipeline/7", self.cohort, *base, names=("pipeline/7",))
        self.assertEqual(query(self.cohort, "SELECT detail FROM audit WHERE action = 'protocol-withdraw'"), [("no such task (by me)",)])
        listed = json.loads(self.well("protocol", "list", self.cohort, "--json").out)["protocols"]
        self.assertNotEqual(listed[0]["withdrawn_utc"], "")
        self.refused(3, "protocol", "register", first, self.cohort, "--by", "me", names=("pipeline version 7",))
        self.well("protocol", "register", self.write("p2.json", changed()), self.cohort, "--by", "me")  # a lower version
        self.refused(3, "protocol", "withdraw", "pipeline/1", self.cohort, *base, names=("2 attempts",))
        with closing(sqlite3.connect(self.cohort)) as database:
            for change in ("registered_utc = '2000-01-01T00:00:00Z'", "withdrawn_utc = ''"):
                with self.assertRaises(sqlite3.IntegrityError):
                    database.execute(f"UPDATE protocol SET {change} WHERE version = 7")


class Evidence(Protocol):
    def test_recorded_after_registration_is_confirmatory(self):
        protocol = self.write("p.json", changed())
        self.well("protocol", "register", protocol, self.cohort, "--by", "me")
        time.sleep(1.1)  # both times have whole seconds
        self.performers()
        said = self.study(protocol)
        self.assertEqual((said["heading"], said["protocol"]["why_exploratory"], said["protocol"]["starts"]), ("confirmatory", "", {"recorded": 2}))
        # Another cohort has the recordings before the protocol: what was there cannot be predicted.
        self.cohort = self.path("late.db")
        self.well("assess", self.path("skilled.h5"), self.path("unskilled.h5"), "--cohort", self.cohort)
        self.well("protocol", "register", protocol, self.cohort, "--by", "me")
        self.assertEqual(self.study(protocol)["heading"], "exploratory")

    def test_a_stated_start_is_no_evidence(self):
        people = changed(operators="people", better="expert", scene="knots/0")
        for population, hypothesis, group in zip(people["populations"], people["hypotheses"], ("expert", "novice")):
            population["group"], hypothesis["larger"] = group, "novice"
        protocol = self.write("p.json", people)
        self.well("protocol", "register", protocol, self.cohort, "--by", "me")
        time.sleep(2.1)
        now = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(time.time() - 1))
        for number, group in enumerate(("expert", "novice", "expert", "novice")):
            motion = self.path(f"m{number}.txt")
            motion.write_text(text_of(synthetic(3.0 + number, program.seeded(f"stated{number}"))))
            self.well("participant", "add", f"P{number}", "--group", group, "--cohort", self.cohort)
            base = ("import", motion, "--task", "knots", "--participant", f"P{number}", "--mode", "assessment", "--cohort", self.cohort)
            self.refused(2, *base, "--start", "2999-01-21T00:00:00Z", names=("--start",))
            self.well(*base, "--start", now)
        said = self.study(protocol)
        self.assertEqual((said["heading"], said["protocol"]["starts"]), ("exploratory", {"stated": 4}))
        self.assertIn("stated", said["protocol"]["why_exploratory"])
        listed = json.loads(self.well("attempt", "list", "--cohort", self.cohort, "--json").out)["attempts"]
        self.assertEqual({a["start_evidence"] for a in listed}, {"stated"})


class Content(Protocol):
    def test_claims_with_a_margin_and_what_reviewers_ask_for(self):
        claims = [{"checkpoint": "attempt-duration", "larger": "novice", "primary": True, "claim": "equivalence", "margin": margin}
                  for margin in (2.0,)] + [{"checkpoint": "path-length", "subject": "left", "larger": "novice", "primary": True,
                                            "claim": "non-inferiority", "margin": 1e-6}]
        people = changed(operators="people", better="expert", hypotheses=claims, ethics="Board 12/3", registry="NCT0", covariates=["age"],
                         sampleSizeReason="power .8", stoppingRule="twelve people")
        for population, group in zip(people["populations"], ("expert", "novice")):
            population.update(group=group, planned=7)
        protocol = self.write("p.json", people)
        generator = program.seeded("margins")
        for number in range(12):
            motion = self.path(f"m{number}.txt")
            motion.write_text(text_of(synthetic(4.0 + 0.1 * number, generator)))
            self.well("participant", "add", f"P{number:02}", "--group", ("expert", "novice")[number % 2], "--cohort", self.cohort)
            self.well("import", motion, "--participant", f"P{number:02}", "--mode", "assessment", "--cohort", self.cohort)
        said = self.study(protocol)
        rows = {r["checkpoint"]: r for r in said["rows"] if r["role"] == "primary"}
        # Twelve durations within 1.2 s: shifted by 2 s, all of one group lie beyond the other: 1 / C(12, 6), of two hypotheses.
        duration, path = rows["attempt-duration"], rows["path-length"]
        self.assertAlmostEqual(duration["margin_p"], 1 / 924, delta=1e-12)
        self.assertAlmostEqual(duration["mann_whitney"]["p_holm"], 2 / 924, delta=1e-12)
        self.assertEqual((duration["claim"], duration["supported"]), ("equivalence", True))
        self.assertEqual((path["claim"], path["supported"]), ("non-inferiority", path["margin_p"] <= 0.05))
        declared = said["protocol"]
        self.assertEqual((declared["ethics"], declared["registry"], declared["planned"], declared["covariates"]), ("Board 12/3", "NCT0", [7, 7], ["age"]))
        self.assertEqual(len(declared["deviations"]), 3)  # six and six, and no adjustment for age
        text = " ".join(self.well("study", self.cohort, "--protocol", protocol).out.split())
        for words in ("Board 12/3", "NCT0", "power .8", "twelve people", "equivalence within 2 s is shown"):
            self.assertIn(words, text)
        for wrong in ({"claim": "equivalence", "margin": None}, {"claim": "difference", "margin": 2.0}):
            bad = [{**claims[0], **wrong}]
            if wrong["margin"] is None:
                del bad[0]["margin"]
            self.refused(4, "protocol", "check", self.write("bad.json", changed(better="skilled", hypotheses=[{**bad[0], "larger": "skilled"}])),
                         names=("/hypotheses/0", "margin"))
        # Runs with named groups before the lock are counted.
        self.well("protocol", "register", protocol, self.cohort, "--by", "me")
        self.well("protocol", "lock", protocol, self.cohort, "--by", "me")
        self.assertEqual(query(self.cohort, "SELECT count(*) FROM audit WHERE action = 'study-run'"), [(2,)])
        self.assertEqual(self.study(protocol)["protocol"]["runs_before_lock"], 2)
        self.assertEqual(self.study(protocol)["protocol"]["runs_before_lock"], 2)


if __name__ == "__main__":
    program.main()
