# SPDX-License-Identifier: GPL-3.0-or-later
"""Force devices and two devices at once, as a user runs them: recorded, the device killed in mid-run, replayed."""

import json
import signal
import subprocess
import time

import program
import recording_file
import h5py  # after the program, which says where it is missing
from devices_test import Server, script, moving
from program import PROGRAM, SCENE, ProgramTest


class Simulated(Server):
    """calot devices simulate."""

    command = "simulate"


class ForceDevice(ProgramTest):
    def exact(self, name):
        self.assertIn(": bit-exact, ", self.well("replay", self.path(name)).out)

    def test_both_hands_of_one_device(self):
        with Simulated("--hands", "both", "--delay", 2) as device:
            said = self.well("record", "--scene", SCENE, "--device", f"force:127.0.0.1:{device.port}", "--live", "--seconds", 1.5,
                             "-o", self.path("r.h5")).out
        self.assertIn("force on the left hand: ", said)
        self.assertIn("force on the right hand: ", said)
        self.assertIn("right hand: ", device.out)
        self.exact("r.h5")
        with h5py.File(self.path("r.h5"), "r") as file:
            self.assertEqual(file.attrs["device"].rstrip(b"\0"), b"force")
            for hand in ("left", "right"):
                self.assertGreater(file[f"/ticks/{hand}/valid"][:].mean(), 0.9)
                self.assertGreater(len(file[f"/device/{hand}/samples"]), 1000)

    def test_two_devices_and_one_killed(self):
        with Simulated("--hands", "left") as left:
            right = Simulated("--hands", "right")
            process = subprocess.Popen([str(PROGRAM), "record", "--scene", SCENE, "--device",
                                        f"left=force:127.0.0.1:{left.port},right=force:127.0.0.1:{right.port}", "--live", "--json",
                                        "-o", str(self.path("r.h5"))], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            self.addCleanup(process.kill)
            recording_file.await_steps(self.path("r.h5"), process)
            time.sleep(0.5)
            right.process.kill()
            right.process.communicate()
            time.sleep(0.3)
            with Simulated("--hands", "right", port=right.port):
                time.sleep(1.5)
                process.send_signal(signal.SIGINT)
                out, err = process.communicate(timeout=60)
        self.assertEqual((process.returncode, err), (0, ""))
        said = json.loads(out)
        self.assertEqual((said["outcome"], said["pauses"], said["force_disagreements"]), ("stopped", 1, 0))
        self.exact("r.h5")
        with h5py.File(self.path("r.h5"), "r") as file:
            self.assertEqual(file.attrs["device"].rstrip(b"\0"), b"force+force")

    def test_two_scripts_on_the_tick_clock(self):
        self.path("s.json").write_text(script(moving(1, (0, 1))), encoding="utf-8")
        name = f"left=scripted:{self.path('s.json')},right=null"
        for file in ("a.h5", "b.h5"):
            self.well("record", "--scene", SCENE, "--device", name, "--seconds", 0.8, "-o", self.path(file))
            self.exact(file)
        with h5py.File(self.path("a.h5"), "r") as a, h5py.File(self.path("b.h5"), "r") as b:
            self.assertEqual(a.attrs["device"].rstrip(b"\0"), b"scripted+null")
            for hand in ("left", "right"):
                self.assertEqual(a[f"/ticks/{hand}/position"][:].tobytes(), b[f"/ticks/{hand}/position"][:].tobytes())
                self.assertEqual(a[f"/device/{hand}/samples"][:].tobytes(), b[f"/device/{hand}/samples"][:].tobytes())

    def test_what_cannot_be_is_said(self):
        for name, code in (("left=null", 2), ("left=null,right=joystick", 2), ("left=null,right=mouse", 2), ("force:127.0.0.1:1", 1),
                           ("haply:127.0.0.1:1", 1), ("mouse:99", 1), ("force:h:0", 2)):
            self.refused(code, "record", "--scene", SCENE, "--device", name, "--seconds", 1, "-o", self.path("x.h5"))
            self.assertFalse(self.path("x.h5").exists())


if __name__ == "__main__":
    program.main()
