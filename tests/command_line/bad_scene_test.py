# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes and performers with one fault each: the place in the file is named, and no recording begins."""

import copy
import json
import shutil

import program
from program import SCENE, calot


def at(tree, path):
    """The container that holds the last key of a path, and this key."""
    for key in path[:-1]:
        tree = tree[key]
    return tree, path[-1]


class Scenes(program.ProgramTest):
    def setUp(self):
        super().setUp()
        shutil.copytree(program.SOURCE / "assets/organs", self.path("organs"), ignore=lambda _, names: [n for n in names if not n.endswith(".obj")])
        self.path("scenes").mkdir()
        self.file = self.path("scenes") / "s.json"
        self.good = json.loads((program.SOURCE / f"assets/scenes/{SCENE}.json").read_text())

    def record(self):
        return ("record", "--scene", self.file, "--performer", "skilled", "--seconds", 0.05, "-o", self.path("o.h5"))

    def refuse(self, scene, *names):
        self.file.write_text(scene if isinstance(scene, str) else json.dumps(scene))
        self.refused(4, *self.record(), names=("s.json", *names))
        self.assertFalse(self.path("o.h5").exists())

    def test_good(self):
        self.file.write_text(json.dumps(self.good))
        self.well(*self.record())
        self.assertIn("bit-exact", self.well("replay", self.path("o.h5")).out)

    def test_values(self):
        for path, value in ((("format",), "something"), (("formatVersion",), 2), (("name",), "Touch Liver"), (("name",), ""),
                            (("version", "major"), -1), (("version", "minor"), 1.5), (("ticksPerStep",), 0), (("ticksPerStep",), "ten"),
                            (("timeLimit",), -1), (("gravity",), [0, 0]), (("gravity",), [0, 0, "down"]), (("gravity",), [0, 0, 1e9]),
                            (("workspace", "upper"), [-0.12, -0.08, -0.13]), (("camera", "target"), [-0.035, 0.055, -0.13]),
                            (("camera", "verticalFieldOfView"), 0), (("hands", "left", "port"), None), (("hands", "left", "home"), [1, 1, 1]),
                            (("hands", "right", "instrument"), "spoon"), (("organs",), []), (("organs", 0, "name"), "gallbladder"),
                            (("organs", 0, "mesh", "file"), "organs/kidney.obj"), (("organs", 0, "mesh", "file"), "../../secret.obj"),
                            (("organs", 0, "mesh", "unit"), "inch"), (("organs", 0, "tetrahedra"), 1), (("organs", 0, "tetrahedra"), 1e12),
                            (("organs", 0, "material", "youngModulus"), -5), (("organs", 0, "material", "poissonRatio"), 0.5),
                            (("organs", 1, "anchors", 0, "nearOrgan", "organ"), "spleen"),
                            (("organs", 1, "anchors", 0, "nearOrgan", "organ"), "gallbladder"), (("surplus",), 1),
                            (("organs", 0, "colour"), "red")):
            with self.subTest(path=path, value=value):
                scene = copy.deepcopy(self.good)
                place, key = at(scene, path)
                place[key] = value
                self.refuse(scene, str(path[-1]) if isinstance(path[-1], str) else "")

    def test_what_is_missing(self):
        for path in (("format",), ("name",), ("hands",), ("hands", "left"), ("organs",), ("organs", 0, "mesh"), ("organs", 0, "material", "density"),
                     ("workspace", "lower"), ("camera", "position")):
            with self.subTest(path=path):
                scene = copy.deepcopy(self.good)
                place, key = at(scene, path)
                del place[key]
                self.refuse(scene, path[-1])

    def test_text(self):
        text = json.dumps(self.good)
        for name, bad in (("empty", ""), ("cut off", text[: len(text) // 2]), ("no object", "[1, 2]"), ("NaN", text.replace("0.45", "NaN", 1)),
                          ("infinite", text.replace("0.45", "1e999", 1)), ("comment", "// scene\n" + text), ("trailing comma", text[:-1] + ",}"),
                          ("key twice", text.replace('"name":', '"name": "a", "name":', 1)), ("deep", "[" * 100000), ("two", text + text)):
            with self.subTest(name):
                self.refuse(bad)
        with self.subTest("not UTF-8"):
            self.file.write_bytes(text.encode().replace(b"Touch", b"\xff\xfe"))
            self.refused(4, *self.record(), names=("s.json",))

    def test_open_surface(self):
        liver = self.path("organs") / "liver.obj"
        lines = liver.read_text().splitlines(keepends=True)
        first = next(i for i, line in enumerate(lines) if line.startswith("f "))
        liver.write_text("".join(lines[:first] + lines[first + 1:]))
        self.file.write_text(json.dumps(self.good))
        self.refused(4, *self.record(), names=("liver.obj", "open edges"))

    def test_list_of_scenes_names_the_bad_one_and_shows_the_others(self):
        for name in ("good", "bad"):
            (self.path("scenes") / f"{name}.json").write_text(json.dumps({**self.good, "name": name}) if name == "good" else "{}")
        answer = calot("scenes", environment={"CALOT_ASSETS": str(self.folder)})
        self.assertEqual(answer.code, 4, answer)
        self.assertOneLine(answer, "bad.json")
        self.assertIn("good", answer.out)

    def test_scenes_as_they_are(self):
        self.assertIn(SCENE, self.well("scenes").out)
        scenes = {s["name"]: s for s in json.loads(self.well("scenes", "--json").out)["scenes"]}
        self.assertEqual([o["name"] for o in scenes[SCENE]["organs"]], [o["name"] for o in self.good["organs"]])


class Performers(program.ProgramTest):
    def test_each_fault(self):
        good = json.loads((program.SOURCE / "assets/performers/skilled.json").read_text())
        file = self.path("p.json")
        record = ("record", "--scene", SCENE, "--performer", file, "--seconds", 0.05, "-o", self.path("o.h5"))
        for path, value in ((("format",), "x"), (("formatVersion",), 7), (("motor", "strokeSpeed"), 0), (("motor", "strokeSpeed"), "fast"),
                            (("motor", "tremorUpper"), 1), (("perception", "reactionTime"), -1), (("decision", "touches"), 1e9),
                            (("decision", "touches"), 2.5), (("decision", "bimanual"), "yes"), (("surplus",), 0), (("motor",), None)):
            with self.subTest(path=path, value=value):
                profile = copy.deepcopy(good)
                place, key = at(profile, path)
                place[key] = value
                file.write_text(json.dumps(profile))
                self.refused(4, *record, names=("p.json", path[-1]))
                self.assertFalse(self.path("o.h5").exists())
        for text in ("", "{", "[]", '{"format": "calot-performer"}'):
            with self.subTest(text=text):
                file.write_text(text)
                self.refused(4, *record, names=("p.json",))
        file.write_text(json.dumps(good))
        self.well(*record)


if __name__ == "__main__":
    program.main()
