#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Printed handles before cameras, in films: sheets, calibration, a recording that replays and is assessed, what is refused."""

import json
import os
import re
import shutil
import subprocess
import sys
import unittest

import program
import h5py  # after the program, which says where it is missing
from program import SCENE, ProgramTest

FILMS = os.environ.get("CALOT_CAMERA_FILMS")
PHASES = "rest=0:1,pivot=1:3,stroke right=3:4,stroke down=4:5,stroke away=5:6,trocar=6:8"


class Sheets(ProgramTest):
    def test_the_sheets_are_true_to_scale(self):
        out = self.path("handles.pdf")
        answer = program.calot("devices", "print", "-o", out)
        if answer.code == 1 and "lib/calot/" in answer.err:
            self.skipTest("a build without Qt, or without devices")
        self.assertEqual(answer.code, 0, answer)
        self.refused(2, "devices", "print", "-o", out)
        if shutil.which("gs") is None:
            self.skipTest("gs (package ghostscript) is not installed")
        # 254 dots an inch: ten a millimetre.
        subprocess.run(["gs", "-q", "-dBATCH", "-dNOPAUSE", "-sDEVICE=pgmraw", "-r254", f"-sOutputFile={self.path('page%d.pgm')}", str(out)],
                       check=True, timeout=120)
        pages = sorted(out.parent.glob("page*.pgm"))
        self.assertEqual(len(pages), 3)

        def dark(page, y, left=0, right=None):
            """Runs of dark dots of a row: (begin, end)."""
            data = page.read_bytes()
            header = re.match(rb"P5\s+(?:#[^\n]*\n)?(\d+)\s+(\d+)\s+255\s", data)
            width = int(header.group(1))
            row = data[header.end() + y * width:header.end() + (y + 1) * width][left:right]
            return [(m.start() + left, m.end() + left) for m in re.finditer(rb"[\x00-\x7f]+", row)]

        def extent(page):
            return tuple(map(int, re.match(rb"P5\s+(?:#[^\n]*\n)?(\d+)\s+(\d+)", page.read_bytes()).groups()))

        self.assertLessEqual(abs(extent(pages[0])[0] - 2100), 2)
        self.assertLessEqual(abs(extent(pages[2])[0] - 2970), 2)
        # The board's ruler, at 197 mm from above: its long marks, at 0, 50 and 100 mm.
        marks = dark(pages[2], 1930, 0, 1500)
        self.assertEqual(len(marks), 3, marks)
        self.assertLessEqual(abs(marks[2][0] - marks[0][0] - 1000), 1, marks)
        # First tag of the handle, upper border: black over 28 mm, 32 to 60 mm from the left, from 84 mm from above.
        border = max(dark(pages[0], 850, 250, 650), key=lambda run: run[1] - run[0])
        self.assertLessEqual(abs(border[0] - 320), 2, border)
        self.assertLessEqual(abs(border[1] - 600), 2, border)


