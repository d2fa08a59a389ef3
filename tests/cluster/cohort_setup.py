# SPDX-License-Identifier: GPL-3.0-or-later
"""What the cluster's tests share: recordings, a cohort whose values are old, and what it has to become."""

import json
import os
import pathlib
import shutil
import signal
import sqlite3
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "command_line"))
from cohort_content import content, figures, query  # noqa: E402,F401
from cohort_test import change  # noqa: E402
from program import PROGRAM, SOURCE, calot  # noqa: E402,F401

CLUSTER = SOURCE / "scripts/cluster"
COUNT = int(os.environ.get("CALOT_CLUSTER_COUNT") or 60)


def stored(database):
    """Attempts in a share's database, which may have been begun a moment ago."""
    try:
        return query(database, "SELECT count(*) FROM attempt")[0][0]
    except sqlite3.Error:
        return 0


def kill_program(run_folder):
    """Kills a calot that works on a share of this run, as a lack of memory does. @return its id, or none where none runs"""
    for status in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (status / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if words[0] == str(PROGRAM).encode() and any(w.startswith(str(run_folder).encode()) for w in words):
            os.kill(int(status.name), signal.SIGKILL)
            return int(status.name)
    return None


def make(folder):
    """Recordings, `c.db` with old values, and `alone.db`: the same, regraded on one machine. @return what that printed as JSON"""
    subprocess.run([sys.executable, SOURCE / "scripts/attempts.py", folder / "recordings", "--count", str(COUNT), "--seconds", "0.5", "--calot",
                    PROGRAM], check=True)
    first = calot("assess", folder / "recordings", "--cohort", folder / "c.db")
    assert first.code == 0, first
    change(folder / "c.db", "UPDATE checkpoint_value SET version = 0, value = value * 2 WHERE name = 'path-length' AND attempt % 2 = 0")
    change(folder / "c.db", "DELETE FROM checkpoint_value WHERE name = 'elapsed-time' AND attempt % 3 = 0")
    shutil.copyfile(folder / "c.db", folder / "alone.db")
    alone = calot("regrade", folder / "alone.db", folder / "recordings", "--json")
    assert alone.code == 0, alone
    return json.loads(alone.out)
