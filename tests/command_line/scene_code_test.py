# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene runs no code of what it does not have: neither its memory nor its time know that fat exists. Which functions
run is read off a profile, so that nothing depends on how fast the machine is."""

import os
import re
import shutil
import sys
import unittest

import program

# Functions of what only such a part of a scene needs; as a template's argument (of std::variant, say) a class does not count.
PARTS = {
    "fat": r"fn=\(\d+\) calot::(?:FatBody|FatMotion|FatModel|CarvedField|CarvedSurface|CarvedContact|CubeMotion|Islands|"
    r"AdaptiveSurface|HexahedralElements|closestPointTransform)\b",
    "vessels": r"fn=\(\d+\) calot::(?:BeamModel|BeamSolver|BlockTree|TubeSurface|TubeSkin|VesselBody|TieCoupling)\b",
    "connective": r"fn=\(\d+\) calot::(?:ConnectiveBed|ConnectiveTissue)\b",
}


class SceneCode(program.ProgramTest):
    def parts_run_in(self, scene, seconds):
        profile = self.folder / f"{scene}.profile"
        recording = self.folder / f"{scene}.h5"
        answer = program.calot(
            "--tool=callgrind", "--quiet", f"--callgrind-out-file={profile}", program.PROGRAM, "record", "--scene", scene,
            "--performer", "skilled", "--seed", 1, "--seconds", seconds, "-o", recording, program="valgrind")  # fmt: skip
        self.assertEqual(answer.code, 0, answer)
        text = profile.read_text()
        profile.unlink()
        self.assertIn("calot::Stepper::step", text, "functions have names in the profile")
        return {part for part, pattern in PARTS.items() if re.search(pattern, text)}

    def test_organs_alone(self):
        self.assertEqual(self.parts_run_in("touch-liver", "0.05"), set())

    def test_a_bed_has_no_fat_and_no_vessels(self):
        self.assertEqual(self.parts_run_in("dissect-bed", "0.03"), {"connective"})

    @unittest.skipUnless(program.HEAVY, "long: a scene with vessels under a profiler")
    def test_vessels_are_found_where_they_are(self):
        self.assertEqual(self.parts_run_in("clip-and-cut", "0.03"), {"vessels"})


if __name__ == "__main__":
    if shutil.which("valgrind") is None:
        print("valgrind is not installed", file=sys.stderr)
        sys.exit(77)
    if os.environ.get("CALOT_BUILD_TYPE", "Release") != "Release":
        print("only a release build is profiled")
        sys.exit(77)
    program.main()
