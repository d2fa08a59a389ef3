#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Devices from the command line: listing, a server over loopback that drives a recording, calibration, unplugging, bad input."""

import json
import math
import signal
import socket
import sqlite3
import subprocess
import unittest

import program
import h5py  # after the program, which says where it is missing
from program import MOTION, PROGRAM, SCENE, ProgramTest


def sample(t, hand=1, position=(0.0, 0.0, 0.0), q=(1.0, 0.0, 0.0, 0.0), gripper=0.0, buttons=0, valid=1):
    return [round(t, 6), hand, *position, *q, gripper, buttons, valid]


def script(samples, **more):
    return json.dumps({"format": "calot-device-script", "formatVersion": 1, "name": "test", "rate": 100, "samples": samples, **more})


def moving(seconds, hands=(1,)):
    return [sample(i / 100, hand, (1e-2 * math.sin(i / 50), 0.0, 1e-4 * i)) for i in range(int(100 * seconds)) for hand in hands]


def whole_stream(noise=0.0):
    """Rest, pivot and three strokes of 100 mm that are measured as 80, of both hands."""
    samples, phases, t = [], [], 0.0

    def phase(name, poses):
        nonlocal t
        begin = t
        for i, (p, q) in enumerate(poses):
            shaken = tuple(x + noise * (1 if (i + k) % 2 else -1) for k, x in enumerate(p))
            samples.extend(sample(t, hand, shaken, q) for hand in (0, 1))
            t += 0.01
        phases.append({"name": name, "from": round(begin, 6), "to": round(t, 6)})

    def tilted(i):
        around, by = 0.7 * i, 0.6 * math.sin(0.13 * i)
        q = (math.cos(by / 2), math.cos(around) * math.sin(by / 2), math.sin(around) * math.sin(by / 2), 0.0)
        w, x, y, z = q
        column = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))  # R times the tip's axis
        return tuple(0.3 - 0.2 * c for c in column), q

    still = (1.0, 0.0, 0.0, 0.0)
    phase("rest", [((0.1, 0.1, 0.1), still)] * 100)
    phase("pivot", [tilted(i) for i in range(300)])
    for axis, name in enumerate(("right", "down", "away")):
        steps = [min(1.0, max(0.0, (i - 30) / 60)) for i in range(120)]
        phase(f"stroke {name}", [(tuple(0.08 * s if k == axis else 0.0 for k in range(3)), still) for s in steps])
    return script(samples, phases=phases)


