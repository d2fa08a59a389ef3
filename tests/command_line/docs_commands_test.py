# SPDX-License-Identifier: GPL-3.0-or-later
"""What pages, the workflow for other projects and the helps themselves tell to type: every command and option of it is there, and every
command's help has an example."""

import functools
import re
import shlex
import unittest

import program
from program import calot

try:
    import yaml
except ImportError:
    yaml = None

WORKFLOW = program.SOURCE / "docs/how-to/ci/calot.yml"
PLACEHOLDER = re.compile(r"\.\.\.|[\[\]|]|\boptions\b")  # of a synopsis, which is no line to type


@functools.lru_cache(maxsize=None)
def help_of(*command):
    answer = calot(*command, "--help")
    if answer.code != 0:
        raise AssertionError(answer)
    return answer.out


@functools.lru_cache(maxsize=None)
def commands_of(*command):
    """Names of the commands that a command has."""
    listed = help_of(*command).partition("\nSubcommands:\n")[2].partition("\n\n")[0]
    return re.findall(r"^  ([a-z-]+)(?: |$)", listed, re.MULTILINE)


def all_commands():
    for name in commands_of():
        yield (name,)
        for inner in commands_of(name):
            yield name, inner


def lines_to_type(text):
    """Lines that begin with calot, comments and prompts left out, lines that a backslash continues joined."""
    for line in re.sub(r"\\\n\s*", " ", text).splitlines():
        line = re.sub(r"^\s*(?:\$ )?", "", line)
        for part in re.split(r" && | \|\| |; ", line):
            if part.startswith("calot ") and not PLACEHOLDER.search(part):
                yield part


def fault_of(line):
    """What of a line to type is not there, or None."""
    words = shlex.split(re.sub(r" {2,}.*| >.*", "", line), comments=True)[1:]
    if not words or words[0] == "--version":
        return None
    if words[0] not in commands_of():
        return f"no command {words[0]}"
    command = tuple(words[:2]) if len(words) > 1 and words[1] in commands_of(words[0]) else (words[0],)
    for option in (w.partition("=")[0] for w in words if re.match(r"--?[a-z]", w)):
        if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", help_of(*command)):
            return f"calot {' '.join(command)} has no {option}"
    return None


class Commands(program.ProgramTest):
    def assertThere(self, text, least, where):
        lines = list(lines_to_type(text))
        self.assertGreaterEqual(len(lines), least, where)
        for line in lines:
            with self.subTest(where=str(where), line=line):
                self.assertIsNone(fault_of(line))

    def test_a_wrong_line_is_found(self):
        self.assertEqual(fault_of("calot repaly a.h5"), "no command repaly")
        self.assertEqual(fault_of("calot replay a.h5 --junit-xml f.xml"), "calot replay has no --junit-xml")
        self.assertEqual(fault_of("calot devices serve --kinematic f"), "calot devices serve has no --kinematic")
        self.assertIsNone(fault_of("calot devices serve --kinematics f"))

    def test_every_help_has_an_example(self):
        commands = list(all_commands())
        self.assertGreater(len(commands), 60)
        for command in commands:
            with self.subTest(command=command):
                examples = help_of(*command).partition("\nExample")[2]
                self.assertIn("\n  calot " + command[0], examples)
                self.assertThere(examples, 1, command)

    def test_helps_fit_the_terminal(self):
        for command in [(), *all_commands()]:
            text = help_of(*command).partition("\nExample")[0].partition("\nThe manual: ")[0]
            for line in text.splitlines():
                # Names of options with what they take have a column of their own, a path may be long.
                if not line.startswith("  -") and not re.match(r"Usage|  [\w-]+ \w+( \.\.\.)? ", line):
                    self.assertLessEqual(len(line), 120, (command, line))

    def test_lists_wrap(self):
        """In a pipe, as on a terminal of 80 columns; what has no blank stays whole."""
        for command in (("scenes",), ("devices",), ("checkpoints",), ("protocol", "list"), ("rate", "--forms"), ("inspect", program.short())):
            for line in self.well(*command).out.splitlines():
                self.assertTrue(len(line) <= 80 or len(line.split()) <= 2, (command, line))

    def test_pages(self):
        lines = 0
        for page in sorted((program.SOURCE / "docs").rglob("*.md")):
            for block in re.findall(r"^```\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
                lines += len(list(lines_to_type(block)))
                self.assertThere(block, 0, page.relative_to(program.SOURCE))
        self.assertGreater(lines, 100)

    @unittest.skipIf(yaml is None, "python3-yaml is not installed")
    def test_workflow_of_other_projects(self):
        workflow = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))
        (job,) = workflow["jobs"].values()
        self.assertEqual(job["container"], "debian:12")
        runs = [step["run"] for step in job["steps"] if "run" in step]
        self.assertThere("\n".join(runs), 2, WORKFLOW)
        self.assertTrue(any("--junit" in run for run in runs))


if __name__ == "__main__":
    program.main()
