# SPDX-License-Identifier: GPL-3.0-or-later
"""Goldens: made only on purpose, small, repeated bit for bit, their checkpoints compared."""

import json
import os
import shutil
import subprocess

import h5py
import program
import schema_names
from program import SCENE

ENTRY = {"file": "touch.h5", "scene": SCENE, "performer": "skilled", "seed": 7, "seconds": 4}
LONG = {**ENTRY, "file": "long.json", "seconds": 2}


class Golden(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.tree = self.folder / "tree"
        self.golden = self.tree / "golden"
        self.golden.mkdir(parents=True)
        self.write([ENTRY])
        (self.tree / "source.txt").write_text("as it is\n")
        self.git("init", "--quiet")
        self.commit()

    def git(self, *words):
        subprocess.run(["git", "-C", self.tree, "-c", "user.name=n", "-c", "user.email=n@example.org", *words], check=True,
                       capture_output=True)

    def commit(self):
        self.git("add", "-A")
        self.git("commit", "--quiet", "-m", "all")

    def write(self, recordings, version=1):
        text = json.dumps({"simulation_version": version, "reason": "first", "recordings": recordings})
        (self.golden / "golden.json").write_text(text)

    def list_values(self, values):
        listed = self.listed()
        listed["recordings"][0]["checkpoints"] = values
        (self.golden / "golden.json").write_text(json.dumps(listed))

    def listed(self):
        return json.loads((self.golden / "golden.json").read_text())

    def update(self, reason="contact is solved in another way"):
        return program.calot("golden", "update", "--folder", self.golden, "--reason", reason)

    def test_made_checked_and_refused(self):
        made = self.update()
        self.assertEqual((made.code, made.err), (0, ""), made)
        self.assertRegex(made.out, r"^touch\.h5: \d+ checkpoints, \d+ changed\n")
        self.assertRegex(made.out, r"path-length left: none -> [\d.]+ mm")
        listed = self.listed()
        self.assertEqual(listed["reason"], "contact is solved in another way")
        self.assertEqual(sorted(p.name for p in self.golden.iterdir()), ["golden.json", "touch.h5"])

        with h5py.File(self.golden / "touch.h5", "r") as file:
            self.assertNotIn("/observables", file)
            self.assertNotIn("/keyframes", file)
            self.assertNotIn("/ticks/left/force", file)
            self.assertEqual(file["/steps/force_digest"].shape, (400,))
            rows = schema_names.names_of(str(program.SOURCE / "schemas"))
            checker = schema_names.Checker(file, rows)
            checker.check()
            self.assertEqual(checker.faults + schema_names.chain_faults(file, rows), [])

        checked = self.well("golden", "check", "--folder", self.golden)
        self.assertRegex(checked.out, r"touch\.h5: bit-exact, 4\.00 s \(400 steps\)")
        self.well("replay", self.golden / "touch.h5")

        # Of this version already: nothing to update, and the recording stays.
        before = (self.golden / "touch.h5").read_bytes()
        self.refused(2, "golden", "update", "--folder", self.golden, "--reason", "again", names=["raises simulationVersion"])
        self.assertEqual((self.golden / "touch.h5").read_bytes(), before)

        # A value that is not in the list, and one that the list alone has.
        values = listed["recordings"][0]["checkpoints"]
        for kept in ([v for v in values if v["name"] != "sparc"], [*values, {"name": "path-length", "subject": "third", "version": 1, "value": 1.0}]):
            self.assertNotEqual(len(kept), len(values))
            self.list_values(kept)
            answer = program.calot("golden", "check", "--folder", self.golden)
            self.assertEqual(answer.code, 3, answer)
            self.assertIn("none", answer.out)

        # A checkpoint that is computed in another way.
        self.list_values([{**v, "value": v["value"] * (1 + 1e-15)} if v["name"] == "path-length" else v for v in values])
        answer = program.calot("golden", "check", "--folder", self.golden)
        self.assertEqual(answer.code, 3, answer)
        self.assertIn("path-length", answer.err + answer.out)

        # The list takes it over only where the definition's version says that it is another; new ones always.
        self.refused(3, "golden", "values", "--folder", self.golden, "--reason", "x", names=["path-length"])
        self.refused(2, "golden", "values", "--folder", self.golden, "--reason", " ", names=["--reason"])
        older = [{**v, "value": v["value"] * 2, "version": 1} if v["name"] == "path-length" else v for v in values]
        self.assertNotEqual([v["version"] for v in older], [v["version"] for v in values], "the definition has no version before this one")
        self.list_values([v for v in older if v["name"] != "sparc"])
        taken = self.well("golden", "values", "--folder", self.golden, "--reason", "a finer filter")
        self.assertIn("definition version", taken.out)
        self.assertIn("sparc left: none -> ", taken.out)
        self.assertEqual(self.listed(), {**listed, "values_reason": "a finer filter"})
        self.well("golden", "check", "--folder", self.golden)

        # A force that differs, and nothing else: its digest tells.
        with h5py.File(self.golden / "touch.h5", "r+") as file:
            digests = file["/steps/force_digest"][:]
            digests[200] = int(digests[200]) ^ 1
            file["/steps/force_digest"][:] = digests
        answer = program.calot("golden", "check", "--folder", self.golden)
        self.assertEqual(answer.code, 3, answer)
        self.assertIn("step 200: force digest", answer.err + answer.out)
        before = self.listed()
        answer = program.calot("golden", "values", "--folder", self.golden, "--reason", "x")
        self.assertEqual(answer.code, 3, answer)
        self.assertEqual(self.listed(), before, "values of another simulation were taken over")

    def test_goldens_of_a_newer_version_stay(self):
        self.write([ENTRY], version=99999)
        self.commit()
        self.refused(2, "golden", "update", "--folder", self.golden, "--reason", "x", names=["99999"])
        self.assertEqual(self.listed()["simulation_version"], 99999)
        self.assertEqual([p.name for p in self.golden.iterdir()], ["golden.json"])

    def made_long(self):
        """A golden of digests, as it was made."""
        self.write([LONG])
        self.commit()
        self.assertEqual(self.update().code, 0)
        self.commit()
        return json.loads((self.golden / "long.json").read_text())

    def check(self, digests, *options):
        (self.golden / "long.json").write_text(digests if isinstance(digests, str) else json.dumps(digests))
        return program.calot("golden", "check", "--folder", self.golden, *options)

    def differs(self, digests):
        """What differs first from the golden, and in which step."""
        answer = self.check(digests, "--json")
        self.assertEqual(answer.code, 3, answer)
        found = json.loads(answer.out)["recordings"][0]["divergence"]
        return found["component"], found["step"]

    @staticmethod
    def with_fault(digests, **steps):
        """One digit of the link of a step is another."""
        planted = {**digests}
        for chain, step in steps.items():
            line, at = divmod(step, 100)
            planted[chain] = list(digests[chain])
            text = planted[chain][line]
            planted[chain][line] = text[:4 * at] + ("1" if text[4 * at] == "0" else "0") + text[4 * at + 1:]
        return planted

    def test_a_long_golden_is_digests(self):
        made = self.made_long()
        self.assertEqual(sorted(p.name for p in self.golden.iterdir()), ["golden.json", "long.json"])
        self.assertEqual(list(made), ["simulation_version", "build", "scene", "performer", "samples", "steps", "reason"])
        self.assertEqual(made["reason"], "contact is solved in another way")
        self.assertRegex(made["scene"], rf"^{SCENE}, SHA-256 [0-9a-f]{{64}}$")
        self.assertRegex(made["performer"], r"^skilled [\d.]+, seed 7$")
        for chain in ("samples", "steps"):  # 200 steps, and how the run ended
            self.assertEqual([len(line) for line in made[chain]], [99 * 4 + 16, 99 * 4 + 16, 16])
        self.assertRegex(self.check(made).out, r"long\.json: bit-exact, 2\.00 s \(200 steps\)")
        self.assertEqual(json.loads(self.check(made, "--json").out)["recordings"][0]["message"], "bit-exact")

        # A step and the performer have verdicts of their own, each with the first step that differs.
        for fault, verdict in (({"steps": 120}, ("step", 120)), ({"steps": 99}, ("step", 99)), ({"samples": 57}, ("performer", 57)),
                               ({"samples": 57, "steps": 57}, ("performer", 57)), ({"samples": 57, "steps": 120}, ("performer", 57)),
                               ({"samples": 120, "steps": 57}, ("step", 57))):
            self.assertEqual(self.differs(self.with_fault(made, **fault)), verdict)
        self.refused(3, "golden", "check", "--folder", self.golden, names=["long.json", "step 57"])

        # A run that ends sooner or later is its performer's doing.
        longer = {chain: [*made[chain][:2], made[chain][1][:100] + made[chain][2]] for chain in ("samples", "steps")}
        self.assertEqual(self.differs({**made, **longer}), ("performer", 200))

        self.assertEqual(self.check({**made, "simulation_version": 1}).code, 5)
        for text, says in (("no json", "long.json"), (json.dumps({**made, "samples": 1}), "/samples"), (json.dumps({"samples": made["samples"]}), "steps")):
            answer = self.check(text)
            self.assertEqual(answer.code, 4, answer)
            self.assertIn(says, answer.err)

    def test_a_changed_step_raises_the_version(self):
        made = self.made_long()
        self.refused(2, "golden", "update", "--folder", self.golden, "--reason", "again", names=["raises simulationVersion"])
        planted = json.dumps(self.with_fault(made, steps=120))
        (self.golden / "long.json").write_text(planted)
        self.refused(3, "golden", "update", "--folder", self.golden, "--reason", "again", names=["long.json", "step 120", "raises simulationVersion"])
        self.assertEqual((self.golden / "long.json").read_text(), planted)

    def test_a_changed_performer_makes_its_golden_again(self):
        made = self.made_long()
        assets = self.folder / "assets"
        for part in ("scenes", "organs", "performers"):
            shutil.copytree(program.SOURCE / "assets" / part, assets / part)
        before = os.environ.get("CALOT_ASSETS")
        self.addCleanup(os.environ.update if before else os.environ.pop, *([{"CALOT_ASSETS": before}] if before else ["CALOT_ASSETS"]))
        os.environ["CALOT_ASSETS"] = str(assets)
        self.assertEqual(self.check(made).code, 0)

        profile = assets / "performers/skilled.json"
        skilled = json.loads(profile.read_text())
        version = skilled["version"]
        skilled["motor"]["tremorAmplitude"] *= 2
        profile.write_text(json.dumps({**skilled, "version": "9.9"}))
        self.assertEqual(self.differs(made)[0], "performer")
        self.refused(3, "golden", "check", "--folder", self.golden, names=["performer", f"skilled {version}", "skilled 9.9"])
        again = self.update("a steadier hand was measured")
        self.assertEqual(again.code, 0, again)
        self.assertIn("skilled 9.9", again.out)
        now = json.loads((self.golden / "long.json").read_text())
        self.assertEqual((now["reason"], now["performer"]), ("a steadier hand was measured", "skilled 9.9, seed 7"))
        self.assertEqual(self.listed()["reason"], "contact is solved in another way")
        self.assertEqual(self.check(now).code, 0)

        scene = assets / f"scenes/{SCENE}.json"
        scene.write_text(scene.read_text() + "\n")
        self.assertEqual(self.differs(now), ("scene", 0))

    def test_an_update_belongs_to_a_revision(self):
        (self.tree / "source.txt").write_text("changed\n")
        self.refused(2, "golden", "update", "--folder", self.golden, "--reason", "x", names=["commit them first"])
        self.commit()
        self.refused(2, "golden", "update", "--folder", self.golden, "--reason", " ", names=["--reason"])
        self.refused(2, "golden", "update", "--folder", self.golden, names=["--reason"])
        self.assertEqual([p.name for p in self.golden.iterdir()], ["golden.json"])
        alone = self.folder / "alone"
        alone.mkdir()
        (alone / "golden.json").write_text((self.golden / "golden.json").read_text())
        self.refused(2, "golden", "update", "--folder", alone, "--reason", "x", names=[alone])

    def test_bad_lists(self):
        for recordings, says in (([{**ENTRY, "file": "../x.h5"}], "/recordings/0/file"), ([ENTRY, ENTRY], "/recordings/1"),
                                 ([{**ENTRY, "seconds": -1}], "/recordings/0/seconds"), ([], "/recordings"),
                                 ([{**ENTRY, "more": 1}], "more")):
            self.write(recordings)
            self.refused(4, "golden", "check", "--folder", self.golden, names=[says])
        self.write([ENTRY])
        self.refused(4, "golden", "check", "--folder", self.golden, names=["touch.h5"])  # never made
        self.refused(2, "golden", "check", "--folder", self.golden, "--only", "other.h5", names=["other.h5"])
        self.write([{**ENTRY, "scene": "nowhere"}])
        self.commit()
        answer = self.update()
        self.assertIn(answer.code, (2, 4), answer)
        self.assertEqual([p.name for p in self.golden.iterdir()], ["golden.json"], "something is left behind")


if __name__ == "__main__":
    program.main()
