# SPDX-License-Identifier: GPL-3.0-or-later
"""kill -9 of a recording at real time, at random moments: what is left opens, replays, says that it is incomplete, and has lost at
most half a second. 6 kills, or 50 with CALOT_HEAVY=1."""

import os
import signal
import subprocess
import time

import h5py
import program
import recording_file
from program import SCENE

LARGEST_LOSS = 0.5  # s, schemas/recording.md
TOGETHER = 2


class Killed(program.ProgramTest):
    def start(self, name, seed):
        """A paced recording of its own, from the moment that its file has its name."""
        r = self.path(name)
        process = subprocess.Popen([str(program.PROGRAM), "record", "--scene", SCENE, "--performer", "unskilled", "--seed", str(seed),
                                    "--paced", "-o", str(r)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        end = time.monotonic() + 60
        while not r.exists():
            self.assertIsNone(process.poll(), process.stderr)
            self.assertLess(time.monotonic(), end, "nothing is recorded")
            time.sleep(0.001)
        return {"file": r, "process": process, "named": time.time()}

    def lost(self, run):
        """Seconds of the attempt that had passed when the writer was killed and are not in the file."""
        with h5py.File(run["file"], "r", libver="latest", swmr=True) as file:
            status = file["/status"][:]
            steps, ticks = int(status[-1]["steps"]), int(status[-1]["ticks"])
            self.assertEqual(int(status[-1]["completed"]), 0)
            late = file["/ticks/lateness"][:ticks]
        # Where a tick was more than 100 ms late, all later ones are due later by what exceeds it.
        stretched = float((late[late > 0.1] - 0.1).sum())
        saved = 0.01 * steps + stretched
        if steps == 0:
            return run["killed"] - run["named"], saved
        # Row k was written after its steps were over; the promptest row tells best when the first tick was due.
        start = min(row["wall_nanoseconds"] * 1e-9 - 0.01 * int(row["steps"]) for row in status[1:])
        return run["killed"] - start - 0.01 * steps - stretched, saved

    def proven(self, file, steps):
        """Replays bit for bit, where it has steps."""
        if steps:
            self.assertIn(": bit-exact, incomplete, ", self.well("replay", file).out)
        else:
            self.refused(5, "replay", file, names=(file,))

    def test_at_random_moments(self):
        draw = program.seeded("killed")
        worst, flushed = 0.0, 0
        for _ in range((50 if program.HEAVY else 6) // TOGETHER):
            runs = [self.start(f"{i}.h5", draw.randrange(1 << 30)) for i in range(TOGETHER)]
            for run in sorted(runs, key=lambda r: r["named"]):
                run["life"] = draw.uniform(0.0, 4.0)
            for run in sorted(runs, key=lambda r: r["named"] + r["life"]):
                time.sleep(max(0.0, run["named"] + run["life"] - time.time()))
                run["killed"] = time.time()
                run["process"].send_signal(signal.SIGKILL)
                self.assertEqual(run["process"].wait(), -signal.SIGKILL, run["process"].stderr.read())
                run["process"].stderr.close()
            for run in runs:
                with self.subTest(life=run["life"]):
                    r = run["file"]
                    lost, saved = self.lost(run)
                    worst, flushed = max(worst, lost), flushed + (saved > 0)
                    self.assertLessEqual(lost, LARGEST_LOSS)
                    self.proven(r, saved > 0)
                    self.assertRegex(self.well("inspect", r).out, r"(?m)^ *state +incomplete$")
                    whole = self.path("recovered.h5")
                    self.assertIn("incomplete", self.well("recover", r, "-o", whole, "--force").out)
                    self.proven(whole, saved > 0)
                    self.assertEqual(recording_file.last_status(whole)["chain"].tobytes(),
                                     recording_file.last_status(r, swmr=True)["chain"].tobytes())
                    os.unlink(r)
            self.assertNothingHalfWritten()
        print(f"largest loss {worst:.3f} s", flush=True)
        self.assertGreater(flushed, 0)

    def test_damaged_after_the_kill(self):
        # The file still has the mark of its writer: whoever reads it must not wait for that writer to mend what is broken.
        draw = program.seeded("damaged after the kill")
        run = self.start("r.h5", 1)
        recording_file.await_steps(run["file"], run["process"])
        run["process"].send_signal(signal.SIGKILL)
        run["process"].wait()
        run["process"].stderr.close()
        content = run["file"].read_bytes()
        damaged = 0
        for place in [0, 9, 11, 44, 50, 300] + [draw.randrange(len(content)) for _ in range(40 if program.HEAVY else 6)]:
            changed = bytearray(content)
            changed[place] ^= 1 << draw.randrange(8)
            run["file"].write_bytes(changed)
            begin = time.monotonic()
            answer = program.calot("replay", run["file"])
            with self.subTest(byte=place):
                self.assertIn(answer.code, (0, 3, 4), answer)
                if answer.code != 0:
                    self.assertOneLine(answer, run["file"])
                    damaged += 1
                self.assertLess(time.monotonic() - begin, 30.0)
        self.assertGreater(damaged, 0)

    def test_stopped_by_the_keyboard_is_an_attempt(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            run = self.start(f"{number}.h5", 2)
            time.sleep(0.4)
            run["process"].send_signal(number)
            self.assertEqual(run["process"].wait(), 0)
            run["process"].stderr.close()
            self.assertNotIn("incomplete", self.well("replay", run["file"]).out)
            last = recording_file.last_status(run["file"])
            self.assertEqual((last["completed"], last["outcome"]), (1, 4))


if __name__ == "__main__":
    program.main()
