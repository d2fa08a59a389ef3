# SPDX-License-Identifier: GPL-3.0-or-later
"""Record and replay: exact at every thread count, several at a time, and what the reports say."""

import json
import os
import unittest
import xml.etree.ElementTree as xml

import h5py
import program
import recording_file
import schema_names
from program import calot, recording, short, skilled


class Exact(program.ProgramTest):
    def test_performer_with_one_and_two_threads(self):
        for threads in (1, 2):
            answer = self.well("replay", "--threads", threads, skilled())
            self.assertRegex(answer.out, r"^\S+skilled\.h5: bit-exact, 5\.00 s \(500 steps\), [\d.]+ x real time\n$")

    def test_each_broad_phase(self):
        golden = program.SOURCE / "assets/golden/touch-liver.h5"
        for name in ("grid", "bullet"):
            self.assertIn("bit-exact", self.well("replay", "--broad-phase", name, golden).out)

    def test_recorded_with_two_threads_is_the_same_attempt(self):
        two = recording("two-threads", "--performer", "skilled", "--seed", 7, "--seconds", 5, "--threads", 2)
        with h5py.File(skilled(), "r") as a, h5py.File(two, "r") as b:
            for name in ("/steps/state_digest", "/ticks/left/force", "/ticks/right/force", "/observables/misses"):
                self.assertEqual(a[name][:].tobytes(), b[name][:].tobytes(), name)
            self.assertTrue(a["/ticks/right/force"][:].any() or a["/ticks/left/force"][:].any(), "nothing was touched")

    def test_another_seed_is_another_attempt(self):
        other = recording("other-seed", "--performer", "skilled", "--seed", 8, "--seconds", 1)
        with h5py.File(skilled(), "r") as a, h5py.File(other, "r") as b:
            self.assertNotEqual(a["/ticks/left/position"][:1000].tobytes(), b["/ticks/left/position"][:1000].tobytes())

    @unittest.skipUnless(program.MOTION.exists(), f"{program.MOTION} is not there")
    def test_kinematics_file(self):
        length = () if program.HEAVY else ("--seconds", 4)
        r = recording("motion", "--kinematics", program.MOTION, *length)
        with h5py.File(r, "r") as file:
            self.assertEqual(file.attrs["operator_kind"], b"kinematics")
            self.assertEqual(file.attrs["source_file"], program.MOTION.name.encode())
            steps = file["/status"][-1]["steps"]
        self.assertGreater(steps, 4000 if program.HEAVY else 399)
        for threads in (1, 2):
            self.assertIn(f"bit-exact, {steps / 100:.2f} s ({steps} steps)", self.well("replay", "--threads", threads, r).out)

    def test_every_name_is_in_the_schema(self):
        for r in (skilled(), short()):
            with h5py.File(r, "r") as file:
                rows = schema_names.names_of(str(program.SOURCE / "schemas"))
                self.assertGreater(len(rows), 80)
                checker = schema_names.Checker(file, rows)
                checker.check()
                faults = checker.faults + schema_names.chain_faults(file, rows)
            self.assertEqual(faults, [])

    def test_replay_does_not_touch_the_file(self):
        r = self.copy(short())
        before = r.read_bytes(), os.stat(r).st_mtime_ns
        self.well("replay", r)
        self.assertEqual((r.read_bytes(), os.stat(r).st_mtime_ns), before)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["r.h5"])

    def test_completed_and_its_json(self):
        answer = self.well("record", "--scene", program.SCENE, "--performer", "unskilled", "--seconds", 0.2, "--participant", "P1",
                           "--mode", "assessment", "--purpose", "study", "--station", "here", "--handedness", "left", "--json",
                           "-o", self.path("a.h5"))
        said = json.loads(answer.out)
        self.assertEqual((said["steps"], said["outcome"], said["file"]), (20, "stopped", str(self.path("a.h5"))))
        with h5py.File(self.path("a.h5"), "r") as file:
            self.assertEqual(file.attrs["attempt_uuid"].decode(), said["attempt"])
            self.assertEqual([file.attrs[k] for k in ("participant", "mode", "purpose", "station", "handedness")],
                             [b"P1", b"assessment", b"study", b"here", b"left"])
            self.assertEqual(file.attrs["operator_kind"], b"performer")


class Reports(program.ProgramTest):
    def test_many_at_a_time(self):
        copies = [self.copy(short(), f"{i}.h5") for i in range(3)]
        for jobs in (1, 2, 0):
            lines = self.well("replay", "--jobs", jobs, *copies).out.splitlines()
            self.assertEqual([line.split(": bit-exact")[0] for line in lines[:3]], [str(c) for c in copies])
            self.assertEqual(lines[3:], ["3 recordings, 3 bit-exact"])

    def test_junit_and_json(self):
        good, changed, broken, other = (self.copy(short(), f"{n}.h5") for n in ("good", "changed", "broken", "other & <new>"))
        with h5py.File(changed, "r+") as file:
            file["/ticks/left/position"][109, 1] += 1e-4
        recording_file.flip_stored_byte(broken, "/ticks/left/jaw", 0)
        recording_file.set_attribute(other, "simulation_version", 999)
        report = self.path("report.xml")
        answer = calot("replay", "--junit", report, "--json", good, changed, broken, other)
        self.assertEqual(answer.code, 4, answer)
        self.assertEqual(answer.err, "", answer)
        rows = json.loads(answer.out)["recordings"]
        self.assertEqual([r["verdict"] for r in rows], ["bit-exact", "diverged", "damaged", "undecided"])
        self.assertEqual([r["exit_code"] for r in rows], [0, 3, 4, 5])
        self.assertEqual((rows[1]["divergence"]["step"], rows[1]["divergence"]["reproducible"]), (10, True))

        suite = xml.parse(report).getroot()
        counts = {k: int(suite.get(k)) for k in ("tests", "failures", "errors", "skipped")}
        self.assertEqual(counts, {"tests": 4, "failures": 1, "errors": 2, "skipped": 0})
        cases = {case.get("name"): case for case in suite.iter("testcase")}
        self.assertEqual(len(cases), 4)
        self.assertEqual(len(cases["good.h5"]), 0)
        self.assertIn("step 10", cases["changed.h5"].find("failure").text)
        self.assertIn("/ticks/left/jaw", cases["broken.h5"].find("error").text)
        self.assertIn("another simulation version", cases["other & <new>.h5"].find("error").get("message"))
        for case in cases.values():
            self.assertGreaterEqual(float(case.get("time")), 0.0)
        self.assertNothingHalfWritten()

    def test_worst_code_first(self):
        good, changed, broken, other = (self.copy(short(), f"{n}.h5") for n in ("good", "changed", "broken", "other"))
        with h5py.File(changed, "r+") as file:
            file["/ticks/left/position"][109, 1] += 1e-4
        broken.write_bytes(b"no recording")
        recording_file.set_attribute(other, "simulation_version", 999)
        for files, code in (((good, other), 5), ((other, changed, good), 3), ((changed, broken, other), 4), ((good, broken), 4),
                            ((good, good), 0)):
            answer = calot("replay", *files)
            self.assertEqual(answer.code, code, answer)
            # All are looked at: a line each, on stdout if exact and on stderr if not.
            self.assertEqual(len(answer.err.splitlines()), sum(f is not good for f in files), answer)
            self.assertEqual(answer.out.count("bit-exact,"), sum(f is good for f in files), answer)
            self.assertIn(f"{len(files)} recordings, {sum(f is good for f in files)} bit-exact", answer.out)


if __name__ == "__main__":
    program.main()
