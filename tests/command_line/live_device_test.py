# SPDX-License-Identifier: GPL-3.0-or-later
"""Devices that live in real time: an OpenIGTLink server over loopback drives record --live and branch, goes in mid-run and comes back;
what it sent is in the recording; and a person is guided through a calibration on a terminal."""

import json
import math
import os
import pty
import re
import select
import signal
import subprocess
import time
import unittest

import h5py
import program
from devices_test import Server, moving, script, whole_stream
from program import MOTION, PROGRAM, SCENE, ProgramTest

HANDS = ("left", "right")


def rows_of_motion(path):
    """Positions of both hands, row by row: the motion files' patient-side manipulators (columns 39 to 41 and 58 to 60, m)."""
    with open(path, encoding="utf-8") as file:
        numbers = [[float(x) for x in line.split()] for line in file if line.strip()]
    return {"left": [row[38:41] for row in numbers], "right": [row[57:60] for row in numbers]}


class LiveDevice(ProgramTest):
    def served(self, name, seconds=30):
        """A motion to serve; its positions by hand, row by row."""
        samples = moving(seconds, (0, 1))
        self.path(name).write_text(script(samples), encoding="utf-8")
        return self.path(name), {hand: [s[2:5] for s in samples if s[1] == h] for h, hand in enumerate(HANDS)}

    def exact(self, name):
        for threads in (1, 2):
            self.assertIn(": bit-exact, ", self.well("replay", "--threads", threads, self.path(name)).out)

    def start(self, name, port, *more):
        """A run that goes on by itself; returns when there is a recording."""
        process = subprocess.Popen([str(PROGRAM), "record", "--scene", SCENE, "--device", f"openigtlink:127.0.0.1:{port}", "--live", "--json",
                                    *map(str, more), "-o", str(self.path(name))],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        self.until(lambda: self.path(name).exists() or process.poll() is not None)
        self.assertIsNone(process.poll(), "nothing is recorded")
        return process

    def until(self, done):
        end = time.monotonic() + 60
        while not done():
            self.assertLess(time.monotonic(), end, "nothing happens")
            time.sleep(0.01)

    def ticks(self, name):
        with h5py.File(self.path(name), "r", libver="latest", swmr=True) as file:
            return int(file["/status"][-1]["ticks"])

    def raw(self, name, hand):
        with h5py.File(self.path(name), "r") as file:
            counts = file["/device/counts"][len(file["/status"]) - 1]
            self.assertEqual(counts[f"{hand}_dropped"], 0)
            return file[f"/device/{hand}/samples"][:counts[hand]]

    def assertIsWhatWasSent(self, name, sent, first_tick=0):
        """Every row of the motion from the first recorded to the last, none left out, none twice; mapped where a tick used it."""
        for hand in HANDS:
            raw = self.raw(name, hand)
            self.assertGreater(len(raw), 10)
            # Each client is sent the motion from its first row on: the number of a sample is the number of its row.
            self.assertEqual(list(raw["sequence"]), list(range(int(raw["sequence"][0]), int(raw["sequence"][0]) + len(raw))))
            for sample in raw[raw["sequence"] < len(sent[hand])]:
                for a, b in zip(sample["position"], sent[hand][sample["sequence"]]):
                    self.assertAlmostEqual(a, b, 7)  # float32 millimetres on the way
            self.assertTrue((raw["tick"][1:] >= raw["tick"][:-1]).all() and raw["tick"][0] >= first_tick)
            self.assertTrue((raw["host_time"][1:] >= raw["host_time"][:-1]).all())
            self.assertTrue(raw["valid"].all() and (raw["device_time"] > 0).all())
            self.assertGreater(raw["used"].sum(), 0)
            with h5py.File(self.path(name), "r") as file:
                position = file[f"/ticks/{hand}/position"][:]
            used = set(raw["tick"][raw["used"] == 1].tolist())
            for tick in range(first_tick + 1, len(position)):
                if tick not in used and not first_tick:
                    self.assertEqual(position[tick].tobytes(), position[tick - 1].tobytes(), f"tick {tick} moved by itself")
        inspected = json.loads(self.well("inspect", "--json", self.path(name)).out)["device_samples"]
        for hand in HANDS:
            raw = self.raw(name, hand)
            self.assertEqual((inspected[hand]["samples"], inspected[hand]["dropped"], inspected[hand]["missing"]), (len(raw), 0, 0))
            self.assertAlmostEqual(inspected[hand]["rate_hz"], (len(raw) - 1) / (1e-9 * float(raw["host_time"][-1] - raw["host_time"][0])), 3)

    def test_live_by_a_server(self):
        motion, sent = self.served("motion.json")
        with Server("--kinematics", motion) as server:
            said = json.loads(self.well("record", "--scene", SCENE, "--device", f"openigtlink:127.0.0.1:{server.port}", "--live", "--json",
                                        "--seconds", 3, "-o", self.path("r.h5")).out)
        self.assertEqual((said["outcome"], said["steps"], said["force_disagreements"]), ("stopped", 300, 0))
        self.exact("r.h5")
        self.assertIsWhatWasSent("r.h5", sent)
        text = self.well("inspect", self.path("r.h5")).out
        # The lines wrap.
        self.assertRegex(" ".join(text.split()), r" device, left \d+ \(\d+ valid, \d+ used by ticks, 0 dropped, 0 missing\), [\d.]+ a second, ")
        self.well("export", self.path("r.h5"), "--csv", self.path("csv"))
        for hand in HANDS:
            lines = self.path("csv").joinpath(f"device_{hand}.csv").read_text().splitlines()
            self.assertEqual(len(lines), 1 + len(self.raw("r.h5", hand)))

    @unittest.skipUnless(MOTION.is_file(), f"{MOTION} is not here")
    def test_live_by_real_motion(self):
        with Server("--kinematics", MOTION) as server:
            self.well("record", "--scene", SCENE, "--device", f"openigtlink:127.0.0.1:{server.port}", "--live",
                      "--seconds", 30 if program.HEAVY else 3, "-o", self.path("r.h5"))
        self.exact("r.h5")
        self.assertIsWhatWasSent("r.h5", rows_of_motion(MOTION))

    def test_branch_by_a_server(self):
        motion, sent = self.served("motion.json")
        parent = program.skilled()
        with Server("--kinematics", motion) as server:
            for name, more in (("live.h5", ("--live",)), ("paced.h5", ())):
                said = json.loads(self.well("branch", parent, "--at", 3.6, "--device", f"openigtlink:127.0.0.1:{server.port}", *more, "--json",
                                            "--seconds", 1.5, "-o", self.path(name)).out)
                self.assertEqual((said["outcome"], said["steps"]), ("stopped", 510))
        for name in ("live.h5", "paced.h5"):
            self.exact(name)
            self.assertIsWhatWasSent(name, sent, 3600)
            with h5py.File(parent, "r") as a, h5py.File(self.path(name), "r") as b:
                self.assertNotIn("device", a)
                self.assertEqual(b.attrs["operator_kind"].rstrip(b"\0"), b"human")
                self.assertEqual(b.attrs["fork_step"], 359)
                self.assertEqual(a["/ticks/right/position"][:3600].tobytes(), b["/ticks/right/position"][:3600].tobytes())

    def test_branch_by_a_script(self):
        self.path("s.json").write_text(script(moving(2, (0, 1))), encoding="utf-8")
        for name in ("a.h5", "b.h5"):
            self.well("branch", program.skilled(), "--at", 1, "--device", f"scripted:{self.path('s.json')}", "-o", self.path(name))
            self.exact(name)
        with h5py.File(self.path("a.h5"), "r") as a, h5py.File(self.path("b.h5"), "r") as b:
            self.assertEqual(a["/ticks/right/position"][:].tobytes(), b["/ticks/right/position"][:].tobytes())
            self.assertEqual(a["/device/right/samples"][0]["tick"], 1000)
            self.assertEqual(a["/device/right/samples"][:].tobytes(), b["/device/right/samples"][:].tobytes())
        self.well("branch", self.path("a.h5"), "--at", 1.5, "--performer", "skilled", "--seconds", 0.5, "-o", self.path("c.h5"))
        self.exact("c.h5")
        with h5py.File(self.path("c.h5"), "r") as file:
            self.assertNotIn("device", file)

    def test_unplugged_practice_pauses_and_goes_on(self):
        motion, sent = self.served("motion.json")
        with Server("--kinematics", motion) as server:
            process = self.start("r.h5", server.port)
            self.until(lambda: self.ticks("r.h5") >= 1000)
        # Nobody serves: the clock stands still.
        time.sleep(1.0)
        paused = self.ticks("r.h5")
        time.sleep(0.7)
        self.assertEqual(self.ticks("r.h5"), paused)
        self.assertIsNone(process.poll())
        with Server("--kinematics", motion, port=server.port):
            self.until(lambda: self.ticks("r.h5") >= paused + 1000)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=60)
        self.assertEqual((process.returncode, err), (0, ""))
        said = json.loads(out)
        self.assertEqual((said["outcome"], said["pauses"]), ("stopped", 1))
        self.assertGreater(said["paused_s"], 1.0)
        self.exact("r.h5")
        for hand in HANDS:
            raw = self.raw("r.h5", hand)
            # The driver counts on over the loss; the server began anew.
            self.assertEqual(list(raw["sequence"]), list(range(int(raw["sequence"][0]), int(raw["sequence"][0]) + len(raw))))
            silence = int((raw["host_time"][1:] - raw["host_time"][:-1]).argmax())
            self.assertGreater(raw["host_time"][silence + 1] - raw["host_time"][silence], 1_000_000_000)
            first = int(raw["sequence"][silence + 1])
            for sample in raw[silence + 1:]:
                for a, b in zip(sample["position"], sent[hand][int(sample["sequence"]) - first]):
                    self.assertAlmostEqual(a, b, 7)
            with h5py.File(self.path("r.h5"), "r") as file:
                position, valid = file[f"/ticks/{hand}/position"][:], file[f"/ticks/{hand}/valid"][:]
            # Nothing jumps, though the motion began anew 14 mm away. Ticks without measurement are held.
            steps = ((position[1:] - position[:-1]) ** 2).sum(axis=1) ** 0.5
            self.assertLess(steps.max(), 0.008)
            gone = (valid == 0).nonzero()[0]
            for tick in gone[gone > 0]:
                self.assertEqual(position[tick].tobytes(), position[tick - 1].tobytes())

    def test_unplugged_assessment_ends_as_technical_failure(self):
        motion, _ = self.served("motion.json")
        self.path("stream.json").write_text(whole_stream(), encoding="utf-8")
        with Server("--kinematics", motion) as server:
            self.well("devices", "calibrate", f"openigtlink:127.0.0.1:{server.port}", "--from", self.path("stream.json"), "-o", self.path("c.json"))
            process = self.start("r.h5", server.port, "--mode", "assessment", "--calibration", self.path("c.json"))
            self.until(lambda: self.ticks("r.h5") >= 500)
        out, err = process.communicate(timeout=60)
        self.assertEqual((process.returncode, err), (0, ""))
        said = json.loads(out)
        self.assertEqual((said["outcome"], said["pauses"]), ("technical failure", 0))
        self.assertIn("the server is gone", said["source_status"])
        self.exact("r.h5")
        with h5py.File(self.path("r.h5"), "r") as file:
            last = file["/status"][-1]
            self.assertEqual((last["completed"], last["outcome"], last["steps"]), (1, 5, said["steps"]))
        self.assertGreater(len(self.raw("r.h5", "left")), 0)

    def test_killed_in_mid_run(self):
        motion, sent = self.served("motion.json")
        with Server("--kinematics", motion) as server:
            process = self.start("r.h5", server.port)
            self.until(lambda: self.ticks("r.h5") >= 1000)
            process.send_signal(signal.SIGKILL)
            process.communicate()
        self.assertIn(": bit-exact, incomplete, ", self.well("replay", self.path("r.h5")).out)
        self.well("recover", self.path("r.h5"), "-o", self.path("o.h5"))
        self.exact("o.h5")
        self.assertIsWhatWasSent("o.h5", sent)


