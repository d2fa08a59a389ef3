#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""calot-trainer before its window: wrong options, scenes and devices are one line and the right exit code; and a run by a script from start to end."""

import os
import re
import shutil
import signal
import subprocess
import time
import unittest

import program
from program import SCENE, ProgramTest

TRAINER = program.PROGRAM.with_name("calot-trainer")
OFFSCREEN = {"QT_QPA_PLATFORM": "offscreen", "LC_ALL": "C.UTF-8"}


def trainer(*arguments):
    return program.calot(*arguments, program=TRAINER, environment=OFFSCREEN)


class Trainer(ProgramTest):
    def declined(self, code, *arguments):
        answer = trainer(*arguments)
        self.assertEqual(answer.code, code, answer)
        lines = answer.err.splitlines()
        self.assertEqual(len(lines), 1, answer)
        self.assertTrue(lines[0].startswith("calot-trainer: "), answer)
        self.assertEqual(answer.out, "", answer)
        self.assertEqual(list(self.folder.glob("*.h5")), [], "something was recorded")
        return lines[0]

    def test_wrong_use(self):
        out = ("-o", self.folder)
        self.assertIn(SCENE, self.declined(2, "--scene", "no-such-scene", *out))
        self.assertIn("joystick", self.declined(2, "--scene", SCENE, "--device", "joystick", *out))
        self.assertIn("joystick", self.declined(2, "--device", "joystick", *out))
        self.assertIn("--calibration", self.declined(2, "--scene", SCENE, "--device", "null", "--mode", "assessment", *out))
        self.assertIn("calibrate mouse --pixel", self.declined(2, "--scene", SCENE, "--mode", "assessment", *out))
        self.assertIn("/nowhere", self.declined(2, "--scene", SCENE, "-o", "/nowhere"))
        self.declined(2, "--scene", SCENE, "--mode", "play", *out)
        self.declined(2, "--device", "null", "--performer", "skilled", *out)
        for seconds in ("0", "-1", "nan", "inf", "1x", ""):
            self.assertIn("--seconds", self.declined(2, "--scene", SCENE, "--seconds", seconds, *out))
        self.declined(2, "--scene", SCENE, "--pictures", self.folder / "missing", *out)
        for size in ("1366", "10x10", "1366x768x2", "axb"):
            self.assertIn("--size", self.declined(2, "--scene", SCENE, "--size", size, *out))
        self.assertIn("--type", self.declined(2, "--scene", SCENE, "--type", "50", *out))
        self.assertIn("--colours", self.declined(2, "--scene", SCENE, "--colours", "pink", *out))
        self.assertIn("/nowhere", self.declined(2, "--scene", SCENE, "--cohort", "/nowhere/c.db", *out))
        # Nobody makes files there, not even an administrator.
        self.assertIn("/proc", self.declined(1, "--scene", SCENE, "-o", "/proc"))
        self.declined(2, "--no-such-option")

    def test_a_screen_that_is_not_there(self):
        answer = program.calot("-o", self.folder, program=TRAINER, environment={"QT_QPA_PLATFORM": "xcb", "DISPLAY": ":77"})
        self.assertEqual((answer.code, answer.out), (1, ""), answer)
        self.assertRegex(answer.err, r"^calot-trainer: .*screen.*:77\n$")

    def test_damaged_input(self):
        scene = self.folder / "bad.json"
        scene.write_text('{"format": "calot-scene"')
        self.assertIn("bad.json", self.declined(4, "--scene", scene, "-o", self.folder))
        cohort = self.folder / "no.db"
        cohort.write_text("not a database")
        self.assertIn("no.db", self.declined(4, "--scene", SCENE, "--cohort", cohort, "-o", self.folder))
        script = self.folder / "script.json"
        script.write_text("[]")
        self.assertIn("script.json", self.declined(4, "--scene", SCENE, "--device", f"scripted:{script}", "-o", self.folder))

    def test_the_command_line_says_where_the_mouse_is(self):
        answer = program.calot("record", "--scene", SCENE, "--device", "mouse", "-o", self.folder / "a.h5")
        self.assertEqual(answer.code, 2, answer)
        self.assertIn("calot-trainer", answer.err)

    def test_it_ends_by_itself_after_so_many_seconds(self):
        answer = trainer("--scene", SCENE, "--performer", "skilled", "--seconds", "0.5", "--cohort", self.folder / "c.db", "--colours", "dark",
                         "--type", "150", "--size", "1366x768", "-o", self.folder)
        self.assertEqual(answer.code, 0, answer)
        [file] = self.folder.glob("*.h5")
        seconds = float(re.search(r", (\d+\.\d+) s, stopped$", answer.out, re.MULTILINE).group(1))
        self.assertGreaterEqual(seconds, 0.5)
        self.assertRegex(answer.out, r"forces late \(\d+\.\d+ %\), at most by")
        self.well("replay", file)
        self.assertFalse((self.folder / "c.db").exists(), "a cohort is made when something is put into it")

    def test_a_signal_ends_it_and_the_recording_is_whole(self):
        running = subprocess.Popen([str(TRAINER), "--scene", SCENE, "--device", "null", "-o", str(self.folder)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   env={**os.environ, **OFFSCREEN}, text=True)
        try:
            limit = time.monotonic() + program.PATIENCE
            sizes = set()  # the second one is that of a recording with steps
            while len(sizes) < 2 and time.monotonic() < limit:
                sizes.update(file.stat().st_size for file in self.folder.glob("*.h5"))
                time.sleep(0.05)
            running.send_signal(signal.SIGTERM)
            out, err = running.communicate(timeout=program.PATIENCE)
        finally:
            running.kill()
        self.assertEqual(running.returncode, 0, err)
        self.assertNotIn("calot-trainer: ", err)  # Qt itself has remarks on a platform without a screen
        [file] = self.folder.glob("*.h5")
        self.assertTrue(out.startswith(f"{file}: attempt "), out)
        self.assertIn(", stopped\n", out)
        self.assertRegex(file.name, rf"^{SCENE}-\d{{8}}T\d{{6}}Z\.h5$")
        self.well("replay", file)

    @unittest.skipUnless(shutil.which("Xvfb"), "no Xvfb")
    def test_a_display_that_goes_away_ends_it_and_the_recording_is_whole(self):
        number, told = os.pipe()
        screen = subprocess.Popen(["Xvfb", "-displayfd", str(told)], pass_fds=[told], stderr=subprocess.DEVNULL)
        running = None
        try:
            os.close(told)
            with os.fdopen(number) as line:
                display = ":" + line.readline().strip()
            running = subprocess.Popen([str(TRAINER), "--scene", SCENE, "--device", "null", "-o", str(self.folder)], stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, env={**os.environ, "DISPLAY": display, "QT_QPA_PLATFORM": "xcb"}, text=True)
            limit = time.monotonic() + program.PATIENCE
            sizes = set()  # the second one is that of a recording with steps
            while len(sizes) < 2 and time.monotonic() < limit:
                sizes.update(file.stat().st_size for file in self.folder.glob("*.h5"))
                time.sleep(0.05)
            screen.kill()
            out, err = running.communicate(timeout=program.PATIENCE)
        finally:
            screen.kill()
            screen.wait()
            if running:
                running.kill()
        self.assertEqual(running.returncode, 1, err)
        self.assertIn("calot-trainer: the display is gone", err)
        [file] = self.folder.glob("*.h5")
        self.assertTrue(out.startswith(f"{file}: attempt "), out)
        self.well("replay", file)


if __name__ == "__main__":
    program.main()
