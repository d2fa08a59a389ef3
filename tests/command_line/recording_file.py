# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes recordings as a stranger would: with h5py and what schemas/recording.md says, or byte by byte."""

import time

import h5py
import numpy as np

import program
import schema_names


def reseal(file):
    """Computes the content chain of an open recording anew, so that the file is at one with itself."""
    rows = schema_names.names_of(str(program.SOURCE / "schemas"))
    heads = list(schema_names.chain_heads(file, rows))
    for k, head in enumerate(heads):
        row = file["/status"][k]
        row["chain"] = np.frombuffer(head, dtype="u1")
        file["/status"][k] = row


def put_attribute(thing, name, value):
    """Another value for an attribute, in the very type it has."""
    attribute = thing.attrs.get_id(name)
    attribute.write(np.asarray(value, dtype=attribute.dtype))


def set_attribute(path, name, value):
    """Another value for a root attribute of a file, and the chain made to fit."""
    with h5py.File(path, "r+") as file:
        put_attribute(file, name, value)
        reseal(file)


def flip_stored_byte(path, dataset, row):
    """Turns one bit in the middle of the stored (packed, checksummed) chunk that holds a row."""
    with h5py.File(path, "r") as file:
        data = file[dataset].id
        chunks = [data.get_chunk_info(i) for i in range(data.get_num_chunks())]
        chunk = max((c for c in chunks if c.chunk_offset[0] <= row), key=lambda c: c.chunk_offset[0])
    with open(path, "r+b") as raw:
        raw.seek(chunk.byte_offset + chunk.size // 2)
        byte = raw.read(1)[0]
        raw.seek(chunk.byte_offset + chunk.size // 2)
        raw.write(bytes([byte ^ 0x10]))


def last_status(path, swmr=False):
    """Last row of /status of a file; of one whose writer was killed as an SWMR reader."""
    more = {"libver": "latest", "swmr": True} if swmr else {}
    with h5py.File(path, "r", **more) as file:
        return file["/status"][-1]


def await_steps(path, process):
    """Returns once steps of the recording that a process writes have been flushed; how late that is, the machine decides."""
    end = time.monotonic() + program.PATIENCE
    while True:
        try:
            if last_status(path, swmr=True)["steps"] > 0:
                return
        except OSError:  # not there yet
            pass
        if process.poll() is not None or time.monotonic() > end:
            raise AssertionError(f"{path}: nothing is recorded, exit {process.poll()}")
        time.sleep(0.01)
