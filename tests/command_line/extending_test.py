# SPDX-License-Identifier: GPL-3.0-or-later
"""The examples of docs/extending that need no compiler: a scene with an organ of its own, and a metric."""

import json

import program

EXAMPLES = program.SOURCE / "tests/extending"
SCENE = EXAMPLES / "assets/scenes/press-cyst.json"


class Extending(program.ProgramTest):
    def press(self):
        """The right hand goes 12 mm down within a second, along y of the device, and stays."""
        samples = [[k / 100, 1, 0, 0.012 * min(1.0, k / 100), 0, 1, 0, 0, 0, 0, 0, 1] for k in range(200)]
        self.path("press.json").write_text(json.dumps({"format": "calot-device-script", "formatVersion": 1, "name": "press", "rate": 100,
                                                       "samples": samples}), encoding="utf-8")
        self.well("record", "--scene", SCENE, "--device", f"scripted:{self.path('press.json')}", "-o", self.path("r.h5"))
        return self.path("r.h5")

    def test_a_scene_with_its_own_organ_and_a_metric(self):
        recording = self.press()
        self.assertIn("bit-exact", self.well("replay", recording).out)
        said = json.loads(self.well("assess", recording, "--cohort", self.path("c.db"), "--metric", EXAMPLES / "tremor.py", "--json").out)["recordings"][0]
        values = {(v["name"], v.get("subject", "")): v["value"] for v in said["checkpoints"]}
        self.assertGreater(values["contact-time-union", "cyst"], 0.5)
        self.assertGreater(values["force-maximum", "right"], 0.05)
        tremor = values["right-tremor", ""]
        self.assertGreater(tremor, 0.0)
        self.assertLess(tremor, 1e-4)  # a steady hand: only the corners of its motion and the grid of samples

    def test_its_surface_can_be_filled(self):
        self.well("mesh", EXAMPLES / "assets/organs/cyst.obj", "--unit", "m", "--tetrahedra", 120, "-o", self.path("cyst.vtk"))

    def test_a_mistake_in_a_scene_is_one_line(self):
        folder = self.path("scenes")
        folder.mkdir()
        text = SCENE.read_text(encoding="utf-8").replace('"youngModulus": 10000', '"youngModulus": "soft"')
        (folder / "bad.json").write_text(text, encoding="utf-8")
        self.refused(4, "record", "--scene", folder / "bad.json", "--performer", "skilled", "-o", self.path("r.h5"), names=("bad.json", "youngModulus"))


if __name__ == "__main__":
    program.main()
