# SPDX-License-Identifier: GPL-3.0-or-later
"""python/examples/key_file.py on a key file that Calot 0.2 wrote."""

import os
import pathlib
import subprocess
import sys
import unittest

try:
    import nacl  # noqa: F401
except ImportError:
    print("python3-nacl is not installed")
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
SCRIPT = HERE.parents[1] / "python/examples/key_file.py"
FILE = HERE / "data/key-file-1.key"


def names(file, passphrase):
    return subprocess.run([sys.executable, "-B", SCRIPT, file], env={**os.environ, "CALOT_KEY_PASSPHRASE": passphrase}, capture_output=True, text=True,
                          encoding="utf-8", check=False)


class KeyFile(unittest.TestCase):
    def test_names(self):
        answer = names(FILE, "correct horse")
        self.assertEqual((answer.returncode, answer.stdout), (0, "P1\tAda Example\nP2\tBjörn Beispiel\n"), answer)

    def test_refusals(self):
        for file, passphrase, word in ((FILE, "wrong", "another passphrase"), (SCRIPT, "x", "not a key file"), (HERE / "none.key", "x", "No such file")):
            answer = names(file, passphrase)
            self.assertEqual((answer.returncode, answer.stdout), (1, ""), answer)
            self.assertIn(word, answer.stderr)


if __name__ == "__main__":
    unittest.main()
