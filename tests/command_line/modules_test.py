# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules: missing, of another build, cut off, not one at all; and that an error of theirs is one of the program's."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import unittest

from program import PROGRAM, ProgramTest, calot, main, short

MODULES = PROGRAM.parent.parent / "lib/calot"


@unittest.skipUnless((MODULES / "films.so").exists(), "this build has no modules: a sanitizer's is one program")
class Modules(ProgramTest):
    def tree(self):
        """A program with a folder of modules of its own."""
        for folder in ("bin", "lib/calot", "share"):
            self.path(folder).mkdir(parents=True)
        shutil.copy2(PROGRAM, self.path("bin/calot"))
        self.path("share/calot").symlink_to((PROGRAM.parent.parent / "share/calot").resolve())
        self.path("out").mkdir()
        return self.path("bin/calot"), self.path("lib/calot/films.so")

    def film(self, program, code):
        answer = calot("render", short(), "--to", 0.2, "--size", "64x64", "-o", self.path("out/a.mp4"), program=program)
        self.assertEqual(answer.code, code, answer)
        self.assertEqual(list(self.path("out").iterdir()), [self.path("out/a.mp4")] if code == 0 else [], answer)
        return answer

    def test_a_module_is_loaded_from_beside_the_programs_folder(self):
        program, films = self.tree()
        shutil.copy2(MODULES / "films.so", films)
        self.film(program, 0)

    def test_a_missing_module_is_named_with_its_place_and_package(self):
        program, films = self.tree()
        self.assertOneLine(self.film(program, 1), str(films), "calot-modules", "scripts/demo.sh --windows")
        # What needs none is there.
        self.assertEqual(calot("render", short(), "--at", 0.2, "--size", "64x64", "-o", self.path("a.png"), program=program).code, 0)

    def test_devices_and_paper_say_what_they_lack(self):
        program, _ = self.tree()
        sheets = self.refused(1, "devices", "print", "-o", self.path("out/s.pdf"), program=program)
        self.assertOneLine(sheets, self.path("lib/calot/pdf.so"))
        listed = {d["name"]: d for d in json.loads(calot("devices", "--json", program=program).out)["devices"]}
        for name in ("gamepad", "camera"):
            self.assertFalse(listed[name]["present"])
            self.assertIn("lib/calot/devices.so: ", listed[name]["detail"])
        for name in ("gamepad", "spacenav", "openigtlink"):
            answer = self.refused(1, "record", "--scene", "touch-liver", "--device", name, "-o", self.path("out/a.h5"), program=program)
            self.assertOneLine(answer, self.path("lib/calot/devices.so"))
        self.assertEqual(list(self.path("out").iterdir()), [])
        # Devices that need no library are there.
        answer = calot("record", "--scene", "touch-liver", "--device", "null", "--seconds", 0.05, "-o", self.path("out/a.h5"), program=program)
        self.assertEqual(answer.code, 0, answer)

    def test_a_module_of_another_build_is_refused(self):
        program, films = self.tree()
        build = subprocess.run([str(program), "--version"], capture_output=True, text=True, check=True).stdout.split()[1].encode()
        content = (MODULES / "films.so").read_bytes()
        at = content.index(build + b" ")
        films.write_bytes(content[:at] + b"9" + content[at + 1:])
        self.assertOneLine(self.film(program, 1), str(films), "build 9", "build " + build.decode())

    def test_a_module_that_is_cut_off_is_refused(self):
        program, films = self.tree()
        content = (MODULES / "films.so").read_bytes()
        for share in (0.0, 0.001, 0.2, 0.5, 0.99):
            with self.subTest(share=share):
                films.write_bytes(content[:int(share * len(content))])
                self.assertOneLine(self.film(program, 1), str(films), "whole")

    def test_another_library_is_no_module(self):
        program, films = self.tree()
        library = next(pathlib.Path("/usr/lib").glob("*/libz.so.1"))
        missing = self.film(program, 1).err
        shutil.copy2(library, films)
        answer = self.film(program, 1)
        self.assertOneLine(answer, str(films))
        self.assertNotIn("whole", answer.err)
        self.assertNotEqual(answer.err, missing)

    def test_an_error_of_a_module_keeps_its_place(self):
        # The name of the file that is written first is too long.
        film = self.path("f" * 247 + ".mp4")
        self.refused(1, "render", short(), "--to", 0.2, "--size", "64x64", "-o", film, names=(film,))


class Start(ProgramTest):
    def test_the_program_starts_without_libraries_of_modules(self):
        if os.environ.get("CALOT_BUILD_TYPE", "Release") != "Release" or not MODULES.exists():
            self.skipTest("this build has no modules")
        # HDF5 brings libraries of its own (a network's, which bring gmp): the test reads what the program itself names.
        needed = subprocess.run(["readelf", "--dynamic", str(PROGRAM)], capture_output=True, text=True, check=True).stdout
        self.assertIn("Shared library: [libhdf5", needed)
        heavy = re.findall(r"Shared library: \[(lib(?:av|sw|SDL|gmp|mpfr|OpenIGTLink|apriltag|spnav|Qt|OSMesa|LLVM)\S*)\]", needed)
        self.assertEqual(heavy, [])


if __name__ == "__main__":
    main()
