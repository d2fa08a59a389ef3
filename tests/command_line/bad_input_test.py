# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command, every file: what cannot be right is refused in one line, with the documented exit code, and nothing half-written."""

import os
import resource
import shutil
import signal
import subprocess

import h5py
import numpy as np
import program
from program import SCENE, calot, short

# Commands that read one recording: what to write before and behind the file's name.
READERS = {
    "replay": (["replay"], []),
    "inspect": (["inspect"], []),
    "recover": (["recover"], ["-o", "{out}.h5"]),
    "export": (["export"], ["--csv", "{out}"]),
    "state": (["state", "--step", "1"], ["-o", "{out}.h5"]),
    "render": (["render"], ["-o", "{out}.png"]),
    "assess": (["assess"], ["--cohort", "{out}.db"]),
}


class WrongFiles(program.ProgramTest):
    def wrong_files(self):
        """(name, path) of files that are no recording."""
        draw = program.seeded("wrong files")
        files = {"empty": b"", "text": b"This is a letter.\n" * 40, "random": draw.randbytes(20000),
                 "beginning": short().read_bytes()[:2000], "signature only": b"\x89HDF\r\n\x1a\n" + draw.randbytes(5000)}
        for name, content in files.items():
            self.path(name).write_bytes(content)
        with h5py.File(self.path("other HDF5"), "w") as file:
            file["/ticks/left/position"] = np.zeros((10, 3))
            file.attrs["format"] = "something else"
        with h5py.File(self.path("claims too much"), "w") as file:
            file.attrs["format"] = np.bytes_("calot-recording")
            file.attrs["format_version"] = np.uint32(1)
        self.path("folder").mkdir()
        return [*files, "other HDF5", "claims too much", "folder", "missing"]

    def test_every_command_that_reads_a_recording(self):
        names = self.wrong_files()
        for command, (before, behind) in READERS.items():
            for name in names:
                with self.subTest(command=command, file=name):
                    out = self.path("out")
                    end = [part.format(out=out) for part in behind]
                    self.refused(4, *before, self.path(name), *end, names=(self.path(name),))
                    for left in self.folder.glob("out*"):
                        # A cohort is there as soon as it was asked for; of a picture, recording or table nothing is.
                        self.assertEqual((command, left.suffix), ("assess", ".db"))
                        left.unlink()

    def test_cohort(self):
        names = [n for n in self.wrong_files() if n not in ("empty", "missing")]
        for name in names + ["missing"]:
            for command in (["study"], ["participant", "set", "P1", "--group", "a", "--cohort"]):
                with self.subTest(command=command[0], file=name):
                    answer = calot(*command, self.path(name))
                    self.assertIn(answer.code, (2, 4), answer)
                    self.assertOneLine(answer, self.path(name))
                    self.assertFalse(self.path("missing").exists())
            if name != "missing":
                with self.subTest(command="assess", file=name):
                    before = self.path(name).read_bytes() if self.path(name).is_file() else None
                    self.refused(4, "assess", short(), "--cohort", self.path(name), names=(self.path(name),))
                    self.assertEqual(before, self.path(name).read_bytes() if before is not None else None)

    def test_state_files(self):
        self.well("state", short(), "--step", 3, "-o", self.path("good.h5"))
        for name in [*self.wrong_files(), "recording"]:
            path = short() if name == "recording" else self.path(name)
            for pair in ((path, self.path("good.h5")), (self.path("good.h5"), path)):
                with self.subTest(file=name):
                    self.refused(4, "diff", *pair, names=(path,))

    def test_surfaces(self):
        names = self.wrong_files()
        for name in names:
            for kind in ("obj", "stl", "ply"):
                source, file = self.path(name), self.path(f"{name}.{kind}")
                if source.is_dir():
                    file.mkdir()
                elif source.exists():
                    shutil.copyfile(source, file)
                with self.subTest(file=name, kind=kind):
                    self.refused(4, "mesh", file, "--unit", "m", "--tetrahedra", 100, "-o", self.path("o.vtk"), names=(file,))
                    self.assertFalse(self.path("o.vtk").exists())

    def test_surfaces_with_holes_or_numbers_that_are_none(self):
        liver = (program.SOURCE / "assets/organs/liver.obj").read_text().splitlines()
        faces = [i for i, line in enumerate(liver) if line.startswith("f ")]
        first = next(i for i, line in enumerate(liver) if line.startswith("v "))
        for name, change in (("not a number", {first: "v nan 0 0"}), ("infinite", {first: "v inf 0 0"}), ("two numbers", {first: "v 1 2"}),
                             ("no such vertex", {faces[3]: "f 1 2 999999"}), ("overflow", {faces[3]: "f 1 2 99999999999999999999"}),
                             ("one corner", {faces[3]: "f 1"})):
            with self.subTest(name):
                file = self.path("s.obj")
                file.write_text("\n".join(change.get(i, line) for i, line in enumerate(liver)) + "\n")
                self.refused(4, "mesh", file, "--unit", "m", "--tetrahedra", 100, "-o", self.path("o.vtk"), names=(f"{file}: line {1 + min(change)}: ",))