@unittest.skipUnless(FILMS, "CALOT_CAMERA_FILMS names no program that makes films")
class Films(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made = program.tempfile.mkdtemp(prefix="calot-films-")
        subprocess.run([FILMS, cls.made], check=True, timeout=program.PATIENCE)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.made)
        super().tearDownClass()

    def film(self, name):
        return os.path.join(self.made, name + ".y4m")

    def both(self, name):
        return f"{self.film(name + '1')},{self.film(name + '2')}"

    def test_calibrated_recorded_replayed_and_assessed(self):
        calibration = self.path("pair.json")
        answer = self.well("devices", "calibrate", "camera:" + self.both("steps"), "--board", self.both("board"), "--phases", PHASES,
                           "--pictures", self.path("."), "-o", calibration)
        self.assertIn("passed", answer.out)
        for number in (1, 2):
            self.assertEqual(self.path(f"camera-{number}.png").read_bytes()[:4], b"\x89PNG")
        measured = json.loads(calibration.read_text())
        self.assertEqual(measured["device"], "camera")
        self.assertTrue(measured["passed"])
        first, second = measured["camera"]["cameras"]
        self.assertAlmostEqual(first["focal"][0], 457.0, delta=4.0)
        self.assertAlmostEqual(second["focal"][0], 452.5, delta=4.0)
        baseline = sum(x * x for x in second["position"]) ** 0.5
        self.assertAlmostEqual(baseline, 0.25, delta=0.005)
        for hand in ("left", "right"):
            self.assertAlmostEqual(measured["hands"][hand]["tipOffset"][2], 0.12, delta=0.003)
            self.assertAlmostEqual(measured["hands"][hand]["scale"], 1.0, delta=0.02)
            self.assertLess(measured["camera"]["trocars"][hand]["residual"], 0.002)

        recording = self.path("r.h5")
        film = "camera:" + self.both("hands")
        answer = self.well("record", "--scene", SCENE, "--device", film, "--calibration", calibration, "--mode", "assessment", "--seconds", 1.5,
                           "-o", recording)
        self.assertIn("exact", self.well("replay", recording).out)
        with h5py.File(recording, "r") as file:
            self.assertEqual(file.attrs["device"].rstrip(b"\0"), b"camera")
            self.assertIn(b'"camera":{"printScale"', file.attrs["calibration"])
            for hand in ("left", "right"):
                samples = file[f"/device/{hand}/samples"][:]
                self.assertGreater(samples["valid"].mean(), 0.8)
                self.assertGreater(file[f"/ticks/{hand}/valid"][:].mean(), 0.8)
        again = self.path("again.h5")
        self.well("record", "--scene", SCENE, "--device", film, "--calibration", calibration, "--mode", "assessment", "--seconds", 1.5,
                  "-o", again)
        with h5py.File(recording, "r") as a, h5py.File(again, "r") as b:
            for hand in ("left", "right"):
                self.assertEqual(a[f"/ticks/{hand}/position"][:].tobytes(), b[f"/ticks/{hand}/position"][:].tobytes())
        (row,) = json.loads(self.well("assess", "--json", recording, "--cohort", self.path("c.db")).out)["recordings"]
        self.assertEqual(row["stored"], "added")

        # Outside its bounds: practice alone.
        measured["camera"]["cameras"][0]["residual"] = 5.0
        measured["passed"] = False
        bad = self.path("bad.json")
        bad.write_text(json.dumps(measured))
        self.refused(3, "record", "--scene", SCENE, "--device", film, "--calibration", bad, "--mode", "assessment", "-o", self.path("x.h5"),
                     names=("lens residual",))
        self.refused(2, "record", "--scene", SCENE, "--device", "camera:" + self.film("hands1"), "--calibration", calibration, "-o", self.path("x.h5"),
                     names=("1 cameras",))

    def test_what_is_refused(self):
        out = self.path("c.json")
        self.refused(2, "record", "--scene", SCENE, "--device", "camera:" + self.film("hands1"), "-o", self.path("x.h5"), names=("calibration",))
        self.refused(2, "devices", "calibrate", "camera:" + self.film("steps1"), "-o", out, names=("--board",))
        self.refused(2, "devices", "calibrate", "camera:paced," + self.film("steps1"), "--board", self.film("board1"), "-o", out, names=("paced",))
        self.refused(4, "devices", "calibrate", "camera:" + self.film("steps1"), "--board", self.film("none"), "-o", out, names=("none.y4m",))
        self.refused(4, "devices", "calibrate", "camera:" + self.film("steps1"), "--board", self.film("hands1"), "-o", out,
                     names=("0 different views",))
        self.refused(2, "devices", "calibrate", "camera:" + self.film("steps1"), "--board", self.film("board1"), "--phases", "rest=1",
                     "-o", out, names=("phases",))
        self.assertFalse(out.exists())


if __name__ == "__main__":
    sys.exit(unittest.main())
