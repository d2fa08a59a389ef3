# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes recordings as a stranger would: with h5py and what schemas/recording.md says, or byte by byte."""

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


def set_attribute(path, name, value):
    """A root attribute of the same type with another value, and the chain with it."""
    with h5py.File(path, "r+") as file:
        file.attrs.modify(name, np.asarray(value, dtype=file.attrs[name].dtype))
        reseal(file)


def flip_stored_byte(path, dataset, row):
    """Turns one bit of the stored (packed, checksummed) chunk that holds a row. Returns the chunk's number."""
    with h5py.File(path, "r") as file:
        data = file[dataset]
        chunk = row // data.chunks[0]
        info = data.id.get_chunk_info_by_coord((chunk * data.chunks[0],) + (0,) * (len(data.shape) - 1))
        offset, size = info.byte_offset, info.size
    with open(path, "r+b") as raw:
        raw.seek(offset + size // 2)
        byte = raw.read(1)[0]
        raw.seek(offset + size // 2)
        raw.write(bytes([byte ^ 0x10]))
    return chunk


def last_status(path, swmr=False):
    """Last row of /status of a file; of one whose writer was killed as an SWMR reader."""
    more = {"libver": "latest", "swmr": True} if swmr else {}
    with h5py.File(path, "r", **more) as file:
        return file["/status"][-1]
