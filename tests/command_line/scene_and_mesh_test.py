# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene of one's own from a scanner's surface: holes are told and filled, units that cannot be are refused, what was lost is a warning,
the surface written can be used in a scene; a scene's check says all faults at once, what catches nothing, and surfaces that are too fine."""

import json
import math
import shutil

import program
from program import ProgramTest, calot

LIVER = program.SOURCE / "assets/organs/liver.obj"


def obj(file):
    vertices, triangles = [], []
    for line in file.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["f"]:
            triangles.append(tuple(int(w.split("/")[0]) - 1 for w in words[1:4]))
    return vertices, triangles


def write_obj(file, vertices, triangles, scale=1.0):
    file.write_text("".join(f"v {scale * x!r} {scale * y!r} {scale * z!r}\n" for x, y, z in vertices) +
                    "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles))


def torn(vertices, triangles, holes):
    """Without the triangles that have a vertex within so many metres of a vertex."""
    gone = set()
    for vertex, radius in holes:
        gone |= {t for t in triangles if any(math.dist(vertices[v], vertices[vertex]) < radius for v in t)}
    return [t for t in triangles if t not in gone]


class Mesh(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.vertices, cls.triangles = obj(LIVER)

    def holed(self):
        """The liver in mm with two large holes."""
        file = self.path("scan.obj")
        write_obj(file, self.vertices, torn(self.vertices, self.triangles, ((100, 0.012), (2500, 0.02))), 1000.0)
        return file

    def test_places_of_holes_are_told(self):
        file = self.holed()
        answer = self.refused(3, "mesh", file, "--unit", "mm", "--tetrahedra", 800, "-o", self.path("o.vtk"), names=("2 holes", "--repair fills holes"))
        self.assertRegex(answer.err, r"\d+ edges around \(-?[\d.]+, -?[\d.]+, -?[\d.]+\) mm")
        self.assertFalse(self.path("o.vtk").exists())
        said = json.loads(calot("mesh", file, "--unit", "mm", "--tetrahedra", 800, "-o", self.path("o.vtk"), "--json").out)
        self.assertEqual((said["ok"], [h["filled"] for h in said["holes"]]), (False, [False, False]))
        for hole in said["holes"]:
            self.assertGreater(hole["edges"], 20)
            self.assertLess(min(math.dist(hole["centre_m"], self.vertices[v]) for v in (100, 2500)), 0.01)

    def test_holes_are_filled_on_request_and_the_surface_is_for_scenes(self):
        file, surface = self.holed(), self.path("organs") / "scan.obj"
        surface.parent.mkdir()
        answer = calot("mesh", file, "--unit", "mm", "--repair", "--tetrahedra", 800, "-o", self.path("o.vtk"), "--surface-output", surface, "--json")
        self.assertEqual(answer.code, 0, answer)
        self.assertIn(f"calot: warning: {file}: 2 holes", answer.err)
        said = json.loads(answer.out)
        self.assertEqual([h["filled"] for h in said["holes"]], [True, True])
        whole = json.loads(calot("mesh", LIVER, "--unit", "m", "--tetrahedra", 800, "-o", self.path("w.vtk"), "--json").out)
        self.assertAlmostEqual(said["surface_output_volume_m3"] / whole["surface_volume_m3"], 1.0, delta=0.02)
        # What was written needs no repair, and a scene takes it.
        again = json.loads(calot("mesh", surface, "--unit", "m", "--tetrahedra", 800, "-o", self.path("p.vtk"), "--json").out)
        self.assertEqual((again["ok"], again["input"]["closed"], again["holes"]), (True, True, []))
        made = self.path("my") / "scenes" / "press.json"
        self.well("scene", "template", surface, "--unit", "m", "--tetrahedra", 400, "-o", made)
        self.assertIn("sound, 0 notes", self.well("scene", "check", made).out)
        self.well("record", "--scene", made, "--performer", "skilled", "--seconds", 0.2, "-o", self.path("a.h5"))
        self.well("replay", self.path("a.h5"))

    def test_a_surface_is_made_coarser(self):
        coarse = self.path("coarse.obj")
        said = json.loads(self.well("mesh", LIVER, "--unit", "m", "--surface-output", coarse, "--surface-triangles", 2000, "--json").out)
        self.assertAlmostEqual(said["surface_output_triangles"] / 2000, 1.0, delta=0.3)
        whole = json.loads(calot("mesh", coarse, "--unit", "m", "--tetrahedra", 500, "-o", self.path("c.vtk"), "--json").out)
        self.assertTrue(whole["input"]["closed"])
        self.assertEqual(whole["input"]["triangles"], said["surface_output_triangles"])
        self.refused(3, "mesh", LIVER, "--unit", "m", "--surface-output", self.path("f.obj"), "--surface-triangles", 100000, names=("--surface-triangles",))

    def test_a_unit_that_cannot_be_is_refused(self):
        file = self.path("mm.obj")
        write_obj(file, self.vertices, self.triangles, 1000.0)
        self.refused(2, "mesh", file, "--unit", "m", "--tetrahedra", 500, "-o", self.path("o.vtk"), names=(file, "--unit mm"))
        self.refused(2, "mesh", LIVER, "--unit", "mm", "--tetrahedra", 500, "-o", self.path("o.vtk"), names=("--unit m (",))
        self.assertFalse(self.path("o.vtk").exists())

    def test_what_was_lost_is_a_warning(self):
        file = self.path("d.obj")
        write_obj(file, self.vertices, [*self.triangles, self.triangles[0], self.triangles[7]])
        answer = calot("mesh", file, "--unit", "m", "--tetrahedra", 500, "-o", self.path("o.vtk"))
        self.assertEqual(answer.code, 0, answer)
        self.assertIn(f"calot: warning: {file}: 2 triangles", answer.err)


class Scene(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = json.loads((program.SOURCE / "assets/scenes/touch-liver.json").read_text())
        (self.path("my") / "scenes").mkdir(parents=True)
        shutil.copytree(program.SOURCE / "assets/organs", self.path("my") / "organs")
        self.file = self.path("my") / "scenes" / "touch-liver.json"

    def write(self):
        self.file.write_text(json.dumps(self.scene))
        return self.file

    def test_all_faults_at_once(self):
        self.scene["organs"][0]["tetrahedra"] = 1
        self.scene["organs"][1]["material"]["density"] = "heavy"
        self.scene["hands"]["left"]["instrument"] = "hok"
        self.scene["worksapce"] = {}
        answer = calot("scene", "check", self.write())
        self.assertEqual(answer.code, 4, answer)
        self.assertOneLine(answer, self.file, "4 faults")
        for place in ("/organs/0/tetrahedra", "/organs/1/material/density", "/hands/left/instrument", "/worksapce"):
            self.assertEqual(answer.out.count(place), 1, answer.out)
        for nearest in ("hook", "workspace"):
            self.assertIn(f'did you mean "{nearest}"?', answer.out)
        said = json.loads(calot("scene", "check", self.file, "--json").out)
        self.assertEqual((said["sound"], len(said["faults"])), (False, 4))

    def test_shipped_scenes_are_sound(self):
        for name in ("touch-liver", "carve-fat"):
            said = json.loads(self.well("scene", "check", name, "--json").out)
            self.assertEqual((said["sound"], said["faults"], [n for n in said["notes"] if "catches" in n or "ties nothing" in n]), (True, [], []))
            self.assertFalse(any(c["fine"] for c in said["surfaces"]))

    def test_a_template_is_not_written_over_another_scene(self):
        target = self.path("t") / "scenes" / "one.json"
        self.well("scene", "template", program.SOURCE / "assets/organs/gallbladder.obj", "--unit", "m", "--tetrahedra", 120, "-o", target)
        before = target.read_bytes()
        self.refused(2, "scene", "template", program.SOURCE / "assets/organs/gallbladder.obj", "--unit", "m", "-o", target, names=("--force",))
        self.assertEqual(target.read_bytes(), before)

    def test_a_scene_is_divided_otherwise(self):
        original = json.loads((program.SOURCE / "assets/scenes/cholecystectomy.json").read_text())
        made = self.path("d") / "scenes" / "fine.json"
        divide = ("scene", "divide", "cholecystectomy", "-o", made)
        self.well(*divide, "--elements", 8, "--ticks-per-step", 5)  # lengths halved
        fine = json.loads(made.read_text())
        self.assertEqual([o["tetrahedra"] for o in fine["organs"]], [8 * o["tetrahedra"] for o in original["organs"]])
        self.assertEqual([v["elements"] for v in fine["vessels"]], [2 * v.get("elements", 40) for v in original["vessels"]])
        self.assertEqual([c["strands"] for c in fine["connective"]], [4 * c["strands"] for c in original["connective"]])
        self.assertEqual([f["cellsPerCube"] for f in fine["fat"]], [round(f["cellsPerCube"] / 2) for f in original["fat"]])
        self.assertEqual((fine["name"], fine["ticksPerStep"]), ("fine", 5))
        for part in ("organs", "vessels", "connective", "fat"):
            for item in (*fine[part], *original[part]):
                for key in ("tetrahedra", "elements", "strands", "cellsPerCube"):
                    item.pop(key, None)
        for scene in (fine, original):
            for key in ("name", "ticksPerStep"):
                scene.pop(key, None)
        self.assertEqual(fine, original, "all else as it is")
        before = made.read_bytes()
        self.well(*divide, "--elements", 8, "--ticks-per-step", 5)  # what is there alike stays
        self.refused(2, *divide, names=(made, "--force"))
        self.assertEqual(made.read_bytes(), before)
        self.refused(3, "scene", "divide", "cholecystectomy", "--elements", 0.1, "-o", self.path("d") / "scenes" / "coarse.json", names=("/fat/0/cellsPerCube",))
        self.refused(2, "scene", "divide", "cholecystectomy", "-o", self.path("fine.txt"), names=("fine.txt", ".json"))


if __name__ == "__main__":
    program.main()
