# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/cluster/Snakefile: killed in mid-run, taken up, and the cohort held row by row against one machine's."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from cohort_setup import CLUSTER, COUNT, PROGRAM, calot, content, figures, kill_program, make, stored

SHARES = 6


class SnakemakeRun(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="calot-snakemake-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.run_folder = self.folder / "run"

    def command(self, *more, cohort="c.db"):
        return ["snakemake", "--snakefile", str(CLUSTER / "Snakefile"), "--directory", str(self.folder), "--cores", "2", "--rerun-incomplete", "--nocolor",
                "--config", f"cohort={self.folder / cohort}", f"recordings={self.folder / 'recordings'}", f"folder={self.run_folder}",
                f"shares={SHARES}", f"calot={PROGRAM}", *more]

    def start(self):
        # A group of its own, which is killed as a whole, as when the machine fails.
        return subprocess.Popen(self.command(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)

    def done(self):
        return sum(stored(p) for p in (self.run_folder / "shares").glob("*.db") if not p.with_suffix(".done").exists())

    def test_killed_and_taken_up(self):
        make(self.folder)
        process = self.start()
        while not list((self.run_folder / "shares").glob("*.done")) or self.done() < 2:
            self.assertIsNone(process.poll(), "it ended before it could be killed")
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        complete = sorted(p.name for p in (self.run_folder / "shares").glob("*.done"))
        stamps = {name: os.stat(self.run_folder / "shares" / name).st_mtime_ns for name in complete}
        print(f"killed with {complete} complete and {self.done()} recordings of others done", flush=True)
        subprocess.run([*self.command(), "--unlock"], check=True, capture_output=True)
        again = subprocess.run(self.command(), capture_output=True, text=True, check=False)
        self.assertEqual(again.returncode, 0, again.stderr)
        taken_up = [line for line in (again.stdout + again.stderr).splitlines() if "by an earlier run" in line]
        print("\n".join(taken_up), flush=True)
        self.assertTrue(taken_up)
        for name, stamp in stamps.items():
            self.assertEqual(os.stat(self.run_folder / "shares" / name).st_mtime_ns, stamp, name)
        report = (self.run_folder / "report.txt").read_text()
        print(report.splitlines()[-1], flush=True)
        self.assertIn(f"{COUNT} attempts:", report)
        self.assertEqual(content(self.folder / "c.db"), content(self.folder / "alone.db"))
        nothing = subprocess.run(self.command(), capture_output=True, text=True, check=False)
        self.assertIn("Nothing to be done", nothing.stderr + nothing.stdout)

    def test_killed_program(self):
        make(self.folder)
        process = self.start()
        while self.done() < 1 or kill_program(self.run_folder) is None:
            self.assertIsNone(process.poll(), "it ended before a program could be killed")
            time.sleep(0.01)
        self.assertEqual(process.wait(), 0)  # the share is tried again
        self.assertEqual(content(self.folder / "c.db"), content(self.folder / "alone.db"))

    def test_assess(self):
        make(self.folder)
        done = subprocess.run(self.command("work=assess", cohort="new.db"), capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(calot("assess", self.folder / "recordings", "--cohort", self.folder / "one.db").code, 0)
        self.assertEqual(figures(self.folder / "new.db"), figures(self.folder / "one.db"))


if __name__ == "__main__":
    if shutil.which("snakemake") is None:
        print("snakemake missing (Debian: snakemake)")
        sys.exit(77)
    unittest.main(verbosity=2)