class WrongMotion(program.ProgramTest):
    def rows(self, change=None, count=40):
        """A plausible motion: 76 columns, turned by nothing, moving along x."""
        rows = []
        for n in range(count):
            group = [0.01 * n / count, 0.02, 0.03, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0.2]
            rows.append([f"{v:.8f}" for v in group * 4])
        if change:
            change(rows)
        return "".join("  ".join(row) + "\n" for row in rows)

    def record(self, path):
        return ("record", "--scene", SCENE, "--kinematics", path, "--seconds", 0.1, "-o", self.path("r.h5"))

    def test_good(self):
        self.path("m.txt").write_text(self.rows())
        self.well(*self.record(self.path("m.txt")))
        self.assertIn("bit-exact", self.well("replay", self.path("r.h5")).out)

    def test_each_fault_is_placed(self):
        def put(row, column, value):
            return lambda rows: rows[row].__setitem__(column, value)

        faults = {
            "not a number": (put(7, 38, "nan"), "line 8"), "infinite": (put(7, 38, "inf"), "line 8"),
            "a word": (put(9, 57, "abc"), "line 10"), "comma": (put(9, 57, "0,5"), "line 10"),
            "a column too few": (lambda rows: rows[11].pop(), "line 12"), "a column too many": (lambda rows: rows[11].append("1"), "line 12"),
            "no rotation": (put(12, 38 + 3, "1.5"), "line 13"), "mirrored": (put(12, 38 + 3, "-1"), "line 13"),
            "in millimetres": (put(13, 38, "120.0"), "line 14"), "huge": (put(13, 38, "1e300"), "line 14"),
            "too large for a number": (put(13, 38, "1e999"), "line 14"),
        }
        for name, (change, place) in faults.items():
            with self.subTest(name):
                path = self.path("m.txt")
                path.write_text(self.rows(change))
                self.refused(4, *self.record(path), names=("m.txt", place))
                self.assertFalse(self.path("r.h5").exists())

    def test_no_motion_at_all(self):
        path = self.path("m.txt")
        for name, content in (("empty", b""), ("one row", self.rows(count=1).encode()), ("blank", b"\n\n"), ("binary", os.urandom(5000)),
                              ("recording", short().read_bytes())):
            with self.subTest(name):
                path.write_bytes(content)
                self.refused(4, *self.record(path), names=("m.txt",))
        for missing in (self.path("none.txt"), self.folder):
            answer = calot(*self.record(missing))
            self.assertIn(answer.code, (2, 4), answer)
            self.assertOneLine(answer, missing.name)
        self.assertFalse(self.path("r.h5").exists())


