# SPDX-License-Identifier: GPL-3.0-or-later
"""The conformance set: both readers read what is expected, a change is noticed and named, and the product itself says the same."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py
    import numpy as np
except ImportError:
    print("h5py or numpy is not installed")
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
EXPECTED = json.loads((HERE / "expected.json").read_text(encoding="utf-8"))
READERS = {"python": [sys.executable, "-B", str(HERE / "reader.py")], "c": [os.environ["CONFORMANCE_READER"]]}


def run(*arguments, text=None):
    return subprocess.run([str(a) for a in arguments], input=text, capture_output=True, text=True, timeout=120, check=False)


class Conformance(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="calot-conformance-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def read(self, reader, file):
        done = run(*READERS[reader], file)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def check(self, name, text):
        return run(sys.executable, "-B", HERE / "check.py", name, "-", text=text)

    def test_readers_pass(self):
        for name, file in EXPECTED["files"].items():
            for reader in READERS:
                with self.subTest(name, reader=reader):
                    done = self.check(name, self.read(reader, HERE / file))
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertTrue(done.stdout.startswith(f"{name}: as expected; not given: units"), done.stdout)
                    self.assertEqual("keyframes" in done.stdout, reader == "c")

    def test_it_holds_what_a_recording_can(self):
        whole, said = EXPECTED["recordings"]["whole"], EXPECTED["recordings"]
        self.assertTrue(whole["events"] and len(whole["keyframes"]) > 1 and whole["device"]["right"]["rows"] and whole["signature"]["valid"])
        self.assertNotEqual(whole["datasets"]["/ticks/right/force"]["sha256"], whole["datasets"]["/ticks/left/force"]["sha256"])
        self.assertIn("/observables/organs/volume", whole["datasets"])
        self.assertEqual([said[n]["complete"] for n in ("whole", "golden", "incomplete")], [True, True, False])
        self.assertEqual({said[n]["attributes"]["format_version"] for n in said}, {1, 2})
        self.assertLess(sum((HERE / file).stat().st_size for name, file in EXPECTED["files"].items() if file.startswith("recordings/")), 400000)

    def test_a_planted_change_is_named(self):
        for reader in READERS:
            def planted(change, named, reader=reader):
                file = self.folder / "changed.h5"
                shutil.copyfile(HERE / EXPECTED["files"]["whole"], file)
                with h5py.File(file, "r+") as opened:
                    change(opened)
                done = self.check("whole", self.read(reader, file))
                self.assertEqual(done.returncode, 1, (reader, named))
                self.assertIn(named, done.stderr)

            def sample(file):
                file["/ticks/right/position"][1234, 1] += 2.0**-20

            def event(file):
                row = file["/events"][0]
                row["subject"] = 7
                file["/events"][0] = row

            def device(file):
                row = file["/device/right/samples"][10]
                row["buttons"] = 1
                file["/device/right/samples"][10] = row

            def signature(file):
                file["/signature/value"][3] ^= 1

            def status(file):
                file["/status"].resize((len(file["/status"]) - 1,))

            planted(lambda file: file.attrs.modify("seed", np.uint64(2)), "whole: attributes.seed: 1 is wanted, not 2")
            planted(sample, "datasets./ticks/right/position.sha256")
            planted(event, "events[0].subject")
            planted(device, "device.right.sha256")
            planted(signature, "signature.value")
            planted(status, "whole: complete: true is wanted, not false")

    def test_a_changed_keyframe_is_named(self):
        file = self.folder / "changed.h5"
        shutil.copyfile(HERE / EXPECTED["files"]["whole"], file)
        with h5py.File(file, "r+") as opened:
            second = int(opened["/keyframes/index"][1]["offset"]) // 8
            parts = int(opened["/keyframes/bytes"][second + 1])
            opened["/keyframes/bytes"][second + 2 + 4 * parts] += 2
        done = self.check("whole", self.read("python", file))
        self.assertEqual((done.returncode, "keyframes[1]." in done.stderr), (1, True), done.stderr)

    def test_what_is_no_output(self):
        for text, named in (("", "no JSON"), ("[]", "an object is wanted"), ("{}", "attributes: missing")):
            done = self.check("whole", text)
            self.assertEqual(done.returncode, 1)
            self.assertIn(named, done.stderr)
        self.assertIn("format-1", self.check("nothing", "{}").stderr)

    def test_the_product_says_the_same(self):
        try:
            import calot
        except ImportError:
            self.skipTest("the Python module is not built")
        sys.path.insert(0, str(HERE))
        import make_conformance
        for name, file in EXPECTED["files"].items():
            self.assertEqual(json.loads(json.dumps(make_conformance.expected(HERE / file))), EXPECTED["recordings"][name], name)
        self.assertEqual(calot.open(HERE / EXPECTED["files"]["format-1"]).header["format_version"], 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
