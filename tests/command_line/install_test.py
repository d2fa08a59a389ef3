#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is installed: programs find their files from any folder and after a move; manual and completion have all that the help has; the
libraries build a program of one's own."""

import gzip
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import program
from program import SOURCE, ProgramTest

BUILD = program.PROGRAM.parents[1]
WINDOWS = program.PROGRAM.with_name("calot-dashboard").exists()
MODULES = (BUILD / "lib/calot").exists()
COMPONENTS = ["commands", "engines", "documents", "development", *(["modules"] if MODULES else []), *(["windows"] if WINDOWS else [])]


def run(*command, cwd="/", **environment):
    clean = {k: v for k, v in os.environ.items() if not k.startswith("CALOT_") or k == "CALOT_CACHE"}
    return subprocess.run([str(c) for c in command], cwd=cwd, env={**clean, **environment}, stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=program.PATIENCE, check=False)


def helped(command):
    """What a user sees of a command: its options and the commands below it, read from the help as it is printed."""
    text = run(*command, "--help").stdout
    options = {n for line in text.splitlines() for n in re.findall(r"(?<![\w-])--?[a-z][a-z0-9-]*", (re.match(r"  (-\S+)", line) or [""])[0])}
    below = text.partition("\nSubcommands:\n")[2].partition("\n\n")[0]
    return options, re.findall(r"^  ([a-z][a-z-]*)", below, re.MULTILINE)


def commands_of(command):
    """(words, options) of a program and of every command below it."""
    options, below = helped(command)
    yield command, options
    for name in below:
        yield from commands_of([*command, name])


class Installed(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.root = Path(tempfile.mkdtemp(prefix="calot-install-"))
        cls.addClassCleanup(shutil.rmtree, cls.root, ignore_errors=True)
        for component in COMPONENTS:
            done = run("cmake", "--install", BUILD, "--prefix", cls.root / "there", "--component", component)
            if done.returncode != 0:
                raise AssertionError(done.stderr)
        # As if it had been unpacked elsewhere.
        cls.prefix = cls.root / "moved"
        (cls.root / "there").rename(cls.prefix)
        cls.calot = cls.prefix / "bin/calot"

    def good(self, *command, **more):
        done = run(*command, **more)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done)
        return done.stdout

    def test_the_main_job_runs_from_there(self):
        record, cohort = self.path("r.h5"), self.path("c.db")
        self.good(self.calot, "record", "--scene", "touch-liver", "--performer", "skilled", "--seed", 2, "--seconds", 0.5, "-o", record)
        self.assertIn("bit-exact", self.good(self.calot, "replay", "--apart", record))
        self.good(self.calot, "assess", record, "--cohort", cohort)
        self.assertIn("cholecystectomy-2014-table2", self.good(self.calot, "protocol", "list"))
        engines = self.good(self.calot, "engine", "list")
        self.assertIn(str(self.prefix / "bin/calot-engine"), engines)
        self.assertIn(str(self.prefix / "share/calot/engines/engine-12.wasm"), engines)
        if MODULES:
            self.good(self.calot, "render", record, "--to", 0.2, "--size", "64x64", "-o", self.path("r.mp4"))
        self.good(self.prefix / "bin/calot-organs", "--check", self.prefix / "share/calot/organs")

    def test_there_is_no_clone_to_build_engines_from(self):
        done = run(self.calot, "engine", "build", 12, "-o", self.path("e"))
        self.assertEqual(done.returncode, 2, done)
        self.assertIn("--source", done.stderr)

    def test_programs_name_no_folder_of_the_build(self):
        for file in (self.prefix / "bin").iterdir():
            self.assertNotIn(str(SOURCE).encode(), file.read_bytes(), file.name)

    def test_manual_names_no_place_of_this_machine(self):
        pages = list((self.prefix / "share/man/man1").iterdir())
        self.assertGreater(len(pages), 20)
        for file in pages:
            with gzip.open(file, "rt") as page:
                text = page.read().replace("\\-", "-")
            self.assertNotIn(str(SOURCE), text, file.name)
            self.assertNotIn("The manual: ", text, file.name)
        self.assertIn("\nThe manual: ", run(BUILD / "bin/calot", "--help").stdout)

    def test_manual_and_completion_have_what_the_help_has(self):
        programs = ["calot", "calot-organs", *(["calot-dashboard", "calot-trainer"] if WINDOWS else [])]
        seen = 0
        for name in programs:
            completions = [(self.prefix / "share" / path).read_text() for path in
                           (f"bash-completion/completions/{name}", f"zsh/vendor-completions/_{name}", f"fish/vendor_completions.d/{name}.fish")]
            for words, options in commands_of([self.prefix / "bin" / name]):
                path = [name, *words[1:]]
                with gzip.open(self.prefix / "share/man/man1" / f"{'-'.join(path[:2])}.1.gz", "rt") as file:
                    page = file.read().replace("\\-", "-")
                self.assertGreaterEqual(len(options), 2, path)
                for option in options:
                    seen += 1
                    self.assertRegex(page, rf"\\fB{re.escape(option)}\\fR", path)
                    for text in completions:
                        self.assertRegex(text, rf"(?<![\w-]){re.escape(option)}(?![\w-])|-l {option[2:]}\b|-s {option[1:]}\b", path)
                for word in path[1:]:
                    for text in completions:
                        self.assertRegex(text, rf"(?<![\w-]){re.escape(word)}(?![\w-])", path)
        self.assertGreater(seen, 300)

    def test_bash_completes(self):
        script = f"source {self.prefix}/share/bash-completion/completions/calot; COMP_WORDS=(calot record --mode pr); COMP_CWORD=3; _calot; echo ${{COMPREPLY[@]}};"
        self.assertEqual(self.good("bash", "-c", script).split(), ["practice"])
        script = script.replace("record --mode pr", "engine li").replace("COMP_CWORD=3", "COMP_CWORD=2")
        self.assertEqual(self.good("bash", "-c", script).split(), ["list"])

    def test_other_shells_read_their_completion(self):
        shells = [s for s in ("zsh", "fish") if shutil.which(s)]
        if not shells:
            self.skipTest("neither zsh nor fish is installed")
        for shell in shells:
            folder = self.prefix / "share" / {"zsh": "zsh/vendor-completions", "fish": "fish/vendor_completions.d"}[shell]
            for file in folder.iterdir():
                self.good(shell, "-n", file)

    def test_a_program_of_ones_own(self):
        if os.environ.get("CALOT_BUILD_TYPE") != "Release":
            self.skipTest("libraries of a sanitizer's or debug build need its flags")
        build = self.path("build")
        self.good("cmake", "-S", SOURCE / "packaging/example", "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_PREFIX_PATH={self.prefix}")
        self.good("cmake", "--build", build)
        said = self.good(build / "median_force", program.short())
        self.assertIn("bit-exact", said)
        self.assertRegex(said, r"\d+ forces")


if __name__ == "__main__":
    program.main()
