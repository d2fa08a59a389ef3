#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces as scanners, modellers and printers write them: each is read to its volume and its bodies, with a word for what was done to it, or
refused with a line that says what to do."""

import json
import math
import random
import shutil
import struct
import unittest

import program
from program import PROGRAM, calot

EXACT = (PROGRAM.parent.parent / "lib/calot/surfaces.so").exists()


def prism(outline, height=20.0):
    """An outline that runs counter-clockwise, drawn up; both ends are one face each."""
    n = len(outline)
    vertices = [(x, y, z) for z in (0.0, height) for x, y in outline]
    return vertices, [list(range(n))[::-1], list(range(n, 2 * n)), *([i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n))]


def box(x=0.0, y=0.0, z=0.0, a=20.0, b=None, c=None, first=0):
    """@param first turns the names of the corners: faces are cut along other diagonals"""
    b, c = b or a, c or a
    vertices, faces = prism([(x, y), (x + a, y), (x + a, y + b), (x, y + b)], c)
    return [(p, q, r + z) for p, q, r in vertices], [f[first:] + f[:first] for f in faces]


def ellipsoid(x=0.0, axes=(40.0, 30.0, 20.0), rows=32, columns=64):
    vertices = [(x, 0.0, axes[2])]
    for i in range(1, rows):
        for j in range(columns):
            u, v = math.pi * i / rows, 2 * math.pi * j / columns
            vertices.append((x + axes[0] * math.sin(u) * math.cos(v), axes[1] * math.sin(u) * math.sin(v), axes[2] * math.cos(u)))
    vertices.append((x, 0.0, -axes[2]))
    at, last = lambda i, j: 1 + (i - 1) * columns + j % columns, len(vertices) - 1
    faces = [[0, at(1, j), at(1, j + 1)] for j in range(columns)] + [[last, at(rows - 1, j + 1), at(rows - 1, j)] for j in range(columns)]
    for i in range(1, rows - 1):
        for j in range(columns):
            faces += [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]]
    return vertices, faces


def turned(surface):
    return surface[0], [f[::-1] for f in surface[1]]


def together(*surfaces):
    vertices, faces = [], []
    for v, f in surfaces:
        faces += [[i + len(vertices) for i in face] for face in f]
        vertices += v
    return vertices, faces


def obj(surface):
    return "".join(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in surface[0]) + \
        "".join("f " + " ".join(str(i + 1) for i in f) + "\n" for f in surface[1])


def triangles(surface):
    for f in surface[1]:
        for k in range(2, len(f)):
            yield [surface[0][i] for i in (f[0], f[k - 1], f[k])]


def stl(surface, head=b"made", move=lambda p: p, tail=b""):
    corners = list(triangles(surface))
    return head.ljust(80)[:80] + struct.pack("<I", len(corners)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *[c for p in t for c in move(p)], 0) for t in corners) + tail


def stl_text(surface, name="made", end="\n"):
    body = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %.9g %.9g %.9g\n" % tuple(p) for p in t) + "endloop\nendfacet\n"
                   for t in triangles(surface))
    return f"solid {name}\n{body}endsolid {name}\n".replace("\n", end)


def ply(surface, form="ascii", end="\n", comment="x", colour="255"):
    head = f"ply\nformat {form} 1.0\ncomment {comment}\nelement vertex {len(surface[0])}\nproperty double x\nproperty double y\nproperty double z\n" \
           f"property float quality\nelement face {len(surface[1])}\nproperty list uchar int vertex_indices\nend_header\n".replace("\n", end)
    if form == "ascii":
        return head + "".join("%.9g %.9g %.9g %s%s" % (*p, colour, end) for p in surface[0]) + "".join(
            " ".join(map(str, [len(f), *f])) + end for f in surface[1])
    order = ">" if "big" in form else "<"
    return head.encode() + b"".join(struct.pack(order + "3df", *p, math.nan) for p in surface[0]) + b"".join(
        struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in surface[1])


L = [(60, 0), (60, 20), (20, 20), (20, 60), (0, 60), (0, 0)]
CAPPED = prism(L)


def bodies(file):
    """Parts of an OBJ file that edges connect."""
    parent = {}

    def root(v):
        while parent.setdefault(v, v) != v:
            v = parent[v]
        return v

    for line in file.read_text().splitlines():
        if line.startswith("f "):
            a, *rest = line.split()[1:]
            for b in rest:
                parent[root(b)] = root(a)
    return len({root(v) for v in parent})


class Surfaces(program.ProgramTest):
    def write(self, name, content):
        path = self.path(name)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def mend(self, name, content, *arguments):
        """What `calot mesh` says of it, and the number of bodies."""
        out = self.path("o.obj")
        answer = calot("mesh", self.write(name, content), "--unit", "mm", "--surface-output", out, "--force", "--json", *arguments)
        self.assertEqual(answer.code, 0, answer)
        said = json.loads(answer.out)
        self.assertEqual([line.split(f"{name}: ", 1)[1] for line in answer.err.splitlines()], said["warnings"])
        return {"volume": 1e6 * said["surface_output_volume_m3"], "bodies": bodies(out), "words": " ".join(said["warnings"]), **said}

    def assertBody(self, said, volume, count=1, words=(), delta=0.001):
        self.assertAlmostEqual(said["volume"], volume, delta=delta * volume, msg=said["warnings"])
        self.assertEqual(said["bodies"], count, said["warnings"])
        self.assertEqual(said["self_crossing_pairs"], 0)
        for word in words:
            self.assertIn(word, said["words"])
        if not words:
            self.assertEqual(said["warnings"], [])

    def test_polygons(self):
        rng = random.Random(5)
        star = [(r * math.cos(i * math.pi / 1500), r * math.sin(i * math.pi / 1500)) for i, r in
                enumerate(rng.uniform(10, 30) for _ in range(3000))]
        comb = [(0, 0), (60, 0), *((60 - i / 10, 20 if i % 2 else 2) for i in range(600)), (0, 20)]
        # A hole that a bridge joins to the rim.
        frame = [(0, 0), (60, 0), (60, 60), (0, 60), (0, 0), (20, 20), (20, 40), (40, 40), (40, 20), (20, 20)]
        area = lambda p: sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(p, p[1:] + p[:1])) / 2
        for name, outline in (("L", L), ("L from another corner", L[3:] + L[:3]), ("star", star), ("comb", comb)):
            with self.subTest(name):
                for content in (("a.obj", obj(prism(outline))), ("a.ply", ply(prism(outline))) if len(outline) < 256 else ("a.stl", "")):
                    if content[1]:
                        self.assertBody(self.mend(*content), area(outline) * 20 / 1000)
        vertices, faces = prism(frame)
        faces = [[{4: 0, 9: 5, 14: 10, 19: 15}.get(i, i) for i in f] for f in faces if sorted(f) not in ([3, 4, 13, 14], [4, 5, 14, 15], [0, 9, 10, 19])]
        faces += [[3, 0, 10, 13]]
        self.assertBody(self.mend("frame.obj", obj((vertices, faces))), 64.0)
        far = prism([(10 * math.cos(2 * math.pi * i / 40000) * (2 + i % 2), 10 * math.sin(2 * math.pi * i / 40000) * (2 + i % 2)) for i in range(40000)])
        self.refused(4, "mesh", self.write("far.obj", obj(far)), "--unit", "mm", "--surface-output", self.path("p.obj"), names=("line 80001", "40000", "triangulate"))

    def test_spellings(self):
        text = obj(CAPPED)
        slashes = lambda end: "\n".join(" ".join([l.split()[0], *(w + end for w in l.split()[1:])]) if l.startswith("f") else l for l in text.split("\n"))
        blocks = "".join("".join("v %g %g %g\n" % p for p in box(40 * k)[0]) + "".join("f " + " ".join(str(i - 8) for i in f) + "\n" for f in box()[1])
                         for k in range(3))
        for name, file, content, volume, count in (
                ("byte order mark", "a.obj", "\ufeff" + text.replace("\n", "\r\n"), 40, 1),
                ("no texture, no normal", "a.obj", slashes("//"), 40, 1),
                ("one slash", "a.obj", slashes("/"), 40, 1),
                ("a path that ends with a backslash", "a.obj", "mtllib C:\\models\\\nusemtl a\\\n" + text, 40, 1),
                ("continued lines", "a.obj", text.replace(" 5 ", " 5 \\\n").replace("v 60 ", "v 60 \\\r\n"), 40, 1),
                ("colours that are no numbers", "a.obj", "\n".join(l + " red nan" if l.startswith("v") else l for l in text.split("\n")), 40, 1),
                ("indices that count back", "a.obj", blocks, 24, 3),
                ("mark before a text", "a.stl", "\ufeff" + stl_text(box()), 8, 1),
                ("CRLF", "a.stl", stl_text(box(), end="\r\n"), 8, 1),
                ("solid, and binary", "a.stl", stl(box(), b"solid made by a modeller"), 8, 1),
                ("mark before a header", "a.ply", "\ufeff" + ply(CAPPED), 40, 1),
                ("CRLF before bytes", "a.ply", ply(CAPPED, "binary_big_endian", "\r\n"), 40, 1),
                ("the other order", "a.ply", ply(CAPPED, "binary_little_endian"), 40, 1),
                ("a value that is no number", "a.ply", ply(CAPPED, colour="nan"), 40, 1),
                ("OFF", "a.off", "OFF\n# made\n%d %d 0\n" % tuple(map(len, CAPPED)) + "".join("%g %g %g\n" % p for p in CAPPED[0]) +
                 "".join(" ".join(map(str, [len(f), *f])) + " 255 0 0\n" for f in CAPPED[1]), 40, 1)):
            with self.subTest(name):
                self.assertBody(self.mend(file, content), volume, count)
        self.assertBody(self.mend("a.stl", stl(box(), b"solid", tail=b"\0" * 37)), 8, words=("37 bytes",))
        self.assertBody(self.mend("a.obj", "v 1e9 1e9 1e9\n" + obj((CAPPED[0], [[i + 1 for i in f] for f in CAPPED[1]]))), 40, words=("1000 m: 1",))
        self.assertBody(self.mend("a.obj", text + "v 9000 0 0\n"), 40)
        for name, word in (("a.vtp", "3D Slicer"), ("a.glb", "Blender"), ("a.3mf", ".stl"), ("a.nii.gz", "volume"), ("liver", ".obj")):
            self.refused(2, "mesh", self.write(name, "x"), "--unit", "mm", "--surface-output", self.path("p.obj"), names=(name, word))

    def test_frames(self):
        """A bump at +x in RAS is one at -x of the same numbers in LPS; a scene that names the file turns it, too."""
        bump = together(box(-20, -10, 0, 20, 40, 20), turned(box(100, 0, 0, 5)))[0][:8], box()[1]
        for name, content in (("a.stl", lambda space: stl(bump, f"3D Slicer output. SPACE={space}".encode())),
                              ("b.stl", lambda space: stl_text(bump, f"3D Slicer output. SPACE={space}")),
                              ("a.ply", lambda space: ply(bump, comment=f"3D Slicer output. SPACE={space}")),
                              ("a.obj", lambda space: f"# 3D Slicer output. SPACE={space}\n" + obj(bump))):
            for space, least in (("RAS", (-0.02, -0.01)), ("LPS", (0.0, -0.03))):
                with self.subTest(name, space=space):
                    said = self.mend(name, content(space))
                    self.assertBody(said, 16.0, words=("LPS",) if space == "LPS" else ())
                    self.assertLess(math.dist(said["input"]["lower_m"][:2], least), 1e-6)
                    self.mend("again.obj", obj(bump))
        scene = self.path("my") / "scenes" / "one.json"
        answer = calot("scene", "template", self.write("lps.stl", stl(bump, b"SPACE=LPS")), "--unit", "mm", "--tetrahedra", 200, "-o", scene)
        self.assertIn("LPS", answer.err)
        self.assertEqual(json.loads(scene.read_text())["organs"][0]["mesh"]["translation"], [-0.01, 0.01, -0.01])
        self.assertIn("LPS", self.well("scene", "check", scene).out)

    def test_corners_equal_but_for_rounding(self):
        for size in (1e-7, 1e-6, 1e-5):
            rng = random.Random(3)
            noisy = stl(ellipsoid(), move=lambda p, s=size, r=rng: [c * (1 + r.uniform(-s, s)) for c in p])
            whole = self.mend("whole.stl", stl(ellipsoid()))["volume"]
            for arguments in ((), ("--repair",)):
                with self.subTest(size=size, arguments=arguments):
                    self.assertBody(self.mend("a.stl", noisy, *arguments), whole, words=("open edges became 0", " mm were joined"))

    def test_parts_that_overlap_without_the_module(self):
        alone = self.path("bin") / "calot"
        alone.parent.mkdir()
        shutil.copy2(PROGRAM, alone)
        self.refused(1, "mesh", self.write("two.obj", obj(together(box(), box(10, 5, 5)))), "--unit", "mm", "--surface-output", self.path("p.obj"),
                     names=("two.obj", "overlap", "surfaces.so", "calot-modules"), program=alone)
        self.assertFalse(self.path("p.obj").exists())

    @unittest.skipUnless(EXACT, "built without CGAL")
    def test_parts_that_overlap(self):
        for first in range(4):
            for surfaces in ((box(), box(10, 0, 0, 20, 10, 10, first)), (box(first=first), box(10, 5, 5, 20, 10, 10)),
                             (box(10, 0, 0, 20, 10, 10, first), turned(box()))):
                for name, form in (("a.obj", obj), ("a.stl", stl)):
                    with self.subTest(first=first, name=name):
                        self.assertBody(self.mend(name, form(together(*surfaces))), 9.0, words=("2 parts that overlap were joined", "10 mL together, 9 mL"))
        two = obj(together(ellipsoid(), ellipsoid(60)))
        said = self.mend("two.obj", two, "--tetrahedra", 1000, "-o", self.path("two.vtk"))
        # Two smooth ellipsoids of 100.53 mL, less twice a cap that is a quarter of the radius high.
        self.assertBody(said, 2 * (32 - 0.25**2 * 2.75 * 8) * math.pi, words=("200.3 mL together", "191.7 mL as one body"), delta=0.005)
        self.assertAlmostEqual(1e6 * said["surface_volume_m3"], said["volume"], delta=1e-6)
        self.assertLess(said["volume_error"], 0.01)
        # One that crosses itself is not joined exactly; nothing is claimed then.
        vertices, faces = ellipsoid(rows=12, columns=24)
        vertices[0] = (0.0, 0.0, -40.0)
        said = self.mend("not.obj", obj(together((vertices, faces), ellipsoid(60))), "--tetrahedra", 300, "-o", self.path("not.vtk"))
        self.assertIn("2 parts overlap and were not joined", said["words"])
        self.assertNotIn("volume_error", said)
        chain = together(*(box(15.0 * i, 3.0 * (i % 2), 0) for i in range(5)), box(200))
        self.assertBody(self.mend("chain.obj", obj(chain)), (5 * 20 - 4 * 5 + 0) * 0.4 - 4 * (5 * 17 - 5 * 20) * 0.02 + 8, 2, words=("5 parts",))

    @unittest.skipUnless(EXACT, "built without CGAL")
    def test_parts_on_which_the_library_ends_its_program(self):
        # Found by fuzzing; the byte in front says how the target reads it.
        content = (program.SOURCE / "tests/fuzz/corpus/mesh/parts_that_cgal_fails_on").read_bytes()[1:]
        self.assertIn("4 parts overlap and were not joined", self.mend("parts.stl", content, "--repair")["words"])

    def test_parts_in_parts(self):
        inner = box(5, 5, 5, 10)
        for name, surface, volume, count, words in (
                ("cavity", together(box(), turned(inner)), 7, 2, ()),
                ("a cavity, all turned", together(turned(box()), inner), 7, 2, ("",)),
                ("one orientation", together(box(), inner), 8, 1, ("1 parts (1 mL) inside others", "solid")),
                ("one orientation, inward", together(turned(box()), turned(inner)), 8, 1, ("1 parts (1 mL)",)),
                ("a body in a cavity", together(box(), turned(inner), box(8, 8, 8, 4)), 7.064, 3, ()),
                ("side by side", together(box(), box(20)), 16, 2, ()),
                ("apart", together(box(), box(30)), 16, 2, ())):
            for file, form in (("a.obj", obj), ("a.ply", ply)):
                with self.subTest(name, file=file):
                    said = self.mend(file, form(surface))
                    if words == ("",):
                        self.assertEqual(said["input"]["repaired"]["flipped_triangles"], 24)
                    self.assertBody(said, volume, count, words if words != ("",) else ())

    def test_edges_of_more_than_two_triangles(self):
        edge = together(box(), box(20, 20))
        corner = together(box(), box(20, 20, 20))
        face = together(box(), box(20))
        chambers = together(box(), box(20, first=1))
        vertices, faces = chambers
        wall = [f for f in faces[:6] if all(vertices[i][0] == 20 for i in f)]
        shell = [f for f in faces if not all(vertices[i][0] == 20 for i in f)]
        for name, content, volume, count, words in (
                ("edge", stl(edge), 16, 2, ("separated",)), ("edge, own corners", obj(edge), 16, 2, ()), ("corner", stl(corner), 16, 2, ()),
                ("face", stl(face), 16, 1, ("walls inside",)), ("face, other diagonals", stl(chambers), 16, 1, ("walls inside",)),
                ("one wall", stl((vertices, shell + wall)), 16, 1, ("walls inside",))):
            with self.subTest(name):
                said = self.mend("a.obj" if isinstance(content, str) else "a.stl", content)
                self.assertBody(said, volume, count, words)

    def test_a_volume_error_is_claimed_of_what_has_a_volume(self):
        """One part that passes through itself: its volume counts some twice."""
        vertices, faces = ellipsoid(rows=12, columns=24)
        vertices[0] = (0.0, 0.0, -40.0)  # the upper pole, through the lower one
        out = self.path("t.vtk")
        answer = calot("mesh", self.write("t.obj", obj((vertices, faces))), "--unit", "mm", "--tetrahedra", 300, "-o", out, "--json")
        said = json.loads(answer.out)
        self.assertGreater(said["self_crossing_pairs"], 0, answer)
        self.assertNotIn("volume_error", said)
        self.assertTrue(any("crosses itself" in w and "not known" in w for w in said["warnings"]), said["warnings"])


if __name__ == "__main__":
    program.main()