class WrongUse(program.ProgramTest):
    def test_arguments(self):
        r, o = short(), self.path("o.h5")
        record = ["record", "--scene", SCENE, "--performer", "skilled", "-o", o]
        for arguments in ([], ["no-such-command"], ["record"], ["--no-such-option"], record[:-2], record[:3] + record[5:], record[:1] + record[3:],
                          record + ["--kinematics", "x"], record + ["--seconds", "-1"], record + ["--seconds", "nan"],
                          record + ["--seconds", "x"], record + ["--seconds", "1e9"], record + ["--threads", "x"], record + ["--threads", "-1"],
                          record + ["--threads", "1000"], record + ["--seed", "-5"], record + ["--seed", "99999999999999999999999"],
                          record + ["--mode", "serious"], record + ["--purpose", "fun"], record + ["--participant", "P" * 65],
                          record + ["--handedness", "both"], record + ["surplus"],
                          ["replay"], ["replay", r, "--threads", "x"], ["replay", r, "--jobs", "-1"], ["replay", r, "--jobs", "65"],
                          ["inspect"], ["recover", r], ["export", r], ["state", r, "-o", o], ["state", r, "--step", "-1", "-o", o],
                          ["state", r, "--step", "50", "-o", o], ["diff", r], ["render", r], ["render", r, "-o", self.path("o.jpg")],
                          ["assess", r], ["assess", "--cohort", o], ["study"], ["study", o, "--group-by", "age"],
                          ["participant"], ["participant", "add", "P"], ["participant", "remove", "P", "--cohort", o],
                          ["mesh", "x.obj", "--unit", "ft", "--tetrahedra", "100", "-o", "x.vtk"],
                          ["mesh", "x.obj", "--unit", "m", "--tetrahedra", "0", "-o", "x.vtk"],
                          ["mesh", "x.dxf", "--unit", "m", "--tetrahedra", "100", "-o", "x.vtk"],
                          ["mesh", "x.obj", "--unit", "m", "--tetrahedra", "100", "-o", "x.obj"], ["scenes", "x"], ["checkpoints", "--no"]):
            with self.subTest(" ".join(map(str, arguments))):
                try:
                    self.refused(2, *arguments)
                    self.assertEqual(list(self.folder.iterdir()), [])
                finally:
                    o.unlink(missing_ok=True)

    def test_unknown_names_tell_the_known(self):
        o = self.path("o.h5")
        self.refused(2, "record", "--scene", "moon", "--performer", "skilled", "-o", o, names=("moon", SCENE))
        self.refused(2, "record", "--scene", SCENE, "--performer", "clumsy", "-o", o, names=("clumsy", "skilled"))
        self.refused(2, "record", "--scene", self.path("none.json"), "--performer", "skilled", "-o", o, names=("none.json",))
        self.refused(2, "record", "--scene", SCENE, "--performer", self.path("none.json"), "-o", o, names=("none.json",))
        self.refused(2, "record", "--scene", "../../etc/passwd", "--performer", "skilled", "-o", o, names=("passwd",))
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_help_of_every_command(self):
        for command in ("record", "replay", "inspect", "recover", "export", "state", "diff", "assess", "verify", "regrade", "study", "participant", "render",
                        "mesh", "scenes", "checkpoints"):
            self.assertIn("Usage: calot " + command, self.well(command, "--help").out)
        self.assertRegex(self.well("--version").out, r"simulation version \d+")


