# SPDX-License-Identifier: GPL-3.0-or-later
"""calot station: who signs, what a signature vouches for, and what the cohort keeps of it."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import h5py
import program
import recording_file
from cohort_content import query
from program import calot

RUN = ("--scene", program.SCENE, "--performer", "skilled", "--seconds", 0.6)

try:
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
except ImportError:
    Ed25519PublicKey = None


class Station(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.key, self.signed = self.path("station.json"), self.path("s.h5")
        self.public = self.well("station", "init", "OR-3", "-o", self.key).out.split()[-1]
        self.well("record", *RUN, "--station-key", self.key, "-o", self.signed)

    def test_key_file(self):
        self.assertEqual(os.stat(self.key).st_mode & 0o777, 0o600)
        self.assertEqual(self.well("station", "show", self.key).out, f"station OR-3\npublic key {self.public}\n")
        before = self.key.read_bytes()
        self.refused(2, "station", "init", "OR-3", "-o", self.key, names=(self.key, "already"))
        self.assertEqual(self.key.read_bytes(), before)
        self.refused(2, "station", "init", "", "-o", self.path("x"))
        self.refused(4, "station", "show", self.path("none"), names=("none",))
        held = json.loads(before)
        for change in ({"public_key": "00" * 32}, {"seed": "zz"}, {"version": 2}, {"station": 7}, {"format": "x"}):
            other = self.path("other.json")
            other.write_text(json.dumps({**held, **change}))
            other.chmod(0o600)
            self.refused(4, "station", "show", other, names=(other,))
        self.key.chmod(0o640)
        self.refused(2, "record", *RUN, "--station-key", self.key, "-o", self.path("t.h5"), names=("chmod",))
        self.assertFalse(self.path("t.h5").exists())

    def test_signed_and_not(self):
        said = json.loads(self.well("inspect", self.signed, "--json").out)
        self.assertEqual((said["signature"], said["public_key"], said["attempt"]["station"]), ("valid", self.public, "OR-3"))
        self.well("inspect", self.signed, "--public-key", self.public)
        self.refused(3, "inspect", self.signed, "--public-key", "00" * 32, names=(self.signed,))
        self.refused(3, "inspect", program.short(), "--public-key", self.public)
        self.assertEqual(json.loads(self.well("inspect", program.short(), "--json").out)["signature"], "none")
        self.well("replay", self.signed)
        environment = {"CALOT_STATION_KEY": str(self.key)}
        self.well("record", *RUN, "-o", self.path("e.h5"), environment=environment)
        self.assertIn("valid", self.well("inspect", self.path("e.h5")).out)
        self.refused(2, "record", *RUN, "--station", "OR-4", "-o", self.path("f.h5"), environment=environment, names=("OR-3", "OR-4"))
        self.well("branch", self.signed, "--at", 0.2, "--performer", "unskilled", "--seconds", 0.2, "--station-key", self.key, "-o", self.path("b.h5"))
        self.assertEqual(json.loads(self.well("inspect", self.path("b.h5"), "--json").out)["signature"], "valid")

    def test_the_page_holds(self):
        tool = pathlib.Path(__file__).resolve().with_name("schema_names.py")
        done = subprocess.run([sys.executable, "-B", tool, program.SOURCE / "schemas", self.signed], capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done)

    @unittest.skipIf(Ed25519PublicKey is None, "python3-cryptography is not installed")
    def test_another_program_finds_it_valid(self):
        with h5py.File(self.signed, "r") as file:
            head, value = file["/status"][-1]["chain"].tobytes(), file["/signature/value"][:].tobytes()
            key = Ed25519PublicKey.from_public_bytes(file["/signature/public_key"][:].tobytes())
        key.verify(value, head)
        with self.assertRaises(InvalidSignature):
            key.verify(value, head[::-1])

    def test_content_changed_and_resealed_is_seen(self):
        # What the chain alone cannot show: who changes the content can compute a new chain, but not the signature.
        changed = self.path("changed.h5")
        for how in ("resealed", "signature", "key"):
            shutil.copyfile(self.signed, changed)
            with h5py.File(changed, "r+") as file:
                if how == "resealed":
                    file["/ticks/left/position"][59, 1] += 1e-4
                    recording_file.reseal(file)
                elif how == "signature":
                    file["/signature/value"][5] ^= 1
                else:
                    file["/signature/public_key"][5] ^= 1
            for command in ("inspect", "replay"):
                answer = calot(command, changed)
                self.assertEqual(answer.code, 3, (how, answer))
                self.assertIn("signature", answer.err, how)

    def test_recover_keeps_it_where_all_is_saved(self):
        whole = self.path("w.h5")
        self.well("recover", self.signed, "-o", whole)
        self.well("inspect", whole, "--public-key", self.public)
        cut = self.path("cut.h5")
        data = self.signed.read_bytes()
        cut.write_bytes(data[:len(data) * 2 // 3])
        answer = calot("recover", cut, "-o", self.path("part.h5"))
        if answer.code == 0:
            self.assertIn("unfinished", self.well("inspect", self.path("part.h5")).out)

    def test_cohort_keeps_the_head_and_the_key(self):
        cohort = self.path("c.db")
        self.well("cohort", "station", "OR-3", "--public-key", self.public, "--cohort", cohort)
        self.well("assess", self.signed, "--cohort", cohort)
        self.assertEqual(query(cohort, "SELECT lower(hex(public_key)), s.chain_head = r.chain_head FROM recording_signature s JOIN recording r "
                                       "USING (attempt)"), [(self.public, 1)])
        self.assertEqual(query(cohort, "SELECT station FROM attempt"), [("OR-3",)])
        self.well("assess", self.signed, "--cohort", cohort)
        # The same attempt with a changed content, signed anew by who holds another key: another head is a conflict.
        other, forged = self.path("other.json"), self.path("forged.h5")
        self.well("station", "init", "OR-3", "-o", other)
        shutil.copyfile(self.signed, forged)
        with h5py.File(forged, "r+") as file:
            file["/ticks/left/force"][59, 1] += 1.0
            recording_file.reseal(file)
            del file["/signature"]
        answer = calot("assess", forged, "--cohort", cohort)
        self.assertEqual(answer.code, 3, answer)
        self.assertIn("conflict", answer.err)
        # A recording of this station by another key, or by none, is said.
        self.well("record", *RUN, "--seed", 5, "--station-key", other, "-o", self.path("o.h5"))
        self.well("record", *RUN, "--seed", 6, "--station", "OR-3", "-o", self.path("u.h5"))
        by_other, unsigned = (calot("assess", self.path(name), "--cohort", cohort).err for name in ("o.h5", "u.h5"))
        for warned in (by_other, unsigned):
            self.assertIn("OR-3", warned)
        self.assertNotEqual(by_other.replace("o.h5", "u.h5"), unsigned)


if __name__ == "__main__":
    program.main()
