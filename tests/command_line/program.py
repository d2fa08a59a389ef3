# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the command line share: the program, a folder that goes away, and the form of every error.

From the environment: CALOT_PROGRAM, CALOT_SOURCE_DIR, CALOT_SHARED_DATA (real motion; default ../shared/data beside the source),
CALOT_MATRIX (the matrix program, or empty), CALOT_OTHER (another build's calot, or empty), CALOT_SEED (of what is random; default:
from the clock, printed), CALOT_HEAVY (1: the long form of a test).
"""

import atexit
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time
import unicodedata
import unittest

try:
    import h5py  # noqa: F401  (all tests need it; here they skip together)
    import numpy  # noqa: F401
except ImportError:
    print("h5py or numpy is not installed")
    sys.exit(77)

SOURCE = pathlib.Path(os.environ.get("CALOT_SOURCE_DIR") or pathlib.Path(__file__).resolve().parents[2])
PROGRAM = pathlib.Path(os.environ.get("CALOT_PROGRAM") or SOURCE / "build/release/bin/calot")
SHARED = pathlib.Path(os.environ.get("CALOT_SHARED_DATA") or SOURCE.parent / "shared/data")
MOTION = SHARED / "kinematics/Knot_Tying_D003.txt"
HEAVY = os.environ.get("CALOT_HEAVY") == "1"
SCENE = "touch-liver"

# A test that hangs must fail before ctest ends it without a word.
PATIENCE = 240


def seeded(name):
    """A random generator whose seed is printed, so that a failure can be had again with CALOT_SEED."""
    seed = int(os.environ.get("CALOT_SEED") or time.time_ns() % 1000000)
    print(f"{name}: CALOT_SEED={seed}", flush=True)
    return random.Random(seed)


class Answer:
    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err

    def __repr__(self):
        return f"exit {self.code}\n--- stdout\n{self.out}--- stderr\n{self.err}"


def calot(*arguments, program=PROGRAM, cwd=None, environment=None, before=None):
    """Runs the program; its whole answer."""
    done = subprocess.run([str(program), *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, cwd=cwd,
                          env={**os.environ, **(environment or {})}, preexec_fn=before, timeout=PATIENCE, check=False)
    return Answer(done.returncode, done.stdout.decode(errors="backslashreplace"), done.stderr.decode(errors="backslashreplace"))


_made = {}
_store = []


def recording(name, *arguments):
    """A recording that tests of one file share: made once, never changed (copy it to change it)."""
    if name not in _made:
        if not _store:
            _store.append(tempfile.mkdtemp(prefix="calot-cli-"))
            atexit.register(shutil.rmtree, _store[0], ignore_errors=True)
        path = pathlib.Path(_store[0]) / f"{name}.h5"
        answer = calot("record", "--scene", SCENE, *arguments, "-o", path)
        if answer.code != 0:
            raise AssertionError(f"{name} cannot be recorded: {answer}")
        _made[name] = path
    return _made[name]


def skilled():
    """Five seconds of a performer: contact, keyframes, twenty flushes."""
    return recording("skilled", "--performer", "skilled", "--seed", 7, "--seconds", 5)


def short():
    """Half a second: for tests that need any recording."""
    return recording("short", "--performer", "unskilled", "--seed", 3, "--seconds", 0.5)


class ProgramTest(unittest.TestCase):
    """Each test has a folder of its own, and what is left in it is looked at."""

    maxDiff = None

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="calot-cli-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return self.folder / name

    def copy(self, original, name="r.h5"):
        shutil.copyfile(original, self.path(name))
        return self.path(name)

    def well(self, *arguments, **more):
        """Runs what must succeed: exit 0 and nothing on stderr."""
        answer = calot(*arguments, **more)
        self.assertEqual(answer.code, 0, answer)
        self.assertEqual(answer.err, "", answer)
        return answer

    def refused(self, code, *arguments, names=(), **more):
        """Runs what must be refused: this exit code, one line on stderr that names what it is about, no part of a file left."""
        answer = calot(*arguments, **more)
        self.assertEqual(answer.code, code, answer)
        self.assertOneLine(answer, *names)
        self.assertNothingHalfWritten()
        return answer

    def assertOneLine(self, answer, *names):
        lines = answer.err.splitlines()
        self.assertEqual(len(lines), 1, answer)
        self.assertTrue(answer.err.startswith("calot: ") and answer.err.endswith("\n"), answer)
        hidden = [c for c in answer.err[:-1] if not c.isprintable() and unicodedata.category(c) != "Cn"]  # Cn: not assigned yet
        self.assertEqual(hidden, [], repr(answer))
        for name in names:
            self.assertIn(str(name), answer.err)

    def assertNothingHalfWritten(self, folder=None):
        left = [p for p in (folder or self.folder).rglob("*") if ".part" in p.name]
        self.assertEqual(left, [], "left behind")


def main():
    result = unittest.main(verbosity=2, exit=False).result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(77 if result.testsRun == len(result.skipped) else 0)  # 77: ctest shows that nothing was tested
