# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/cluster on a real Slurm of three nodes: one drained and one job killed in mid-run, the run taken up, and the cohort held
row by row against one machine's. CALOT_CLUSTER_COUNT recordings (60)."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import slurm_cluster
from cohort_setup import CLUSTER, COUNT, PROGRAM, calot, change, content, figures, kill_program, make, stored

MAX_ARRAY_SIZE = 8  # seven jobs: fewer than bundles of a second would make


class SlurmRun(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="calot-slurm-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.cluster = slurm_cluster.Cluster(self.folder / "slurm", nodes=3, max_array_size=MAX_ARRAY_SIZE)
        self.addCleanup(self.cluster.stop)

    def say(self, text):
        print(text.rstrip(), flush=True)

    def submit(self, *arguments):
        done = subprocess.run([sys.executable, CLUSTER / "submit.py", *map(str, arguments)], env={**self.cluster.environment, "CALOT": str(PROGRAM)},
                              capture_output=True, text=True, timeout=120, check=False)
        self.say(done.stdout + done.stderr)
        return done

    def running(self):
        return [job for job in self.cluster.jobs() if job[2] == "RUNNING" and job[4] == "calot-share"]

    def wait(self):
        self.cluster.until(lambda: not self.cluster.jobs(), "the queue", 1800)

    def done(self, number):
        """Recordings of a share that its database holds."""
        return stored(self.run_folder / "shares" / f"{number}.db")

    def test_drained_node_and_killed_job(self):
        make(self.folder)
        self.cluster.start()
        self.say(f"nodes: {self.cluster.states()}")
        self.run_folder = self.folder / "run"
        regrade = ("regrade", "--cohort", self.folder / "c.db", "--folder", self.run_folder, self.folder / "recordings")
        before = content(self.folder / "c.db")
        refused = self.submit(*regrade, "--shares", MAX_ARRAY_SIZE)
        self.assertEqual(refused.returncode, 1)
        self.assertIn(f"{MAX_ARRAY_SIZE - 1}", refused.stderr)
        self.assertEqual(self.submit(*regrade, "--bundle", 1).returncode, 0)
        plan = (self.run_folder / "plan.sh").read_text()
        self.assertIn(f"shares={MAX_ARRAY_SIZE - 1}\n", plan)

        # A node is drained as soon as it works: its job ends, and no other comes.
        self.cluster.until(lambda: len(self.running()) == 3, "three jobs at a time")
        self.cluster.run("scontrol", "update", "NodeName=n3", "State=DRAIN", "Reason=test")
        # A job is killed once some of its share is done, and so is the program of another, as by a lack of memory.
        victim = next(job for job in self.running() if job[3] != "n3")
        number = int(victim[1].split("_")[1])
        self.cluster.until(lambda: self.done(number) > 0 or (self.run_folder / "shares" / f"{number}.done").exists(), "some of a share")
        self.cluster.run("scancel", "--signal=KILL", victim[0])
        self.cluster.run("scancel", victim[0])
        self.say(f"killed job {victim[1]} on {victim[3]} with {self.done(number)} recordings done; drained n3: {self.cluster.states()}")
        self.cluster.until(lambda: any(int(j[1].split("_")[1]) not in (number,) and self.done(int(j[1].split("_")[1])) > 0 for j in self.running()),
                           "another share")
        process = kill_program(self.run_folder)
        self.say(f"killed process {process}")
        drained = self.cluster.states()["n3"]
        self.assertIn(drained, ("DRAINING", "DRAINED"))
        self.wait()
        self.submit("progress", "--folder", self.run_folder)
        report = (self.run_folder / "report.txt").read_text()
        self.say(report.splitlines()[-1])
        self.assertIn(f"of {MAX_ARRAY_SIZE - 1} shares are not complete", report)
        self.assertNotEqual(content(self.folder / "c.db"), before)
        self.assertNotEqual(content(self.folder / "c.db"), content(self.folder / "alone.db"))

        # The same command goes on.
        self.cluster.run("scontrol", "update", "NodeName=n3", "State=RESUME")
        self.assertEqual(self.submit(*regrade).returncode, 0)
        self.wait()
        self.submit("progress", "--folder", self.run_folder)
        log = (self.run_folder / "log" / f"{number}.log").read_text()
        self.say(log.splitlines()[-1])
        self.assertIn("by an earlier run", log)
        report = (self.run_folder / "report.txt").read_text()
        self.say(report.splitlines()[-1])
        self.assertIn(f"{COUNT} attempts:", report)
        self.assertNotIn("not complete", report)
        self.assertEqual(self.rows("c.db"), self.rows("alone.db"))
        self.assertIn("--folder", self.submit(*regrade, self.folder).stderr)
        nothing = self.submit(*regrade)
        self.assertNotIn("shares: job", nothing.stdout)  # only the report again
        self.wait()
        self.assertIn(f"{COUNT} attempts: 0 changed, {COUNT} unchanged", (self.run_folder / "report.txt").read_text())

    def rows(self, name):
        """All rows but the audit, whose order tells of two takings instead of one."""
        tables = content(self.folder / name)
        tables.pop("audit")
        tables.pop("sqlite_sequence", None)
        return tables

    def test_assess(self):
        make(self.folder)
        self.cluster.start()
        self.run_folder = self.folder / "run"
        self.assertEqual(self.submit("assess", "--cohort", self.folder / "new.db", "--folder", self.run_folder, "--each", 10, "--limit", 2,
                                     self.folder / "recordings").returncode, 0)
        self.wait()
        self.assertEqual(calot("assess", self.folder / "recordings", "--cohort", self.folder / "one.db").code, 0)
        self.assertEqual(figures(self.folder / "new.db"), figures(self.folder / "one.db"))
        self.assertIn("attempts, 0 extended", (self.run_folder / "report.txt").read_text())


if __name__ == "__main__":
    why = slurm_cluster.missing()
    if why:
        print(why)
        sys.exit(77)
    assert change  # of the cohort's setup
    unittest.main(verbosity=2)