def guided_motion():
    """What a person does who is guided through the steps of 5, 20, 6, 6 and 6 seconds, up to two seconds ahead of the program."""
    tip = 0.2

    def tilted(around, by):
        w, x, y = math.cos(by / 2), math.cos(around) * math.sin(by / 2), math.sin(around) * math.sin(by / 2)
        axis = (2 * w * y, -2 * w * x, 1 - 2 * (x * x + y * y))  # R times the tip's axis
        return tuple(0.3 - tip * a for a in axis), (w, x, y, 0.0)

    def pose(t):
        p, q = tilted(0.0, 0.0)
        if 7.0 <= t < 24.0:
            return tilted(3.0 * t, 0.6 * math.sin(1.3 * (t - 7.0)) * min(1.0, 24.0 - t))
        way = [min(1.0, max(0.0, t - begin)) for begin in (27.5, 33.5, 39.5)]
        return tuple(a + 0.08 * s for a, s in zip(p, way)), q

    samples = []
    for i in range(50 * 60):
        p, q = pose(i / 50)
        samples += [[i / 50, hand, *p, *q, 0.0, 0, 1] for hand in (0, 1)]
    return script(samples)


class Guided(ProgramTest):
    """calot devices calibrate on a terminal, which this test plays the person at."""

    def begin(self, port, *more):
        ours, theirs = pty.openpty()
        self.addCleanup(os.close, ours)
        process = subprocess.Popen([str(PROGRAM), "devices", "calibrate", f"openigtlink:127.0.0.1:{port}", *map(str, more)],
                                   stdin=theirs, stdout=theirs, stderr=subprocess.PIPE, text=True)
        os.close(theirs)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        self.seen = ""
        return ours, process

    def read(self, terminal, words=None, patience=60):
        """Reads the terminal until it shows the words, or to its end. @returns what was read."""
        end, new = time.monotonic() + patience, ""
        while words is None or words not in new:
            self.assertLess(time.monotonic(), end, f"no {words} in {new!r}")
            if not select.select([terminal], [], [], 0.5)[0]:
                continue
            try:
                data = os.read(terminal, 65536)
            except OSError:  # the other end is closed
                data = b""
            if not data:
                self.assertIsNone(words, f"ended with {new!r}")
                break
            new += data.decode()
        self.seen += new
        return new

    def test_measures_what_the_person_did(self):
        self.path("motion.json").write_text(guided_motion(), encoding="utf-8")
        with Server("--kinematics", self.path("motion.json")) as server:
            terminal, process = self.begin(server.port, "--keep-stream", self.path("kept.json"), "-o", self.path("c.json"))
            for words in ("1. Put the tools down", "2. Hold each tool's tip", "100 mm to the right", "100 mm down", "100 mm away from you"):
                self.assertIn(words, self.read(terminal, "press Enter to begin: "))
                os.write(terminal, b"\n")
            said = self.read(terminal)
            process.wait(60)
        self.assertEqual((process.returncode, process.stderr.read()), (0, ""), self.seen)
        self.assertIn("passed; valid for 30 days", said)
        found = json.loads(self.path("c.json").read_text(encoding="utf-8"))
        self.assertTrue(found["passed"])
        for hand in HANDS:
            measured = found["hands"][hand]
            self.assertAlmostEqual(measured["scale"], 1.25, 3)
            for a, b in zip(measured["tipOffset"], (0.0, 0.0, 0.2)):
                self.assertAlmostEqual(a, b, 4)
        # What was kept is what was measured from.
        self.well("devices", "calibrate", f"openigtlink:127.0.0.1:{server.port}", "--from", self.path("kept.json"), "-o", self.path("d.json"))
        again = json.loads(self.path("d.json").read_text(encoding="utf-8"))
        for hand in HANDS:
            self.assertAlmostEqual(again["hands"][hand]["scale"], found["hands"][hand]["scale"], 9)

    def test_broken_off_writes_nothing(self):
        self.path("motion.json").write_text(script(moving(20, (0, 1))), encoding="utf-8")
        with Server("--kinematics", self.path("motion.json")) as server:
            for end in ("control-C", "control-D"):
                with self.subTest(end):
                    terminal, process = self.begin(server.port, "-o", self.path("c.json"))
                    self.read(terminal, "press Enter to begin: ")
                    if end == "control-D":
                        os.write(terminal, b"\x04")
                    else:
                        os.write(terminal, b"\n")
                        time.sleep(0.5)
                        process.send_signal(signal.SIGINT)
                    self.read(terminal)
                    self.assertEqual(process.wait(60), 1)
                    self.assertRegex(process.stderr.read(), r"^calot: calibrate: broken off\n$")
                    self.assertEqual([p.name for p in self.folder.iterdir()], ["motion.json"])

    def test_nobody_serves(self):
        terminal, process = self.begin(9, "-o", self.path("c.json"))
        self.read(terminal, "press Enter to begin: ")
        os.write(terminal, b"\n")
        self.read(terminal)
        self.assertEqual(process.wait(60), 1)
        self.assertTrue(re.search(r"no sample came\n$", process.stderr.read()))
        self.assertFalse(self.path("c.json").exists())


if __name__ == "__main__":
    program.main()
