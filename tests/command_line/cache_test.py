# SPDX-License-Identifier: GPL-3.0-or-later
"""calot cache: shows what is kept, removes it, and nothing depends on it."""

import json
import os

import program


class Cache(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cache = self.path("cache")
        before = os.environ.get("CALOT_CACHE")
        self.addCleanup(os.environ.update, {"CALOT_CACHE": before or "off"})
        os.environ["CALOT_CACHE"] = str(self.cache)

    def entries(self, *options):
        return json.loads(self.well("cache", "--json", *options).out)["entries"]

    def record(self, name):
        self.well("record", "--scene", "touch-liver", "--performer", "skilled", "--seconds", "10", "-o", self.path(name))

    def test_an_entry_comes_serves_and_goes(self):
        self.assertEqual(self.entries(), [])
        self.record("a.h5")
        self.assertEqual([(e["scene"], e["state"]) for e in self.entries()], [("touch-liver", "usable")])
        self.assertIn("usable", self.well("cache").out)
        self.well("replay", self.path("a.h5"))
        self.assertEqual(self.entries("--clean"), [])  # removed: nothing that can be used
        self.assertEqual(len(self.entries("--clean", "--all")), 1)
        self.assertEqual(self.entries(), [])
        self.assertEqual(os.listdir(self.cache), [])

    def test_damage_is_told_and_harmless(self):
        self.record("a.h5")
        name = os.path.join(self.cache, self.entries()[0]["file"])
        with open(name, "r+b") as file:
            file.seek(-1, os.SEEK_END)
            file.write(b"x")
        self.assertEqual(self.entries()[0]["state"], "damaged")
        self.assertIn("bit-exact", self.well("replay", self.path("a.h5")).out)
        self.assertEqual([e["state"] for e in self.entries()], ["usable"])  # it was written anew

    def test_off(self):
        os.environ["CALOT_CACHE"] = "off"
        self.record("a.h5")
        self.assertIn("no cache folder", self.well("cache").out)
        self.assertFalse(os.path.exists(self.cache))

    def test_all_without_clean(self):
        self.refused(2, "cache", "--all", names=["--clean"])


if __name__ == "__main__":
    program.main()
