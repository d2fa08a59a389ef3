# SPDX-License-Identifier: GPL-3.0-or-later
"""record --live: two loops that really run, under load, stopped and killed; every recording replays bit for bit. 2 runs under load, or
10 of 60 s with CALOT_HEAVY=1."""

import json
import os
import signal
import subprocess
import sys
import time

import h5py
import numpy
import program
import recording_file
from program import SCENE


class Load:
    """Other processes that want both cores."""

    def __enter__(self):
        self.busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() or 1)]

    def __exit__(self, *_):
        for process in self.busy:
            process.kill()
            process.wait()


class Live(program.ProgramTest):
    def live(self, name, *more):
        return json.loads(self.well("record", "--scene", SCENE, "--performer", "unskilled", "--live", "--json", *more,
                                    "-o", self.path(name)).out)

    def exact(self, name):
        for threads in (1, 2):
            self.assertIn(": bit-exact, ", self.well("replay", "--threads", threads, self.path(name)).out)

    def test_under_load(self):
        seconds = 60 if program.HEAVY else 4
        # What the performer does depends on no clock: the same ticks at full speed. It may be done before the time is over.
        self.well("record", "--scene", SCENE, "--performer", "unskilled", "--seconds", seconds, "-o", self.path("full-speed.h5"))
        for i in range(10 if program.HEAVY else 2):
            with Load():
                said = self.live("r.h5", "--seconds", seconds, "--force")
                self.exact("r.h5")
            self.assertEqual(said["force_disagreements"], 0)
            with h5py.File(self.path("full-speed.h5"), "r") as a, h5py.File(self.path("r.h5"), "r") as b:
                self.assertEqual((said["steps"], said["ticks"]), (a["/status"][-1]["steps"], a["/status"][-1]["ticks"]))
                for hand in ("left", "right"):
                    self.assertEqual(a[f"/ticks/{hand}/position"][:].tobytes(), b[f"/ticks/{hand}/position"][:].tobytes())
            print(f"{said['missed_deadlines']} of {said['ticks']} deadlines missed, worst {1e3 * said['largest_lateness_s']:.1f} ms, "
                  f"stretched {said['clock_stretched_s']:.3f} s, tick {1e6 * said['tick_cpu_mean_s']:.1f} us, "
                  f"p99.9 {1e6 * said['tick_cpu_p999_s']:.1f} us", flush=True)
            self.consistent("r.h5", said)

    def consistent(self, name, said):
        """What the run said of itself is what the recording holds, and what inspect says."""
        with h5py.File(self.path(name), "r") as file:
            count = file["/status"][-1]["ticks"]
            late = file["/ticks/lateness"][:count]
            events = file["/events"][:file["/status"][-1]["events"]]
            for hand in ("left", "right"):
                sets = file[f"/ticks/{hand}/contact_set"][:count]
                step = numpy.arange(count) // 10
                self.assertTrue((sets < step).all())
                self.assertTrue((numpy.diff(sets) >= 0).all())
        self.assertEqual(int((late > numpy.float32(0.001)).sum()), said["missed_deadlines"])
        excess = late[late > numpy.float32(0.1)].astype(float) - float(numpy.float32(0.1))
        self.assertAlmostEqual(float(events["value"][events["kind"] == 16].sum()), float(excess.sum()), places=9)
        self.assertAlmostEqual(said["clock_stretched_s"], float(excess.sum()), places=4)
        inspected = json.loads(self.well("inspect", "--json", self.path(name)).out)
        self.assertEqual(inspected["missed_deadlines"], said["missed_deadlines"])
        self.assertAlmostEqual(inspected["clock_stretched_s"], float(excess.sum()), places=9)

    def test_it_says_how_it_went(self):
        out = self.well("record", "--scene", SCENE, "--performer", "skilled", "--live", "--seconds", 0.5, "-o", self.path("r.h5")).out
        self.assertRegex(out, r"(?m)^live: \d+ of 500 ticks missed their deadline, at most [\d.]+ ms late, clock stretched by [\d.]+ s$")
        self.assertRegex(out, r"(?m)^haptic tick: [\d.]+ us of CPU on average, ")
        self.exact("r.h5")

    def start(self, name):
        r = self.path(name)
        process = subprocess.Popen([str(program.PROGRAM), "record", "--scene", SCENE, "--performer", "unskilled", "--live", "-o", str(r)],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        recording_file.await_steps(r, process)
        return process

    def test_killed(self):
        draw = program.seeded("live")
        for i in range(3):
            process = self.start(f"{i}.h5")
            time.sleep(draw.uniform(0.5, 2.5))
            process.send_signal(signal.SIGKILL)
            process.wait()
            for threads in (1, 2):
                self.assertIn(": bit-exact, incomplete, ", self.well("replay", "--threads", threads, self.path(f"{i}.h5")).out)
        self.assertNothingHalfWritten()

    def test_stopped(self):
        process = self.start("r.h5")
        time.sleep(0.7)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(), 0)
        last = recording_file.last_status(self.path("r.h5"))
        self.assertEqual((last["completed"], last["outcome"]), (1, 4))
        self.exact("r.h5")


if __name__ == "__main__":
    program.main()
