#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where files are: outputs that are devices, pipes and links, huge files, shares without locks, a terminal that goes."""

import os
import resource
import signal
import socket
import subprocess
import time
import unittest

import h5py
import program
import recording_file
from program import calot, short

NO_LOCKS = os.environ.get("CALOT_NO_LOCKS", "")


def writers(path, recording):
    """Every kind of writer of one file, which replaces what is at `path`."""
    return {"recording": ["record", "--scene", program.SCENE, "--performer", "skilled", "--seconds", "0.1", "-o", path],
            "recover": ["recover", recording, "-o", path],
            "state": ["state", recording, "--step", "3", "-o", path],
            "picture": ["render", recording, "--size", "320x240", "-o", f"{path}"],
            "junit": ["replay", recording, "--junit", path]}


class Outputs(program.ProgramTest):
    def made(self, kind):
        path = self.path("target.png")
        if kind == "fifo":
            os.mkfifo(path)
        elif kind == "socket":
            with socket.socket(socket.AF_UNIX) as server:
                server.bind(str(path))
        elif kind == "link to a device":
            path.symlink_to("/dev/null")
        else:
            path.mkdir()
        return path

    def test_devices_pipes_and_folders_stay(self):
        for kind in ("fifo", "socket", "link to a device", "folder"):
            path = self.made(kind)
            before = path.lstat()
            for name, arguments in writers(path, short()).items():
                with self.subTest(kind, writer=name):
                    self.refused(2, *arguments, "--force", names=(path,))
                    self.assertEqual(path.lstat().st_ino, before.st_ino)
            path.rmdir() if kind == "folder" else path.unlink()

    def test_a_link_stays_and_its_target_is_replaced(self):
        (self.path("elsewhere")).mkdir()
        for name, arguments in writers(self.path("link.png"), short()).items():
            with self.subTest(name):
                target, link = self.path("elsewhere/target.png"), self.path("link.png")
                target.write_text("before")
                link.symlink_to("elsewhere/target.png")
                self.refused(2, *arguments, names=(link,))
                self.assertEqual(target.read_text(), "before")
                self.well(*arguments, "--force")
                self.assertTrue(link.is_symlink())
                self.assertNotEqual(target.read_bytes(), b"before")
                self.assertEqual(os.listdir(self.path("elsewhere")), ["target.png"])
                link.unlink()
                target.unlink()

    def test_huge_files_are_refused_by_their_size(self):
        huge = self.path("huge.csv")
        with huge.open("wb") as file:
            file.truncate(2_500_000_000)
        (self.path("c.json")).write_text("{}")
        for arguments in (["import", "--manifest", huge, "--cohort", self.path("c.db")],
                          ["study", "--table", huge, "--participant-column", "a", "--group-column", "b", "--outcome", "c"],
                          ["import", huge, "--cutoff", "6"], ["mesh", huge, "--unit", "m"], ["norm", "angoff", huge], ["scene", "check", huge],
                          ["replay", huge], ["study", huge]):
            with self.subTest(str(arguments[:2])):
                begin = time.monotonic()
                answer = calot(*arguments, before=lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30)))
                self.assertIn(answer.code, (2, 4), answer)
                self.assertOneLine(answer, huge.name)
                self.assertLess(time.monotonic() - begin, 2.0)


@unittest.skipUnless(NO_LOCKS, "locks cannot be refused beside a sanitizer")
class WithoutLocks(program.ProgramTest):
    environment = {"LD_PRELOAD": NO_LOCKS}

    def test_recordings_are_written_and_read(self):
        file = self.path("r.h5")

        def warned(*arguments):
            answer = calot(*arguments, environment=self.environment)
            self.assertEqual(answer.code, 0, answer)
            self.assertOneLine(answer, "warning", arguments[-1], "lock")

        warned("record", "--scene", program.SCENE, "--performer", "skilled", "--seconds", "0.3", "-o", file)
        for environment in (self.environment, {}):
            self.assertIn("bit-exact", self.well("replay", file, environment=environment).out)
            self.well("inspect", file, environment=environment)
        self.well("recover", file, "-o", self.path("o.h5"), environment=self.environment)
        self.well("state", file, "--step", 3, "-o", self.path("s.h5"), environment=self.environment)
        warned("branch", file, "--at", 0.1, "--performer", "skilled", "--seconds", 0.1, "-o", self.path("b.h5"))
        self.well("assess", file, "--cohort", self.path("c.db"), environment=self.environment)

    def test_intake_says_what_it_lacks(self):
        self.path("in").mkdir()
        answer = calot("verify", self.path("in"), "--watch", "--cohort", self.path("c.db"), environment=self.environment)
        self.assertNotEqual(answer.code, 0, answer)
        self.assertOneLine(answer)


