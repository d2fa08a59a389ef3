# SPDX-License-Identifier: GPL-3.0-or-later
"""A real recording takes no more than 1.3 times the bytes of the same file repacked: one minute, or ten with CALOT_HEAVY=1."""

import json
import shutil
import subprocess
import unittest

import h5py
import program

MOST = 1.3
SECONDS = 600 if program.HEAVY else 60


@unittest.skipUnless(shutil.which("h5repack"), "h5repack is not installed")
class Size(program.ProgramTest):
    def profile(self):
        """A performer who goes on touching for as long as is needed."""
        profile = json.loads((program.SOURCE / "assets/performers/skilled.json").read_text())
        profile.update(name="tireless", summary="Goes on.")
        profile["decision"].update(touches=50, dwell=6, pause=4)
        self.path("p.json").write_text(json.dumps(profile))
        return self.path("p.json")

    def test_inspect_tells_bytes_by_group(self):
        r = program.skilled()
        said = json.loads(self.well("inspect", "--json", r).out)
        groups = said["bytes_by_group"]
        self.assertEqual(said["bytes"], r.stat().st_size)
        self.assertEqual(sum(groups.values()), r.stat().st_size)
        with h5py.File(r, "r") as file:
            self.assertEqual(set(groups), set(file) | {"structure"})
            keyframes = sum(file["keyframes"][name].id.get_storage_size() for name in file["keyframes"])
        self.assertEqual(groups["keyframes"], keyframes)
        self.assertEqual(list(groups.values()), sorted(groups.values(), reverse=True))
        text = self.well("inspect", r).out
        self.assertRegex(text, rf"(?m)^ *bytes +{r.stat().st_size}$")
        self.assertRegex(text, rf"(?m)^ *bytes, keyframes +{keyframes} \([0-9.]+ %\)$")

    def test_against_repacked(self):
        r = self.path("r.h5")
        said = json.loads(self.well("record", "--scene", program.SCENE, "--performer", self.profile(), "--seconds", SECONDS, "--json", "-o", r).out)
        self.assertEqual(said["seconds"], SECONDS)
        for options in (["-L"], []):
            repacked = self.path("p.h5")
            subprocess.run(["h5repack", *options, r, repacked], check=True)
            ratio = r.stat().st_size / repacked.stat().st_size
            print(f"{SECONDS} s: {r.stat().st_size / SECONDS / 1e3:.1f} kB/s, h5repack {' '.join(options)}: ratio {ratio:.3f}", flush=True)
            self.assertLessEqual(ratio, MOST)
            with h5py.File(r, "r") as a, h5py.File(repacked, "r") as b:
                self.assertEqual(a["/status"][-1]["chain"].tobytes(), b["/status"][-1]["chain"].tobytes())


if __name__ == "__main__":
    program.main()
