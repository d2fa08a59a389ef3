#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""calot-bench from outside: options, exit codes, the map of figures. Asserts no time."""

import json
import os
import pathlib
import re
import subprocess

import program

BENCH = pathlib.Path(os.environ.get("CALOT_BENCH") or program.PROGRAM.parent / "calot-bench")
QUICK = ("--benchmark_filter=haptics/tick/thirty_contacts", "--benchmark_min_time=0.01")


def bench(*arguments):
    done = subprocess.run([str(BENCH), *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=program.PATIENCE, check=False)
    return program.Answer(done.returncode, done.stdout, done.stderr)


class Bench(program.ProgramTest):
    def assertRefused(self, *arguments, names=()):
        answer = bench(*arguments)
        self.assertEqual(answer.code, 2, answer)
        lines = answer.err.splitlines()
        self.assertEqual(len(lines), 1, answer)
        self.assertTrue(lines[0].startswith("calot-bench: "), answer)
        for name in names:
            self.assertIn(str(name), lines[0])

    def test_figures(self):
        file = self.path("f.json")
        answer = bench(*QUICK, "--figures", file)
        self.assertEqual(answer.code, 0, answer)
        self.assertIn("haptics/tick/thirty_contacts", answer.out)
        figures = json.loads(file.read_text())
        self.assertEqual(set(figures), {"haptics.tick_mean_ms", "haptics.tick_p999_ms"})
        documented = set(re.findall(r"^\| `([a-zA-Z0-9_.]+)` \|", (program.SOURCE / "docs/reference/benchmarks.md").read_text(), re.MULTILINE))
        self.assertLessEqual(set(figures), documented)
        for name, value in figures.items():
            self.assertIsInstance(value, float)
            self.assertGreater(value, 0.0, name)
        self.assertLess(figures["haptics.tick_mean_ms"], figures["haptics.tick_p999_ms"])
        before = file.read_bytes()
        self.assertRefused(*QUICK, "--figures", file, names=[file, "--force"])
        self.assertEqual(file.read_bytes(), before)
        file.write_text("old")
        self.assertEqual(bench(*QUICK, "--figures", file, "--force").code, 0)
        self.assertEqual(set(json.loads(file.read_text())), set(figures))
        self.assertNothingHalfWritten()

    def test_wrong_usage(self):
        file = self.path("f.json")
        self.assertRefused("--figure", file, names=["--figure"])
        self.assertRefused("extra", names=["extra"])
        self.assertRefused("--benchmark_colour=true", names=["--benchmark_colour"])
        self.assertRefused("--benchmark_filter=(", names=["--benchmark_filter"])
        answer = bench("--benchmark_filter=^nothing$", "--figures", file)  # the library's own line
        self.assertEqual(answer.code, 2, answer)
        self.assertEqual(len(answer.err.splitlines()), 1, answer)
        self.assertIn("^nothing$", answer.err)
        self.assertRefused("--figures", self.path("none/f.json"), names=["none"])
        self.assertFalse(file.exists())

    def test_lists_what_there_is(self):
        answer = bench("--benchmark_list_tests=true")
        self.assertEqual(answer.code, 0, answer)
        for name in ("contact/step/caseB", "contact/budget/passes:3", "contact/solver/thirty/newton", "contact/narrow/segment",
                     "contact/broad/update", "haptics/tick/thirty_contacts", "haptics/tick/growth"):
            self.assertIn(name, answer.out)


if __name__ == "__main__":
    program.main()
