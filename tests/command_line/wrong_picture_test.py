# SPDX-License-Identifier: GPL-3.0-or-later
"""Never a wrong picture: what re-simulation does not repeat is shown by nothing, or with a mark in every picture."""

import h5py
import numpy as np
import program
import recording_file
from program import calot, short, skilled
from render_test import pixels

FAR = 999  # a simulation version that nobody keeps


def amber(path):
    """How many pixels of a picture have the colour of the mark."""
    red, green, blue = (pixels(path).astype(int)[:, :, i] for i in range(3))
    return int(((red > 200) & (green > 140) & (green < 215) & (blue < 120)).sum())


class NeverAWrongPicture(program.ProgramTest):
    def of_another_version(self, original=None):
        r = self.copy(original or skilled())
        recording_file.set_attribute(r, "simulation_version", FAR)
        return r

    def test_another_version_is_refused(self):
        r = self.of_another_version()
        film, picture = self.path("o.mp4"), self.path("o.png")
        for command in (("render", r, "-o", picture), ("render", r, "-o", film, "--size", "64x48"), ("render", skilled(), "--beside", r, "-o", picture),
                        ("state", r, "--step", 3, "-o", self.path("s.h5"))):
            with self.subTest(" ".join(map(str, command))):
                self.refused(5, *command, names=(r, FAR, "--anyway"))
        self.assertEqual([p.name for p in self.folder.iterdir()], ["r.h5"])
        self.refused(5, "replay", r, names=(r, FAR))
        self.refused(5, "branch", r, "--at", 1, "--performer", "skilled", "--seconds", 0.1, "-o", self.path("b.h5"), names=(r, FAR))

    def test_anyway_has_a_mark_in_every_picture(self):
        r = self.of_another_version()
        for time in (0, 2, 5):
            with self.subTest(time=time):
                self.well("render", skilled(), "--at", time, "--size", "320x180", "--quality", "interactive", "-o", self.path("own.png"), "--force")
                self.well("render", r, "--anyway", "--at", time, "--size", "320x180", "--quality", "interactive", "-o", self.path("marked.png"), "--force")
                self.assertGreater(amber(self.path("marked.png")), amber(self.path("own.png")) + 60)
        # However small it is, and beside one that needs none.
        self.well("render", r, "--anyway", "--size", "64x48", "-o", self.path("small.png"))
        self.well("render", skilled(), "--size", "64x48", "-o", self.path("small-own.png"))
        self.assertFalse(np.array_equal(pixels(self.path("small.png")), pixels(self.path("small-own.png"))))
        self.well("render", skilled(), "--beside", r, "--anyway", "--size", "640x180", "-o", self.path("two.png"))
        self.assertGreater(amber(self.path("two.png")), 60)
        answer = calot("state", r, "--anyway", "--step", 3, "-o", self.path("s.h5"))
        self.assertEqual(answer.code, 0, answer)
        self.assertOneLine(answer, "warning", r, FAR)

    def test_films_are_marked(self):
        r = self.of_another_version(short())
        self.well("render", short(), "-o", self.path("own.mp4"), "--size", "64x48")
        self.well("render", r, "--anyway", "-o", self.path("marked.mp4"), "--size", "64x48")
        self.assertNotEqual(self.path("own.mp4").read_bytes(), self.path("marked.mp4").read_bytes())

    def test_a_changed_recording(self):
        r = self.copy(skilled())
        with h5py.File(r, "r+") as file:
            file["/ticks/right/position"][1239, 2] += 2e-5
        picture = self.path("o.png")
        self.refused(3, "render", r, "--at", 2, "-o", picture, names=(r, "chain", "--anyway"))
        # Whoever makes the chain fit is found out by what is simulated: from the step that differs on, up to the next keyframe.
        with h5py.File(r, "r+") as file:
            recording_file.reseal(file)
            frames = file["/keyframes/index"]["step"]
        after = int(frames[frames > 123][0])
        self.well("render", r, "--at", 1.1, "--size", "64x48", "-o", picture)
        at = min(1.3, after / 100 - 0.02)
        self.refused(3, "render", r, "--at", at, "-o", self.path("p.png"), names=(r, "step 123", "--anyway"))
        self.refused(3, "render", r, "--from", 1, "--to", at, "-o", self.path("p.mp4"), "--size", "64x48", names=(r, "step 123"))
        self.assertFalse(self.path("p.mp4").exists())
        self.well("render", r, "--at", at, "--anyway", "-o", self.path("p.png"), "--size", "320x180", "--quality", "interactive")
        self.assertGreater(amber(self.path("p.png")), 100)


if __name__ == "__main__":
    program.main()
