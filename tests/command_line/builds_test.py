# SPDX-License-Identifier: GPL-3.0-or-later
"""Another build of the same version (CALOT_OTHER: debug, clang, ...) agrees with this one, bit for bit."""

import os
import unittest

import h5py
import program
from program import SCENE, calot, skilled

OTHER = os.environ.get("CALOT_OTHER") or ""


@unittest.skipUnless(OTHER, "CALOT_OTHER names no other build's calot")
class Builds(program.ProgramTest):
    def test_each_replays_the_other(self):
        answer = calot("replay", skilled(), program=OTHER)
        self.assertEqual(answer.code, 0, answer)
        r = self.path("r.h5")
        answer = calot("record", "--scene", SCENE, "--performer", "skilled", "--seed", 7, "--seconds", 2, "-o", r, program=OTHER)
        self.assertEqual(answer.code, 0, answer)
        self.well("replay", r)
        with h5py.File(skilled(), "r") as a, h5py.File(r, "r") as b:
            self.assertNotEqual(a.attrs["build"], b.attrs["build"], "the same build twice proves nothing")
            self.assertEqual(a["/steps/state_digest"][:200].tobytes(), b["/steps/state_digest"][:].tobytes())

    def test_states_are_equal(self):
        for name, calot_of in (("a", program.PROGRAM), ("b", OTHER)):
            self.assertEqual(calot("state", skilled(), "--step", 99 + 50, "-o", self.path(name), program=calot_of).code, 0)
        self.well("diff", self.path("a"), self.path("b"))


if __name__ == "__main__":
    program.main()