class Locked(program.ProgramTest):
    def test_another_program_has_it_open(self):
        file = self.copy(short())
        with h5py.File(file, "r+"):
            for command in (["replay", file], ["inspect", file], ["recover", file, "-o", self.path("o.h5")]):
                self.refused(1, *command, names=(file, "program"))
        self.well("replay", file)


class Machine(program.ProgramTest):
    def record(self, **more):
        return calot("record", "--scene", program.SCENE, "--performer", "skilled", "--seconds", 0.1, "-o", self.path("r.h5"), **more)

    def test_no_home_and_zones_that_are_none(self):
        for change in ({"HOME": ""}, {"HOME": "/nonexistent"}, {"TZ": "Nowhere/None"}, {"TZ": ":/etc/shadow"}):
            with self.subTest(str(change)):
                environment = {**change, "CALOT_CACHE": "", "XDG_CACHE_HOME": ""}
                answer = self.record(environment=environment)
                self.assertEqual((answer.code, answer.err), (0, ""), answer)
                self.well("assess", self.path("r.h5"), "--cohort", self.path("c.db"), environment=environment)
                self.path("r.h5").unlink()

    def test_a_disk_for_reading_alone(self):
        disk = self.path("disk")
        disk.mkdir()
        (disk / "r.h5").write_bytes(short().read_bytes())
        script = 'mount --bind "$0" "$0" && mount -o remount,bind,ro "$0" && shift 0; exec "$@"'
        inside = lambda *arguments: subprocess.run(["unshare", "-rm", "sh", "-c", script, str(disk), str(program.PROGRAM), *map(str, arguments)],
                                                   capture_output=True, text=True, check=False)
        if subprocess.run(["unshare", "-rm", "sh", "-c", script, str(disk), "true"], capture_output=True, check=False).returncode:
            self.skipTest("no file system can be mounted here")
        self.assertEqual(inside("replay", disk / "r.h5").returncode, 0)
        for arguments in writers(disk / "o.png", short()).values():
            done = inside(*arguments)
            answer = program.Answer(done.returncode, done.stdout, done.stderr)
            self.assertEqual(answer.code, 1, answer)
            self.assertOneLine(answer, disk, "Read-only file system")
        done = inside("assess", disk / "r.h5", "--cohort", disk / "c.db")
        self.assertEqual(done.returncode, 1, done)


class Stopped(program.ProgramTest):
    def test_a_terminal_that_goes_ends_an_attempt(self):
        file = self.path("r.h5")
        process = subprocess.Popen([str(program.PROGRAM), "record", "--scene", program.SCENE, "--performer", "skilled", "--paced", "-o", str(file)],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        recording_file.await_steps(file, process)
        process.send_signal(signal.SIGHUP)
        self.assertEqual((process.wait(program.PATIENCE), process.stderr.read()), (0, b""))
        process.stderr.close()
        self.assertIn("stopped", self.well("inspect", file).out)
        self.assertIn("bit-exact", self.well("replay", file).out)

    @staticmethod
    def catches(process, number):
        with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
            [mask] = [line.split()[1] for line in status if line.startswith("SigCgt:")]
        return bool(int(mask, 16) >> (number - 1) & 1)

    def test_before_the_first_step_nothing_is_left(self):
        process = subprocess.Popen([str(program.PROGRAM), "record", "--scene", program.SCENE, "--performer", "skilled", "-o", str(self.path("r.h5"))],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, "CALOT_CACHE": "off"})
        while process.poll() is None and not self.catches(process, signal.SIGTERM):  # while the scene is prepared
            time.sleep(0.001)
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=program.PATIENCE)
        answer = program.Answer(process.returncode, out, err)
        self.assertEqual(answer.code, 1, answer)
        self.assertOneLine(answer, self.path("r.h5"), "first step")
        self.assertEqual(os.listdir(self.folder), [])


if __name__ == "__main__":
    program.main()
