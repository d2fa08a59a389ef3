#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An endoscope that moves: recorded, replayed bit for bit, graded; the default stays as it was."""

import json
import math

import program
import h5py  # after the program, which says where it is missing
import numpy as np
from program import SCENE, ProgramTest, recording


def moving():
    """Two seconds of a performer whose assistant holds an angled endoscope."""
    return recording("scope", "--performer", "unskilled", "--seed", 3, "--seconds", 2, "--scope", 30)


def fixed():
    return recording("fixed", "--performer", "unskilled", "--seed", 3, "--seconds", 2)


def script(positions, rate=100):
    """The right hand of a device at these places, for a scope that is held by it."""
    samples = [[round(i / rate, 6), 1, *p, 1.0, 0.0, 0.0, 0.0, 0.0, 0, 1] for i, p in enumerate(positions)]
    return json.dumps({"format": "calot-device-script", "formatVersion": 1, "name": "test", "rate": rate, "samples": samples})


def camera(path):
    with h5py.File(path, "r") as file:
        return file["camera/position"][:], file["camera/orientation"][:]


class Scope(ProgramTest):
    def test_the_hands_and_the_tissue_are_the_same_whatever_it_does(self):
        with h5py.File(moving(), "r") as a, h5py.File(fixed(), "r") as b:
            for hand in ("left", "right"):
                for name in ("position", "orientation", "force"):
                    np.testing.assert_array_equal(a[f"ticks/{hand}/{name}"][:], b[f"ticks/{hand}/{name}"][:])
            np.testing.assert_array_equal(a["observables/organs/volume"][:], b["observables/organs/volume"][:])
        position, orientation = camera(fixed())
        self.assertEqual(len(np.unique(position, axis=0)), 1, "a camera that nobody holds is fixed")
        self.assertEqual(len(np.unique(orientation, axis=0)), 1)

    def test_the_shaft_stays_in_its_port(self):
        position, orientation = camera(moving())
        self.assertGreater(len(np.unique(orientation, axis=0)), 100)
        at, q = camera(fixed())[0][0], camera(fixed())[1][0]
        w, x, y, z = q / np.linalg.norm(q)
        port = at - 0.08 * np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
        shaft = position - port
        shaft /= np.linalg.norm(shaft, axis=1)[:, None]
        w, x, y, z = (orientation / np.linalg.norm(orientation, axis=1)[:, None]).T
        view = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
        angle = np.degrees(np.arccos(np.clip((shaft * view).sum(axis=1), -1, 1)))
        self.assertLess(np.abs(angle - 30).max(), 0.02, "the optic's angle, from a port that does not move")

    def test_replays_bit_for_bit(self):
        self.assertIn("bit-exact", self.well("replay", moving()).out)

    def test_is_graded(self):
        out = self.well("assess", moving(), "--cohort", self.path("c.db")).out
        self.assertRegex(out, r"camera-horizon +[0-9.]+ +deg")
        self.assertRegex(out, r"camera-path-length +[0-9.]+ +mm")
        out = self.well("assess", fixed(), "--cohort", self.path("d.db")).out
        self.assertRegex(out, r"camera-horizon .*not applicable: the camera did not move")
        self.assertRegex(out, r"tip-out-of-view left +[0-9.]+ +s")

    def test_a_device_holds_it(self):
        # At rest for 0.2 s, then 20 mm to the right within 0.2 s: 0.14 rad.
        self.path("scope.json").write_text(script([(0.001 * min(20, max(0, i - 20)), 0.0, 0.0) for i in range(300)]))
        self.well("record", "--scene", SCENE, "--device", "null", "--seconds", 2, "--scope", 0, "--scope-device",
                  f"scripted:{self.path('scope.json')}", "-o", self.path("a.h5"))
        position, orientation = camera(self.path("a.h5"))
        self.assertLess(np.linalg.norm(position[150] - position[0]), 2e-6, "no motion before the device moves")
        chord = np.linalg.norm(position[-1] - position[0])
        self.assertAlmostEqual(chord, 2 * 0.08 * math.sin(0.5 * 0.14), delta=5e-5)
        self.assertIn("bit-exact", self.well("replay", self.path("a.h5")).out)

    def test_a_branch_sets_out_from_where_the_endoscope_stood(self):
        self.well("branch", moving(), "--at", "1.5", "--performer", "unskilled", "--scope", 30, "--seconds", 0.3, "-o",
                  self.path("b.h5"))
        position, _ = camera(self.path("b.h5"))
        step = np.linalg.norm(np.diff(position, axis=0), axis=1)
        self.assertLess(step.max(), 2e-4, "no jump, at the fork neither")
        self.assertIn("bit-exact", self.well("replay", self.path("b.h5")).out)

    def test_refusals(self):
        common = ("record", "--scene", SCENE, "--performer", "skilled", "-o", self.path("x.h5"))
        self.refused(2, *common, "--scope", 120, names=["--scope"])
        self.refused(2, *common, "--scope-device", "null", names=["--scope-device", "fixed"])
        self.refused(2, *common, "--scope", 30, "--scope-device", "left=null,right=null", names=["--scope-device", "one device"])
        self.refused(2, *common, "--scope", 30, "--scope-device", "sextant", names=["sextant"])
        self.assertFalse(self.path("x.h5").exists())


if __name__ == "__main__":
    program.main()