class Outputs(program.ProgramTest):
    """Where a result cannot be put: refused before the work where that can be known, and never half-written."""

    def writers(self, out):
        r = short()
        return {
            "record": ["record", "--scene", SCENE, "--performer", "skilled", "--seconds", "0.3", "-o", out],
            "recover": ["recover", r, "-o", out],
            "state": ["state", r, "--step", "3", "-o", out],
            "state --flat": ["state", r, "--step", "3", "--flat", "-o", out],
            "render": ["render", r, "--size", "64x48", "-o", f"{out}.png"],
            "mesh": ["mesh", program.SOURCE / "assets/organs/liver.obj", "--unit", "m", "--tetrahedra", "200", "-o", f"{out}.vtk"],
        }

    def test_existing_is_kept_without_force(self):
        for name, arguments in self.writers(self.path("o")).items():
            with self.subTest(name):
                target = self.folder / os.path.basename(arguments[-1])
                target.write_bytes(b"mine")
                self.refused(2, *arguments, names=(target, "--force"))
                self.assertEqual(target.read_bytes(), b"mine")
                self.well(*arguments, "--force")
                self.assertNotEqual(target.read_bytes(), b"mine")
                self.assertNothingHalfWritten()
                target.unlink()
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_folder_that_is_not_there(self):
        for name, arguments in self.writers(self.path("none") / "o").items():
            with self.subTest(name):
                answer = calot(*arguments)
                self.assertIn(answer.code, (1, 2), answer)
                self.assertOneLine(answer, self.path("none"))

    def test_file_in_place_of_the_folder(self):
        self.path("file").write_bytes(b"x")
        for name, arguments in self.writers(self.path("file") / "o").items():
            with self.subTest(name):
                answer = calot(*arguments)
                self.assertIn(answer.code, (1, 2), answer)
                self.assertOneLine(answer, self.path("file"))
        answer = calot("export", short(), "--csv", self.path("file"))
        self.assertIn(answer.code, (1, 2), answer)
        self.assertOneLine(answer, self.path("file"))
        answer = calot("assess", short(), "--cohort", self.path("file") / "c.db")
        self.assertIn(answer.code, (1, 2, 4), answer)
        self.assertOneLine(answer, self.path("file"))
        self.assertEqual(self.path("file").read_bytes(), b"x")

    def test_folder_in_place_of_the_file(self):
        for force in ([], ["--force"]):
            for name, arguments in self.writers(self.path("o")).items():
                with self.subTest(name, force=bool(force)):
                    target = self.folder / os.path.basename(arguments[-1])
                    target.mkdir()
                    answer = calot(*arguments, *force)
                    self.assertIn(answer.code, (1, 2), answer)
                    self.assertOneLine(answer, target)
                    target.rmdir()
                    self.assertEqual(list(self.folder.iterdir()), [])

    def test_where_nothing_can_be_written(self):
        for name, arguments in self.writers("/proc/o").items():
            with self.subTest(name):
                answer = calot(*arguments)
                self.assertIn(answer.code, (1, 2), answer)
                self.assertOneLine(answer, "/proc/o")

    def test_junit_that_cannot_be_written(self):
        self.path("folder").mkdir()
        for target in (self.path("folder"), self.path("none") / "j.xml"):
            with self.subTest(str(target)):
                answer = calot("replay", short(), "--junit", target)
                self.assertIn(answer.code, (1, 2), answer)
                self.assertOneLine(answer, target)
                self.assertNothingHalfWritten()

    def test_input_is_never_the_output(self):
        r = self.copy(short())
        before = r.read_bytes()
        self.refused(2, "recover", r, "-o", r, "--force", names=(r,))
        self.assertEqual(r.read_bytes(), before)


def file_limit(size):
    """The largest file that a process may write: stands for a full disk wherever no small disk can be mounted."""

    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    return limit


class FullDisk(program.ProgramTest):
    def commands(self, folder):
        r = short()
        return {
            "recover": ["recover", r, "-o", folder / "o.h5"],
            "state": ["state", r, "--step", "3", "-o", folder / "o.h5"],
            "state --flat": ["state", r, "--step", "3", "--flat", "-o", folder / "o.flat"],
            "render": ["render", r, "--size", "640x480", "-o", folder / "o.png"],
            "export": ["export", r, "--csv", folder / "csv"],
            "assess": ["assess", r, "--cohort", folder / "c.db"],
            "junit": ["replay", r, "--junit", folder / "j.xml"],
        }

    def check(self, folder, **more):
        for name, arguments in self.commands(folder).items():
            with self.subTest(name):
                answer = calot(*arguments, **more)
                self.assertEqual(answer.code, 1, answer)
                self.assertOneLine(answer, folder)
                self.assertNothingHalfWritten(folder)
                self.assertEqual([p for p in folder.rglob("o.*")], [])
        with self.subTest("record"):
            o = folder / "r.h5"
            answer = calot("record", "--scene", SCENE, "--performer", "skilled", "--seconds", "20", "-o", o, **more)
            self.assertEqual(answer.code, 1, answer)
            self.assertOneLine(answer, o)
            self.assertNothingHalfWritten(folder)
            return o

    def test_as_far_as_a_file_may_grow(self):
        self.check(self.folder, before=file_limit(100))
        self.assertFalse(self.path("r.h5").exists())

    def test_recording_keeps_what_was_flushed(self):
        o = self.path("r.h5")
        answer = calot("record", "--scene", SCENE, "--performer", "skilled", "--seconds", "20", "-o", o, before=file_limit(500000))
        self.assertEqual(answer.code, 1, answer)
        self.assertOneLine(answer, o)
        self.assertIn(": bit-exact, incomplete, ", self.well("replay", o).out)

    def test_on_a_small_disk(self):
        disk = self.path("disk")
        disk.mkdir()
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", str(disk)], capture_output=True).returncode:
            self.skipTest("a small disk can be mounted by root alone")
        try:
            (disk / "fill").write_bytes(b"x" * 16384)
            self.check(disk)
        finally:
            subprocess.run(["umount", str(disk)], check=True)


if __name__ == "__main__":
    program.main()