class Server:
    """calot devices serve, on any port or a certain one."""

    command = "serve"

    def __init__(self, *arguments, port=0):
        self.process = subprocess.Popen([str(PROGRAM), "devices", self.command, "--port", str(port), *map(str, arguments)],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        self.port = int(line.rsplit(":", 1)[1]) if ":" in line else None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        try:
            self.out, self.err = self.process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise


class Listing(ProgramTest):
    def test_table_and_json(self):
        table = self.well("devices").out
        for name in ("gamepad", "openigtlink:HOST:PORT", "scripted:FILE", "null"):
            self.assertIn(name, table)
        listed = json.loads(self.well("devices", "--json").out)["devices"]
        self.assertGreaterEqual(len(listed), 4)
        for device in listed:
            self.assertEqual(set(device), {"name", "present", "detail", "hands", "senses", "rate"})


class Loopback(ProgramTest):
    def drive(self, motion, seconds):
        out = self.path("r.h5")
        with Server("--kinematics", motion) as server:
            self.well("record", "--scene", SCENE, "--device", f"openigtlink:127.0.0.1:{server.port}", "--seconds", seconds, "-o", out)
        answer = self.well("replay", out)
        self.assertIn("exact", answer.out)
        with h5py.File(out, "r") as file:
            self.assertEqual(file.attrs["operator_kind"].rstrip(b"\0"), b"human")
            self.assertEqual(file.attrs["device"].rstrip(b"\0"), b"openigtlink")
            for hand in ("left", "right"):
                self.assertGreater(file[f"/ticks/{hand}/valid"][:].sum(), 0)
                positions = file[f"/ticks/{hand}/position"][:]
                self.assertGreater(len({tuple(p) for p in positions}), 5)
                self.assertEqual(set(file[f"/ticks/{hand}/instrument"][:]), {1})
        return out

    def test_a_script_served_over_loopback_drives_a_recording_that_replays(self):
        self.path("motion.json").write_text(script(moving(20, (0, 1))), encoding="utf-8")
        self.drive(self.path("motion.json"), 1.5)

    @unittest.skipUnless(MOTION.is_file(), f"{MOTION} is not here")
    def test_real_motion_served_over_loopback_drives_a_recording_that_replays(self):
        self.drive(MOTION, 20 if program.HEAVY else 3)

    def test_nobody_there_is_one_line(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.refused(1, "record", "--scene", SCENE, "--device", f"openigtlink:127.0.0.1:{port}", "-o", self.path("r.h5"),
                     names=("openigtlink", "refused"))
        self.assertFalse(self.path("r.h5").exists())

    def test_serve_refuses_what_it_cannot_play(self):
        self.refused(4, "devices", "serve", "--kinematics", self.path("no.txt"), names=("no.txt",))
        self.path("bad.txt").write_text("1 2 3\n", encoding="utf-8")
        self.refused(4, "devices", "serve", "--kinematics", self.path("bad.txt"), names=("bad.txt: line 1",))
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            self.path("m.json").write_text(script(moving(1)), encoding="utf-8")
            self.refused(1, "devices", "serve", "--kinematics", self.path("m.json"), "--port", taken.getsockname()[1], names=("port",))
        self.refused(2, "devices", "serve", "--kinematics", self.path("m.json"), "--tools", "a")


class Recording(ProgramTest):
    def write(self, name, text):
        self.path(name).write_text(text, encoding="utf-8")
        return f"scripted:{self.path(name)}"

    def test_one_hand_leaves_the_other_not_applicable(self):
        device = self.write("one.json", script(moving(2)))
        out = self.path("r.h5")
        self.well("record", "--scene", SCENE, "--device", device, "-o", out)
        self.well("replay", out)
        with h5py.File(out, "r") as file:
            self.assertEqual(set(file["/ticks/left/instrument"][:]), {0})
            self.assertEqual(set(file["/ticks/left/valid"][:]), {0})
            self.assertEqual(file.attrs["operator_kind"].rstrip(b"\0"), b"performer")
        self.well("assess", out, "--cohort", self.path("c.db"))
        with sqlite3.connect(self.path("c.db")) as db:
            rows = db.execute("SELECT * FROM checkpoint_value").fetchall()
        self.assertTrue(any("no instrument" in str(row) for row in rows), rows)

    def test_the_same_script_gives_the_same_samples(self):
        device = self.write("two.json", script(moving(1, (0, 1)), unplug=[{"at": 0.405, "for": 0.2}]))
        for name in ("a.h5", "b.h5"):
            self.well("record", "--scene", SCENE, "--device", device, "-o", self.path(name))
        with h5py.File(self.path("a.h5"), "r") as a, h5py.File(self.path("b.h5"), "r") as b:
            for hand in ("left", "right"):
                for field in ("position", "orientation", "valid"):
                    self.assertEqual(a[f"/ticks/{hand}/{field}"][:].tobytes(), b[f"/ticks/{hand}/{field}"][:].tobytes())

    def test_null(self):
        self.well("record", "--scene", SCENE, "--device", "null", "--seconds", 0.5, "-o", self.path("r.h5"))
        self.well("replay", self.path("r.h5"))

    def test_unplugged_practice_goes_on_and_assessment_fails_and_both_replay(self):
        device = self.write("u.json", script(moving(1, (0, 1)), unplug=[{"at": 0.405, "for": 0.2}]))
        self.write("stream.json", whole_stream())
        self.well("devices", "calibrate", device, "--from", self.path("stream.json"), "-o", self.path("c.json"))
        practice = json.loads(self.well("record", "--scene", SCENE, "--device", device, "--json", "-o", self.path("p.h5")).out)
        self.assertEqual((practice["outcome"], practice["pauses"]), ("completed", 1))
        self.assertGreaterEqual(practice["steps"], 99)
        test = json.loads(self.well("record", "--scene", SCENE, "--device", device, "--calibration", self.path("c.json"),
                                    "--mode", "assessment", "--json", "-o", self.path("t.h5")).out)
        self.assertEqual(test["outcome"], "technical failure")
        self.assertIn("unplugged", test["source_status"])
        self.well("replay", self.path("p.h5"), self.path("t.h5"))
        with h5py.File(self.path("t.h5"), "r") as file:
            self.assertEqual(int(file["/status"][-1]["outcome"]), 5)
            text = file.attrs["calibration"].rstrip(b"\0").decode()
            self.assertEqual(json.loads(text)["identity"], "scripted:test")

    def test_bad_names_and_files(self):
        for name in ("joystick", "openigtlink:h:99999", "openigtlink:h:", "scripted", "gamepad:"):
            self.refused(2, "record", "--scene", SCENE, "--device", name, "-o", self.path("r.h5"), names=("--device",))
        self.refused(2, "record", "--scene", SCENE, "--device", "null", "--performer", "skilled", "-o", self.path("r.h5"))
        self.refused(4, "record", "--scene", SCENE, "--device", self.write("bad.json", "{"), "-o", self.path("r.h5"), names=("bad.json",))
        self.refused(4, "record", "--scene", SCENE, "--device", f"scripted:{self.path('no.json')}", "-o", self.path("r.h5"))
        self.assertFalse(self.path("r.h5").exists())


class Calibrating(ProgramTest):
    def setUp(self):
        super().setUp()
        self.path("stream.json").write_text(whole_stream(), encoding="utf-8")
        self.path("noisy.json").write_text(whole_stream(0.002), encoding="utf-8")
        self.device = f"scripted:{self.path('stream.json')}"

    def test_measures_and_writes(self):
        answer = self.well("devices", "calibrate", self.device, "--from", self.path("stream.json"), "-o", self.path("c.json"))
        self.assertIn("passed; valid for 30 days", answer.out)
        found = json.loads(self.path("c.json").read_text(encoding="utf-8"))
        self.assertTrue(found["passed"])
        self.assertAlmostEqual(found["hands"]["left"]["scale"], 1.25, 6)
        self.assertAlmostEqual(found["hands"]["right"]["tipOffset"][2], 0.2, 6)
        self.refused(2, "devices", "calibrate", self.device, "--from", self.path("stream.json"), "-o", self.path("c.json"))

    def test_a_mouse_is_declared(self):
        said = self.well("devices", "calibrate", "mouse", "--pixel", 0.05, "-o", self.path("c.json")).out
        self.assertIn("declared, not measured: the hand moves 0.05 mm for a pixel", said)
        found = json.loads(self.path("c.json").read_text(encoding="utf-8"))
        self.assertEqual((found["device"], found["passed"], found["declaredPixel"]), ("mouse", True, 5e-5))
        for pixel in (0, -1, 100, "nan"):
            self.refused(2, "devices", "calibrate", "mouse", "--pixel", pixel, "-o", self.path("d.json"), names=("pixel",))
        self.refused(2, "devices", "calibrate", self.device, "--pixel", 0.05, "-o", self.path("d.json"), names=("scripted:",))

    def test_failed_is_written_and_exits_3(self):
        answer = self.refused(3, "devices", "calibrate", self.device, "--from", self.path("noisy.json"), "-o", self.path("c.json"),
                              names=("failed",))
        self.assertIn("falls short", answer.out)
        self.assertFalse(json.loads(self.path("c.json").read_text(encoding="utf-8"))["passed"])

    def test_needs_a_terminal_or_a_stream(self):
        self.refused(2, "devices", "calibrate", "openigtlink", "-o", self.path("c.json"), names=("terminal",))
        self.refused(2, "devices", "calibrate", "null", "-o", self.path("c.json"), names=("--from",))
        self.path("short.json").write_text(script(moving(1)), encoding="utf-8")
        self.refused(4, "devices", "calibrate", "null", "--from", self.path("short.json"), "-o", self.path("c.json"), names=("rest",))
        self.assertFalse(self.path("c.json").exists())

    def test_assessment_refuses_what_is_missing_failed_old_or_of_another_device(self):
        self.well("devices", "calibrate", self.device, "--from", self.path("stream.json"), "-o", self.path("good.json"))
        good = json.loads(self.path("good.json").read_text(encoding="utf-8"))
        run = ("record", "--scene", SCENE, "--device", self.device, "--mode", "assessment", "-o", self.path("r.h5"))

        def write(**changes):
            self.path("c.json").write_text(json.dumps({**good, **changes}), encoding="utf-8")

        self.refused(2, *run, names=("--calibration",))
        write(date="2020-01-01T00:00:00Z")
        self.refused(3, *run, "--calibration", self.path("c.json"), names=("expired",))
        write(date="2999-01-01T00:00:00Z")
        self.refused(3, *run, "--calibration", self.path("c.json"), names=("future",))
        write(identity="scripted:other")
        self.refused(3, *run, "--calibration", self.path("c.json"), names=("c.json", "scripted:other"))
        write(hands={"left": good["hands"]["left"]})
        self.refused(3, *run, "--calibration", self.path("c.json"), names=("c.json", "1", "2"))
        write(passed=False)
        self.refused(4, *run, "--calibration", self.path("c.json"), names=("/passed",))
        self.path("c.json").write_text("[]", encoding="utf-8")
        self.refused(4, *run, "--calibration", self.path("c.json"), names=("c.json",))
        calot_failed = program.calot("devices", "calibrate", self.device, "--from", self.path("noisy.json"), "-o", self.path("f.json"))
        self.assertEqual(calot_failed.code, 3)
        self.refused(3, *run, "--calibration", self.path("f.json"), names=("failed",))
        self.assertFalse(self.path("r.h5").exists())
        # Practice takes an old one of the same device.
        write(date="2020-01-01T00:00:00Z")
        self.well("record", "--scene", SCENE, "--device", self.device, "--calibration", self.path("c.json"), "--seconds", 0.2, "-o",
                  self.path("p.h5"))


if __name__ == "__main__":
    program.main()
