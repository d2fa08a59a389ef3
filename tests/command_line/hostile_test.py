# SPDX-License-Identifier: GPL-3.0-or-later
"""Files made to hang: what has not the shape of a recording is refused before a byte of its data is read, what takes too much is ended."""

import os
import struct
import time
import zlib

import h5py
import numpy as np
import program
from program import calot, short

PLENTY = 20  # s; a minute is the limit of a child


def bomb(mebibytes):
    """A zlib stream (RFC 1950) of so many MiB of zeros: one deflated block again and again."""
    squeeze = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = squeeze.compress(bytes(1 << 20)) + squeeze.flush(zlib.Z_FULL_FLUSH)
    end = zlib.compressobj(9, zlib.DEFLATED, -15).flush()
    size = mebibytes << 20
    return b"\x78\xda" + block * mebibytes + end + struct.pack(">I", ((size % 65521) << 16) + 1)


class FilesMadeToHang(program.ProgramTest):
    def changed(self, change, name="r.h5"):
        r = self.copy(short(), name)
        with h5py.File(r, "r+") as file:
            change(file)
        return r

    def refusedSoon(self, r, *names, commands=None):
        for command in commands or (("replay", r), ("inspect", r), ("assess", r, "--cohort", self.path("c.db")), ("recover", r, "-o", self.path("o.h5")),
                                    ("render", r, "-o", self.path("o.png")), ("state", r, "--step", 1, "-o", self.path("s.h5"))):
            with self.subTest(command[0]):
                begin = time.monotonic()
                answer = calot(*command)
                self.assertEqual(answer.code, 4, answer)
                self.assertLess(time.monotonic() - begin, PLENTY)
                for name in (r, *names):
                    self.assertIn(str(name), answer.out + answer.err)
                self.assertNothingHalfWritten()

    def test_links_to_other_places(self):
        pipe = self.path("pipe")
        os.mkfifo(pipe)

        def external(file):
            del file["/ticks/left/jaw"]
            file["/ticks/left/jaw"] = h5py.ExternalLink(str(pipe), "/jaw")

        def unasked(file):
            file["/notes"] = h5py.ExternalLink(str(pipe), "/notes")

        def soft(file):
            del file["/ticks/left/jaw"]
            file["/ticks/left/jaw"] = h5py.SoftLink("/ticks/right/jaw")

        for change, words in ((external, ("/ticks/left/jaw", "link to another file")), (unasked, ("/notes", "link to another file")),
                              (soft, ("/ticks/left/jaw", "soft link"))):
            with self.subTest(change.__name__):
                self.refusedSoon(self.changed(change), *words)

    def test_data_in_other_files(self):
        pipe = self.path("pipe")
        os.mkfifo(pipe)

        def stored(file):
            del file["/ticks/left/jaw"]
            file.create_dataset("/ticks/left/jaw", (500,), "f8", external=[(str(pipe), 0, h5py.h5f.UNLIMITED)])

        def virtual(file):
            del file["/ticks/left/jaw"]
            layout = h5py.VirtualLayout((500,), "f8")
            layout[:] = h5py.VirtualSource(str(pipe), "jaw", (500,))
            file.create_virtual_dataset("/ticks/left/jaw", layout)

        self.refusedSoon(self.changed(stored), "/ticks/left/jaw", "in other files")
        self.refusedSoon(self.changed(virtual), "/ticks/left/jaw", "made of other data sets")

    def test_many_names_of_one_data_set(self):
        def assets(file):
            for i in range(2, 1000):
                if f"{i:03}" not in file["/scene/assets"]:
                    file[f"/scene/assets/{i:03}"] = file["/scene/assets/001"]

        def itself(file):
            file["/scene/assets/scene"] = file["/scene"]

        def many(file):
            group = file.create_group("/notes")
            for i in range(5000):
                group.create_group(f"{i}")

        self.refusedSoon(self.changed(assets), "/scene/assets/", "second name")
        self.refusedSoon(self.changed(itself), "second name")
        self.refusedSoon(self.changed(many), "/notes", "5000 names")

    def test_chunks_that_unfold(self):
        def declared(file):
            del file["/ticks/left/jaw"]
            file.create_dataset("/ticks/left/jaw", (500,), "f8", maxshape=(None,), chunks=((1 << 29) - 1,), compression="gzip")

        def stored(file):
            # A chunk of 250 rows, whose deflated bytes do not end there.
            file["/ticks/left/jaw"].id.write_direct_chunk((0,), bomb(1536), filter_mask=0b101)

        self.refusedSoon(self.changed(declared), "/ticks/left/jaw", "chunks of 42949672", "at most 4194304")
        r = self.changed(stored)
        self.refusedSoon(r, "needs more than 1024 MiB of memory", commands=(("replay", r), ("inspect", r), ("assess", r, "--cohort", self.path("c.db"))))

    def test_extents_and_names_without_end(self):
        def extent(file):
            file["/ticks/left/jaw"].resize(1 << 50, axis=0)

        def names(file):
            del file["/steps/field_names"]
            file.create_dataset("/steps/field_names", (65536,), h5py.string_dtype("utf-8", 1024), chunks=(1024,), compression="gzip")

        def structures(file):
            del file["/scene/organs"]
            file.create_dataset("/scene/organs", (1,), h5py.string_dtype("utf-8", 1 << 30))

        def variable(file):
            file.create_dataset("/notes", data=["a"], dtype=h5py.string_dtype())

        for change, words in ((extent, ("/ticks/left/jaw", "more bytes than the file can hold")), (names, ("/steps/field_names", "at most 1048576")),
                              (structures, ("/scene/organs",)), (variable, ("/notes", "variable length"))):
            with self.subTest(change.__name__):
                self.refusedSoon(self.changed(change), *words)

    def test_what_is_only_unknown_is_ignored(self):
        def added(file):
            file.create_group("/later").create_dataset("values", data=np.arange(10.0))
            file.attrs["later"] = 1

        r = self.changed(added)
        self.assertIn("bit-exact", self.well("replay", r).out)


if __name__ == "__main__":
    program.main()
