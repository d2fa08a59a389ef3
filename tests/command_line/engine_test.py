# SPDX-License-Identifier: GPL-3.0-or-later
"""Kept engines: they are there, they are what they say, they decide recordings of their versions."""

import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import zlib

import program

SOURCE = pathlib.Path(os.environ["CALOT_SOURCE_DIR"])
ENGINES = SOURCE / "assets/engines"
FIRST_FORMAT = SOURCE / "tests/recorder/recording/data/format-1.h5"


def engine_script():
    sys.path.insert(0, str(SOURCE / "scripts"))
    import engine
    return engine


class Engine(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.manifest = json.loads((ENGINES / "engines.json").read_text())["engines"]

    def environment(self, **values):
        for name, value in values.items():
            before = os.environ.get(name)
            os.environ[name] = str(value)
            self.addCleanup(os.environ.update, {name: before} if before is not None else {})
            if before is None:
                self.addCleanup(os.environ.pop, name, None)

    def golden(self, version, name):
        return ENGINES / str(version) / name

    def test_each_kept_version_has_its_artefacts(self):
        for entry in self.manifest:
            module = ENGINES / entry["module"]
            self.assertEqual(hashlib.sha256(module.read_bytes()).hexdigest(), entry["sha256"], entry["module"])
            for kind in ("*.transcript", "*.h5"):
                self.assertTrue(list((ENGINES / str(entry["version"])).glob(kind)), (entry["version"], kind))
        newest = json.loads((SOURCE / "assets/golden/golden.json").read_text())["simulation_version"]
        self.assertIn(newest, [e["version"] for e in self.manifest], "keep the engine of the golden recordings: docs/explanation/engines.md")

    def test_a_version_stays_small(self):
        """What the newest version's engine and goldens take in git, which deflates each file."""
        newest = max(self.manifest, key=lambda entry: entry["version"])
        files = [ENGINES / newest["module"], *(ENGINES / str(newest["version"])).glob("*.transcript"), *(SOURCE / "assets/golden").iterdir()]
        sizes = {file.name: len(zlib.compress(file.read_bytes())) for file in files}
        self.assertLess(sum(sizes.values()), engine_script().MOST_ADDED, sizes)

    def test_list(self):
        listed = json.loads(self.well("engine", "list", "--json").out)
        self.assertEqual({e["version"] for e in listed["engines"]} - {e["version"] for e in self.manifest}, set())
        for entry in self.manifest:
            self.assertIn(f"version {entry['version']}: module", self.well("engine", "list").out)

    def assets_without_operation(self):
        """The kept engines without the whole operation, which takes a minute or two: the heavy suite has it."""
        assets = self.folder / "assets"
        shutil.copytree(ENGINES, assets / "engines", ignore=shutil.ignore_patterns("cholecystectomy.h5"))
        return assets

    def test_check(self):
        """Transcripts and golden recordings of kept versions, by their modules."""
        if not shutil.which("node"):
            self.skipTest("no node here")
        if os.environ.get("CALOT_HEAVY"):
            out = self.well("engine", "check").out
            for entry in self.manifest:
                for file in (ENGINES / str(entry["version"])).glob("*.h5"):
                    self.assertIn(f"version {entry['version']}, module: {file.name}: ok", out)
            return
        self.assertIn("bit-exact", self.well("replay", self.golden(12, "dissect-bed.h5")).out)
        newest = max(e["version"] for e in self.manifest)
        self.environment(CALOT_ASSETS=self.assets_without_operation())
        out = self.well("engine", "check", newest).out
        self.assertIn("transcript: ok", out)
        self.assertIn("confined by its runtime", out)

    def test_the_newest_golden_recordings_by_their_module(self):
        if not shutil.which("node"):
            self.skipTest("no node here")
        newest = max(e["version"] for e in self.manifest)
        performed = self.path("dissect-bed.h5")
        self.well("record", "--scene", "dissect-bed", "--performer", "skilled", "--seconds", 3, "--purpose", "golden", "-o", performed)
        for file in (SOURCE / "assets/golden/touch-liver.h5", performed):
            self.assertIn("bit-exact", self.well("replay", "--engine", ENGINES / f"engine-{newest}.wasm", file).out)

    def test_the_version_before(self):
        """Its golden recordings, and a recording in the first format, by its module."""
        if not shutil.which("node"):
            self.skipTest("no node here")
        for file in (self.golden(18, "touch-liver.h5"), FIRST_FORMAT):
            self.assertIn("bit-exact", self.well("replay", file).out)

    def test_a_recording_of_another_version(self):
        file = self.golden(12, "touch-liver.h5")
        if shutil.which("node"):
            self.assertIn("bit-exact", self.well("replay", file).out)
        # Without the assets' engines there is none, and without node none that runs.
        empty = self.folder / "empty"
        empty.mkdir()
        self.environment(CALOT_ASSETS=empty, CALOT_ENGINES=empty)
        self.refused(5, "replay", file, names=["version 12", "installed", "calot engine list"])
        report = json.loads(program.calot("replay", "--json", file).out)["recordings"][0]
        self.assertEqual(report["verdict"], "undecided")
        self.assertIn("no other engine", self.well("engine", "list").out)

    def test_a_native_engine_goes_before_the_module(self):
        engine = pathlib.Path(os.environ["CALOT_PROGRAM"]).parent / "calot-engine"
        folder = self.folder / "engines"
        folder.mkdir()
        own = json.loads(self.well("engine", "list", "--json").out)["own_version"]
        shutil.copy(engine, folder / f"calot-engine-{own}")
        self.environment(CALOT_ENGINES=folder, CALOT_ASSETS=self.assets_without_operation())
        out = self.well("engine", "check", own).out
        self.assertIn(f"version {own}, program: calot-engine", out)
        self.assertNotIn("differs", out)

    def test_apart(self):
        file = self.path("r.h5")
        self.well("record", "--scene", "touch-liver", "--performer", "skilled", "--seconds", 3, "-o", file)
        self.assertEqual(self.first_line(self.well("replay", "--apart", file).out),
                         self.first_line(self.well("replay", file).out))

    @staticmethod
    def first_line(text):
        return text.splitlines()[0].split(", ")[0]

    def test_what_is_wrong_is_said(self):
        file = self.golden(12, "touch-liver.h5")
        self.refused(2, "engine", names=["list, check, build, transcript"])
        self.refused(2, "engine", "check", 99, names=["99", "calot engine list"])
        self.refused(2, "engine", "check", "twelve", names=["twelve"])
        self.refused(2, "engine", "build", 12, "-o", self.path("e"), "--source", self.folder, names=["clone"])
        self.refused(4, "replay", "--engine", self.path("none"), file, names=[self.path("none")])
        self.refused(5, "replay", "--engine", "/bin/true", file, names=["ended"])
        self.refused(5, "replay", "--engine", "/bin/cat", file, names=["/bin/cat"])
        text = self.path("text")
        pathlib.Path(text).write_text("no program")
        self.refused(5, "replay", "--engine", text, file, names=["started"])
        self.refused(2, "engine", "transcript", file, "--engine", "/bin/true", "--steps", 1, "-o", self.path("t"), names=["steps"])
        self.assertFalse(os.path.exists(self.path("t")))

    def test_building_knows_its_versions(self):
        run = subprocess.run([sys.executable, SOURCE / "scripts/engine.py", "build", "3", "-o", self.path("e")], capture_output=True,
                             text=True, check=False)
        self.assertEqual(run.returncode, 1)
        self.assertRegex(run.stderr, r"\bengine 3\b")
        subprocess.run([sys.executable, SOURCE / "scripts/engine.py", "self-test"], check=True, capture_output=True)

    def test_the_sources_of_kept_versions_are_there(self):
        engine = engine_script()
        for entry in self.manifest:
            known = subprocess.run(["git", "-C", SOURCE, "cat-file", "-e", entry["commit"]], capture_output=True, check=False)
            if known.returncode != 0:
                self.skipTest("a clone without its history")
            folder = self.folder / str(entry["version"])
            folder.mkdir()
            engine.check_out(entry["version"], folder)
            for kind in ("module", "native"):
                self.assertGreater(len(engine.matching(folder, engine.source_patterns(folder, kind))), 100)


if __name__ == "__main__":
    program.main()
