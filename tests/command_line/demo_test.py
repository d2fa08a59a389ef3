# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo builds what the README then runs, prints one screen, and says time and disk; setup installs only what is asked for."""

import os
import re
import subprocess
import unittest

import program
from program import SOURCE, ProgramTest

SCREEN = 40  # lines


def packages(*words):
    return set(subprocess.run([SOURCE / "scripts/setup.sh", "--list", *words], check=True, capture_output=True, text=True).stdout.split())


class Setup(unittest.TestCase):
    def test_each_target_has_what_the_smaller_one_has_and_no_more_than_it_needs(self):
        demo, build, test, checks = (packages(name) for name in ("demo", "build", "test", "checks"))
        self.assertLess(demo, build)
        self.assertLess(build, test)
        self.assertLess(test, checks)
        self.assertEqual(packages(), checks)
        self.assertEqual(packages("all"), checks)
        for package in ("qt6-base-dev", "pybind11-dev", "libgtest-dev", "clang", "valgrind", "tmux", "reuse", "g++-aarch64-linux-gnu"):
            self.assertNotIn(package, demo)
        self.assertEqual(packages("docs", "graphviz") - packages("docs"), {"graphviz"})
        self.assertFalse(packages("docs") & {"qt6-base-dev", "libgtest-dev"})

    def test_every_package_is_explained(self):
        page = (SOURCE / "docs/reference/dependencies.md").read_text(encoding="utf-8")
        self.assertEqual({name for name in packages() | packages("docs") if f"`{name}`" not in page}, set())

    def test_a_wrong_word_is_refused(self):
        answer = subprocess.run([SOURCE / "scripts/setup.sh", "--lst"], check=False, capture_output=True, text=True)
        self.assertEqual(answer.returncode, 2)
        self.assertTrue(answer.stderr.startswith("usage: "))


class Demo(ProgramTest):
    def test_it_builds_what_the_readme_then_runs(self):
        text = (SOURCE / "README.md").read_text(encoding="utf-8")
        runs = set(re.findall(r"^build/release/bin/(\S+)", text, re.M))
        self.assertGreaterEqual(runs, {"calot", "calot-dashboard", "calot-trainer"})
        script = (SOURCE / "scripts/demo.sh").read_text(encoding="utf-8")
        first, windows = (set(line.split()) for line in re.findall(r"^ *build release (.*)$", script, re.M))
        self.assertIn("calot", first)
        self.assertLessEqual(runs, windows)

    @unittest.skipUnless(program.HEAVY, "minutes")
    def test_it_prints_one_screen_and_says_time_and_disk(self):
        done = subprocess.run([SOURCE / "scripts/demo.sh"], check=False, capture_output=True, text=True, timeout=1800,
                              env={**os.environ, "CALOT_PROGRAM": str(program.PROGRAM), "CALOT_SCENE": program.SCENE, "CALOT_ATTEMPTS": "2",
                                   "CALOT_DEMO": str(self.folder)})
        self.assertEqual((done.returncode, done.stderr), (0, ""), done)
        lines = done.stdout.splitlines()
        self.assertLessEqual(len(lines), SCREEN)
        self.assertRegex(done.stdout, r"done: \d+ s to build, \d+ s to run, [1-9]\d* MB in ")
        for what in ("study", "cohort database", "look at it", "pictures"):
            self.assertTrue(any(line.startswith(f"{what}:") for line in lines), what)
        folder, = self.folder.iterdir()
        self.assertGreaterEqual({p.name for p in folder.iterdir()}, {"cohort.db", "study.txt", "demo.log", "operation-15-s.png", "first.h5", "first.png"})


if __name__ == "__main__":
    program.main()
