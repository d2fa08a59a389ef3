# SPDX-License-Identifier: GPL-3.0-or-later
"""branch: the parent's past, another's future, a whole recording; and what is refused."""

import unittest

import h5py
import program
import recording_file
from program import SCENE, short, skilled


class Branch(program.ProgramTest):
    def branch(self, parent, name, *more):
        self.well("branch", parent, "--performer", "unskilled", *more, "-o", self.path(name))
        return self.path(name)

    def assertBranchOf(self, branch, parent, step):
        with h5py.File(parent, "r") as a, h5py.File(branch, "r") as b:
            self.assertEqual(b.attrs["parent_uuid"], a.attrs["attempt_uuid"])
            self.assertNotEqual(b.attrs["attempt_uuid"], a.attrs["attempt_uuid"])
            self.assertEqual(b.attrs["fork_step"], step)
            self.assertEqual(b.attrs["seed"], a.attrs["seed"])
            ticks = 10 * (step + 1)
            for name in ("position", "orientation", "force", "contact_set"):
                path = f"/ticks/right/{name}"
                self.assertEqual(a[path][:ticks].tobytes(), b[path][:ticks].tobytes(), name)
            self.assertEqual(a["/ticks/lateness"][:ticks].tobytes(), b["/ticks/lateness"][:ticks].tobytes())
            self.assertEqual(a["/steps/state_digest"][:step + 1].tobytes(), b["/steps/state_digest"][:step + 1].tobytes())
            self.assertNotEqual(a["/ticks/right/position"][ticks:].tobytes(), b["/ticks/right/position"][ticks:].tobytes())

    def exact(self, r):
        for threads in (1, 2):
            self.assertIn(": bit-exact, ", self.well("replay", "--threads", threads, r).out)

    def test_branch_and_branch_of_a_branch(self):
        first = self.branch(skilled(), "b.h5", "--at", "3.6", "--seconds", 2, "--seed", 9)
        self.assertBranchOf(first, skilled(), 359)
        self.exact(first)
        self.assertEqual(recording_file.last_status(first)["steps"], 560)
        second = self.branch(first, "c.h5", "--at", "0:05", "--seconds", 1)
        self.assertBranchOf(second, first, 499)
        self.exact(second)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["b.h5", "c.h5"])

    def test_live_on_live(self):
        parent = self.path("live.h5")
        self.well("record", "--scene", SCENE, "--performer", "skilled", "--live", "--seconds", 2, "-o", parent)
        twig = self.branch(parent, "b.h5", "--at", "1.5", "--live", "--seconds", 1)
        self.assertBranchOf(twig, parent, 149)
        self.exact(twig)

    @unittest.skipUnless(program.MOTION.exists(), f"{program.MOTION} is not there")
    def test_kinematics(self):
        self.well("branch", short(), "--at", "0.2", "--kinematics", program.MOTION, "--seconds", 1, "-o", self.path("k.h5"))
        self.exact(self.path("k.h5"))
        with h5py.File(self.path("k.h5"), "r") as file:
            self.assertEqual(file.attrs["operator_kind"], b"kinematics")

    def test_bad_times(self):
        for time in ("-1", "nan", "inf", "1e99", "x", "", "0", "0.009", "1:00"):
            answer = self.refused(2, "branch", short(), f"--at={time}", "--performer", "skilled", "-o", self.path("b.h5"))
            self.assertNotIn("Traceback", answer.err)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_what_cannot_be_branched(self):
        def refused(code, parent, *names):
            self.refused(code, "branch", parent, "--at", "0.1", "--performer", "skilled", "-o", self.path("b.h5"), names=names)
            self.assertFalse([p for p in self.folder.iterdir() if p.name.startswith("b.h5")])

        assessed = self.path("assessed.h5")
        self.well("record", "--scene", SCENE, "--performer", "skilled", "--seconds", 0.3, "--mode", "assessment", "-o", assessed)
        refused(3, assessed, assessed, "assessment")
        other = self.copy(short(), "other.h5")
        recording_file.set_attribute(other, "simulation_version", 999)
        refused(5, other, other, "999")
        changed = self.copy(short(), "changed.h5")
        with h5py.File(changed, "r+") as file:
            file["/ticks/left/position"][9, 1] += 1e-4
        refused(3, changed, changed)
        broken = self.path("broken.h5")
        broken.write_bytes(b"no recording")
        refused(4, broken, broken)
        refused(4, self.path("absent.h5"), "absent.h5")

    def test_nothing_is_overwritten(self):
        there = self.copy(short(), "there.h5")
        before = there.read_bytes()
        self.refused(2, "branch", short(), "--at", "0.1", "--performer", "skilled", "-o", there, names=("--force",))
        self.assertEqual(there.read_bytes(), before)
        self.refused(2, "branch", short(), "--at", "0.1", "-o", self.path("n.h5"))  # nobody acts


if __name__ == "__main__":
    program.main()
