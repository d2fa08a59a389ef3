# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds a recording against the pages schemas/recording*.md and schemas/observables.md, knowing nothing but these pages.

Every name that the pages require is there with the type, shape, chunk and filters they say; nothing is there that they do not
name; and the content chain, computed anew as the page tells, gives the heads that the file holds.

Usage: schema_names.py SCHEMAS RECORDING.h5   (exit 0: agrees; 1: differs, one line each; 77: h5py is not installed)
"""

import hashlib
import re
import struct
import sys

try:
    import h5py
    import numpy as np
except ImportError:
    print("h5py or numpy is not installed")
    sys.exit(77)

TYPES = {"u1": "<u1", "u2": "<u2", "u4": "<u4", "u8": "<u8", "i8": "<i8", "f4": "<f4", "f8": "<f8"}
COLUMNS = ["name", "kind", "type", "shape", "unit", "chunk", "filters", "presence", "meaning"]


def rows_of(path):
    """The rows of every table of a page whose first cell is a name in backticks."""
    rows = []
    with open(path, encoding="utf-8") as page:
        for line in page:
            if not line.startswith("| `/"):
                continue
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            if len(cells) != len(COLUMNS):
                raise SystemExit(f"{path}: a table row has {len(cells)} cells: {line.strip()}")
            row = dict(zip(COLUMNS, cells))
            row["name"] = row["name"].strip("`")
            rows.append(row)
    return rows


def expanded(rows):
    """<hand> stands for left and right: all rows of left, then all rows of right, where such rows stand together."""
    out, group = [], []

    def flush():
        for hand in ("left", "right"):
            out.extend({**row, "name": row["name"].replace("<hand>", hand)} for row in group)
        group.clear()

    for row in rows:
        if "<hand>" in row["name"]:
            group.append(row)
        else:
            flush()
            out.append(row)
    flush()
    return out


def pattern(name):
    return re.compile("^" + re.escape(name).replace("<NNN>", r"\d{3}") + "$")


def found_names(file):
    """Every group, data set, attribute and compound member of a file, as the pages write names."""
    names = {}

    def attributes(prefix, thing):
        for key in thing.attrs:
            names[f"{prefix}@{key}"] = ("attribute", thing.attrs.get_id(key))

    def visit(name, thing):
        path = "/" + name
        kind = "group" if isinstance(thing, h5py.Group) else "dataset"
        names[path] = (kind, thing)
        attributes(path, thing)
        if kind == "dataset" and thing.dtype.names:
            for member in thing.dtype.names:
                names[f"{path}:{member}"] = ("member", thing.dtype[member])

    attributes("/", file)
    file.visititems(visit)
    return names


def is_fixed_string(dtype):
    return dtype.kind == "S" and h5py.check_string_dtype(dtype).length is not None


PAGES = ("recording", "recording-device", "recording-integrity", "observables")

# What a golden recording goes without.
NOT_GOLDEN = re.compile(r"^/(observables|keyframes|steps/(state|field)_digest)|^/ticks/(left|right|<hand>)/(force|torque)$")


class Checker:
    def __init__(self, file, rows):
        self.file, self.rows, self.faults = file, rows, []
        count = lambda name: file[name].shape[0] if name in file else 0
        version = int(file.attrs["step_result_version"])
        components = list(file["/steps/component_names"][()]) if "/steps/component_names" in file else []
        organs, vessels, fat = count("/scene/organs"), count("/scene/vessels"), count("/scene/fat")
        self.counts = {"O": organs, "V": vessels, "A": fat, "S": organs + vessels + fat, "C": len(components),
                       "F": count("/steps/field_names"), "V2": version >= 2, "V3": version >= 3,
                       "O3": organs if version >= 3 else 0, "P": int(version == 3 and b"procedure" in components),
                       "O4": organs if version >= 4 else 0, "T4": vessels if version >= 4 else 0,
                       "A4": fat if version >= 4 else 0, "V5": version >= 5, "T5": vessels if version >= 5 else 0,
                       "V6": version >= 6, "A7": fat if version >= 7 else 0,
                       "D": int("/device" in file), "G": int(as_text(file.attrs["purpose"]) == b"golden"),
                       "K": sum(name.startswith(b"connective.") for name in components) if version >= 2 else 0}
        golden = self.counts["G"]
        self.counts |= {"H": 1 - golden, "GC": golden * len(components), "HF": (1 - golden) * self.counts["F"]}
        self.counts["K4"] = self.counts["K"] if version >= 4 else 0
        if version < 3 and vessels + fat > 0:
            self.fault(f"/scene: version {version} has neither vessels nor fat")
        ticks = int(file.attrs["ticks_per_step"])
        self.block = max(1, 250 // ticks)
        self.ticks = ticks

    def fault(self, text):
        self.faults.append(text)

    def check(self):
        found = found_names(self.file)
        patterns = [(pattern(row["name"]), row) for row in self.rows]
        for name, (kind, thing) in found.items():
            row = next((r for p, r in patterns if p.match(name)), None)
            if row is None:
                self.fault(f"{name}: is in the file and not in the schema")
            elif row["kind"] != kind:
                self.fault(f"{name}: is a {kind}, not a {row['kind']}")
            else:
                self.thing(name, kind, thing, row)
        for p, row in patterns:
            if self.counts["G"] and NOT_GOLDEN.match(row["name"]):
                if any(p.match(name) for name in found):
                    self.fault(f"{row['name']}: is in a golden recording")
                continue
            needed = row["presence"] == "required" or (
                row["presence"].startswith("required if ") and self.counts[row["presence"].split()[-1]] > 0)
            if row["presence"] not in ("required", "optional") and not row["presence"].startswith("required if "):
                self.fault(f"{row['name']}: the schema does not say whether it is required")
            if needed and not any(p.match(name) for name in found):
                self.fault(f"{row['name']}: is required and not in the file")
            if row["presence"].startswith("required if ") and not needed and any(p.match(name) for name in found):
                self.fault(f"{row['name']}: is in the file, though {row['presence'].split()[-1]} is 0")

    def thing(self, name, kind, thing, row):
        if kind == "group":
            return
        dtype = thing if kind == "member" else thing.dtype
        if kind == "member" and dtype.subdtype:
            if row["shape"] != "(" + ", ".join(map(str, dtype.subdtype[1])) + ")":
                self.fault(f"{name}: has shape {dtype.subdtype[1]}")
            dtype = dtype.subdtype[0]
        if row["type"] == "str":
            if not is_fixed_string(dtype):
                self.fault(f"{name}: is no fixed-length string")
        elif row["type"].startswith("compound"):
            if not dtype.names or f"{dtype.itemsize} bytes" not in row["type"]:
                self.fault(f"{name}: is no compound of {row['type']}")
            listed = [r["name"].split(":")[1] for r in self.rows if r["name"].startswith(name + ":")]
            if list(dtype.names or []) != listed:
                self.fault(f"{name}: members are {dtype.names}, the schema says {listed}")
        elif dtype != np.dtype(TYPES[row["type"]]):
            self.fault(f"{name}: has type {dtype}, not {row['type']}")
        if kind == "attribute" and thing.shape != ():
            self.fault(f"{name}: is no scalar")
        if kind == "dataset":
            self.dataset(name, thing, row)

    def dataset(self, name, thing, row):
        shape = [part.strip() for part in row["shape"].strip("()").split(",")]
        if len(shape) != len(thing.shape):
            self.fault(f"{name}: has rank {len(thing.shape)}, not {len(shape)}")
            return
        for size, said in zip(thing.shape, shape):
            wanted = int(said) if said.isdigit() else self.counts.get(said)
            if wanted is not None and size != wanted:
                self.fault(f"{name}: has shape {thing.shape}, the schema says {row['shape']}")
        chunk = row["chunk"]
        wanted = {"B": self.block, "B T": self.block * self.ticks}.get(chunk)
        if chunk in self.counts:
            wanted = self.counts[chunk]
        if chunk.isdigit():
            wanted = int(chunk)
        if chunk.startswith("up to"):
            wanted = min(int(chunk.split()[-1]), max(1, thing.shape[0]))
        if thing.chunks is None or wanted != thing.chunks[0]:
            self.fault(f"{name}: has chunks {thing.chunks}, the schema says {chunk}")
        packed = thing.shuffle and thing.compression == "gzip" and thing.compression_opts == 6
        if not thing.fletcher32 or packed != (row["filters"] == "SDF") or (thing.compression is not None) != packed:
            self.fault(f"{name}: has other filters than {row['filters']}")


def string(text):
    data = text if isinstance(text, bytes) else text.encode()
    return struct.pack("<I", len(data)) + data


def as_text(value):
    return (value if isinstance(value, bytes) else bytes(value)).rstrip(b"\0")


def counts_of(row):
    return struct.pack("<QQQQQBB", *(int(row[k]) for k in (
        "ticks", "steps", "events", "keyframes", "keyframe_words", "completed", "outcome")))


def blake(data):
    return hashlib.blake2b(data, digest_size=32).digest()


def chain_heads(file, rows):
    """Head after each row of /status, computed anew; each from the computed one before it."""
    status = file["/status"][:]
    data = b"calot-recording-chain-1"
    for row in rows:
        if not row["name"].startswith("/@"):
            continue
        key = row["name"][2:]
        raw = file.attrs.get_id(key)
        data += string(key)
        if row["type"] == "str":
            value = np.zeros((), dtype=raw.dtype)
            raw.read(value)
            data += string(as_text(value.tobytes()))
        else:
            data += np.asarray(file.attrs[key]).astype(TYPES[row["type"]]).tobytes()
    assets = [file["/scene/description"]] + [file["/scene/assets"][k] for k in sorted(file["/scene/assets"])]
    data += struct.pack("<Q", len(assets))
    for asset in assets:
        name = np.zeros((), dtype=asset.attrs.get_id("name").dtype)
        asset.attrs.get_id("name").read(name)
        data += string(as_text(name.tobytes())) + struct.pack("<Q", asset.shape[0]) + asset[:].tobytes()
    names = lambda path: [as_text(n) for n in file[path][:]] if path in file else []
    organs, components, fields = names("/scene/organs"), names("/steps/component_names"), names("/steps/field_names")
    data += struct.pack("<Q", len(organs)) + b"".join(map(string, organs))
    if int(file.attrs["step_result_version"]) >= 3:
        for more in (names("/scene/vessels"), names("/scene/fat")):
            data += struct.pack("<Q", len(more)) + b"".join(map(string, more))
    data += struct.pack("<Q", len(components)) + b"".join(map(string, components))
    data += struct.pack("<Q", len(fields))
    for component, name in zip(file["/steps/field_component"][:] if fields else [], fields):
        data += struct.pack("<I", component) + string(name)
    head = blake(data + counts_of(status[0]))
    yield head

    stream = lambda path: ("ticks" if path.startswith(("/ticks", "/camera")) else
                           "steps" if path.startswith(("/steps", "/observables")) else
                           {"/events": "events", "/keyframes/index": "keyframes", "/keyframes/bytes": "keyframe_words"}[path])
    chained = [f"/ticks/{hand}/{name}" for hand in ("left", "right") for name in (
        "position", "orientation", "instrument", "jaw", "buttons", "valid", "contact_set", "force", "torque")]
    chained += ["/camera/position", "/camera/orientation", "/steps/component_digest", "/steps/state_digest", "/steps/field_digest", "/steps/force_digest"]
    chained += [r["name"] for r in rows if r["name"].startswith("/observables") and r["kind"] == "dataset"]
    chained += ["/events", "/keyframes/index", "/keyframes/bytes"]
    for k in range(1, len(status)):
        data = [head]
        for path in chained:
            if path not in file:
                continue
            first, end = int(status[k - 1][stream(path)]), int(status[k][stream(path)])
            data += [string(path), struct.pack("<QQ", first, end - first), file[path][first:end].tobytes()]
        head = blake(b"".join(data) + counts_of(status[k]))
        yield head


def chain_faults(file, rows):
    """Heads computed anew, against /status."""
    status = file["/status"][:]
    for k, head in enumerate(chain_heads(file, rows)):
        if head != status[k]["chain"].tobytes():
            return [f"/status: row {k}: the head is another one than the page tells to compute"]
    return []


def names_of(schemas):
    """All rows of the pages of a folder that describe recordings."""
    return [row for page in PAGES for row in expanded(rows_of(f"{schemas}/{page}.md"))]


def main():
    schemas, recording = sys.argv[1:3]
    rows = names_of(schemas)
    if len(rows) < 80:
        print(f"only {len(rows)} names found in the pages")
        return 1
    with h5py.File(recording, "r") as file:
        checker = Checker(file, rows)
        checker.check()
        faults = checker.faults + chain_faults(file, rows)
    for fault in faults:
        print(fault)
    print(f"{len(rows)} names of the schema, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
