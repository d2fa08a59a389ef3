# SPDX-License-Identifier: GPL-3.0-or-later
"""calot state and calot diff: the State after any step, equal wherever it comes from, and where two differ."""

import json
import os
import subprocess
import unittest

import h5py
import program
from program import calot, short, skilled

MATRIX = os.environ.get("CALOT_MATRIX") or ""


class States(program.ProgramTest):
    def state(self, name, recording, step, *more):
        self.well("state", recording, "--step", step, "-o", self.path(name), *more)
        return self.path(name)

    def test_equal(self):
        a, b = self.state("a.h5", skilled(), 250), self.state("b.h5", skilled(), 250)
        self.assertRegex(self.well("diff", a, b).out, r"^equal: \d+ fields of step 250\n$")
        self.assertEqual(json.loads(self.well("diff", "--json", a, b).out), {"schema": "calot-diff", "version": 1, "equal": True})

    def test_from_a_keyframe_as_from_the_start(self):
        # A step after the last keyframe, reached from it; and in a recording that ends before the first keyframe, from the start.
        beginning = program.recording("beginning", "--performer", "skilled", "--seed", 7, "--seconds", 2.3)
        with h5py.File(skilled(), "r") as file:
            frames = file["/keyframes/index"]["step"]
        self.assertIn(199, frames)
        for step in (0, 98, 99, 100, 199, 225):
            with self.subTest(step=step):
                a, b = self.state("a.h5", skilled(), step, "--force"), self.state("b.h5", beginning, step, "--force")
                self.well("diff", a, b)

    def test_different(self):
        a, b = self.state("a.h5", skilled(), 250), self.state("b.h5", skilled(), 251)
        answer = calot("diff", a, b)
        self.assertEqual(answer.code, 3, answer)
        self.assertEqual(answer.err, "")
        self.assertIn("the first is of step 250, the second of step 251", answer.out)

    def test_field_index_and_values(self):
        a = self.state("a.h5", skilled(), 250)
        b = self.copy(a, "b.h5")
        with h5py.File(b, "r+") as file:
            places = []
            file.visititems(lambda name, thing: places.append(name) if name.endswith("organ.liver/position") else None)
            self.assertEqual(len(places), 1)
            was = float(file[places[0]][17])
            file[places[0]][17] = 0.25
        answer = calot("diff", a, b)
        self.assertEqual(answer.code, 3, answer)
        field, rest = answer.out.strip().split(" index ")
        self.assertEqual(field, "organ.liver/position")
        index, values = rest.split(": ")
        first, second = values.split(" and ")
        self.assertEqual((int(index), float(first), float(second)), (17, was, 0.25))
        said = json.loads(calot("diff", "--json", a, b).out)
        self.assertEqual((said["equal"], said["field"], said["index"]), (False, field, 17))

    def test_last_step_and_beyond(self):
        self.state("a.h5", short(), 49)
        self.refused(2, "state", short(), "--step", 50, "-o", self.path("b.h5"), names=(short(), "0 to 49"))

    @unittest.skipUnless(MATRIX and os.path.exists(MATRIX), "the matrix program is not built")
    def test_flat_goes_on_as_recorded(self):
        flat = self.state("f", skilled(), 100, "--flat")
        done = subprocess.run([MATRIX, flat], capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual(len(lines), 201)
        # The same attempt as a golden recording, which has the digests of components.
        golden = self.path("golden.h5")
        self.well("record", "--scene", program.SCENE, "--performer", "skilled", "--seed", 7, "--seconds", 5, "--purpose", "golden", "-o", golden)
        with h5py.File(golden, "r") as file:
            digests = file["/steps/component_digest"][101:301]
        for line, digest in zip(lines[1:], digests):
            words = line.split()
            self.assertEqual(words[3:], [f"{d:016x}" for d in digest], line)


if __name__ == "__main__":
    program.main()
