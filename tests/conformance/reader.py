#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a recording by schemas/recording.md alone, and prints it in the layout of expected.json.

usage: reader.py RECORDING
"""
import hashlib
import json
import sys

import h5py
import numpy as np

ATTRIBUTES = """format format_version attempt_uuid parent_uuid fork_step start_utc software build simulation_version step_result_version participant
operator_kind performer_profile performer_version source_file source_sha256 device calibration station mode purpose handedness seed tick_seconds ticks_per_step
scene_name scene_major scene_minor""".split()
STREAMS = (("/ticks/", "ticks"), ("/camera/", "ticks"), ("/steps/", "steps"), ("/observables/", "steps"))
NAMES = ("/scene/organs", "/scene/vessels", "/scene/fat", "/steps/component_names", "/steps/field_names")


def plain(value):
    return value.decode() if isinstance(value, bytes) else value.item() if hasattr(value, "item") else value


def strings(file, path):
    return [text.decode() for text in file[path][:]] if path in file else []


def sha(data):
    return hashlib.sha256(data).hexdigest()


def column(data, rows):
    values = data[:rows]
    ends = {"first": values[0].tolist(), "last": values[-1].tolist()} if rows else {}
    return {"type": f"{values.dtype.kind}{values.dtype.itemsize}", "shape": list(values.shape), "sha256": sha(values.tobytes()), **ends}


def quaternion_word(x, y, z):
    x, y, z = np.array([x, y, z], "<u8").view("<f8")
    under = 1.0 - ((x * x + y * y) + z * z)
    return int(np.sqrt(under).view("<u8")) if under > 0.0 else 0


def following(form, n):
    """Of a part of 1 + n words: those that follow from others, each with these."""
    if form == 1 and n % 4 == 0:
        return {w: (w - 3, w - 2, w - 1) for w in range(4, n + 1, 4)}
    if form == 2 and n % 32 == 0:
        return {g + i: (g + 8 + i, g + 16 + i, g + 24 + i) for g in range(1, n + 1, 32) for i in range(8)}
    m = round(n**0.5)
    return {1 + r * m + c: (1 + c * m + r,) for r in range(m) for c in range(r)} if form == 3 and m * m == n else {}


def decoded(words, earlier):
    """The bytes of a coded keyframe. earlier: bytes of those before it, by number."""
    base, at, out = earlier[words[0] - 1] if words[0] else b"", 2 + 4 * words[1], []
    for length, place, like, form in (words[2 + 4 * p:6 + 4 * p] for p in range(words[1])):
        old, size = base[place:place + like], 0 if form == 4 else -(-length // 8)
        if form == 4:
            out.append(old)
            continue
        change = [z >> 1 ^ -(z & 1) for z in words[at:at + size]]
        part = [(a + b) % (1 << 64) for a, b in zip(change, np.frombuffer(old + bytes(8 * size - len(old)), "<u8").tolist())]
        for w, others in (following(form, size - 1) if length % 8 == 0 and size > 1 else {}).items():
            b = part[others[0]] if form == 3 else quaternion_word(*(part[o] for o in others))
            part[w] = (b + change[w]) % (1 << 64)
        out.append(np.array(part, "<u8").tobytes()[:length])
        at += size
    return b"".join(out)


def keyframes(file, status):
    index, words = file["/keyframes/index"][:status["keyframes"]], file["/keyframes/bytes"][:status["keyframe_words"]]
    coded, done = file.attrs["format_version"] > 1, {}
    ends = [int(o) for o in index["offset"][1:]] + [8 * len(words)]
    for i, (row, end) in enumerate(zip(index, ends)):
        start, total = int(row["offset"]), int(row["state_bytes"] + row["haptics_bytes"])
        done[i] = decoded(words[start // 8:end // 8].tolist(), done) if coded else words.tobytes()[start:start + total]
        state = done[i][:int(row["state_bytes"])]
        yield {"step": int(row["step"]), "state": sha(state), "haptics": sha(done[i][len(state):total])}


def read(path):
    with open(path, "rb") as raw:
        writing = raw.read(12)[11] & 5  # a killed writer's mark: HDF5 File Format Specification, superblock
    with h5py.File(path, "r", **({"libver": "latest", "swmr": True} if writing else {})) as file:
        status = file["/status"][-1]
        out = {"attributes": {name: plain(file.attrs[name]) for name in ATTRIBUTES}, "complete": bool(status["completed"]), "outcome": int(status["outcome"]),
               "counts": {name: int(status[name]) for name in ("ticks", "steps", "events", "keyframes")}, "chain": status["chain"].tobytes().hex(),
               "names": {path: strings(file, path) for path in NAMES if path in file}, "datasets": {},
               "assets": [{"name": plain(a.attrs["name"]), "sha256": sha(a[:].tobytes())} for a in (file["/scene/description"], *file["/scene/assets"].values())]}
        paths = []
        file.visititems(lambda name, thing: paths.append("/" + name) if isinstance(thing, h5py.Dataset) else None)
        for prefix, stream in STREAMS:
            for p in paths:
                if p.startswith(prefix) and p not in ("/steps/component_names", "/steps/field_names", "/steps/field_component"):
                    out["datasets"][p] = column(file[p], int(status[stream]))
        out["events"] = [dict(zip(row.dtype.names, (v.tolist() for v in row))) for row in file["/events"][:status["events"]]]
        out["keyframes"] = list(keyframes(file, status)) if "/keyframes" in file else []
        if "/device" in file:
            counts = file["/device/counts"][len(file["/status"]) - 1]
            out["device"] = {hand: {"rows": int(counts[hand]), "sha256": sha(file[f"/device/{hand}/samples"][:counts[hand]].tobytes())} for hand in ("left", "right")}
        if "/signature" in file:
            out["signature"] = {"public_key": file["/signature/public_key"][:].tobytes().hex(), "value": file["/signature/value"][:].tobytes().hex()}
    return out


if __name__ == "__main__":
    json.dump(read(sys.argv[1]), sys.stdout, indent=1)
