#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the recordings of the conformance set with the product's own commands, and expected.json with what its Python module says of them.

usage: make_conformance.py CALOT [--expected]

CALOT: the program. --expected: writes expected.json alone, from the recordings that are there. The module is found as usual (PYTHONPATH).
"""
import hashlib
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import calot

HERE = pathlib.Path(__file__).resolve().parent
OLD = "../recorder/recording/data"
FILES = {"whole": "recordings/whole.h5", "incomplete": "recordings/incomplete.h5", "golden": "recordings/golden.h5", "format-1": f"{OLD}/format-1.h5",
         "step-result-3": f"{OLD}/step-result-3.h5"}
SIDE, QUADS = 0.03, 3  # of the block (m), along an edge


def write_block(path):
    """The surface of a cube, outward."""
    number, triangles = {}, []
    for axis in range(3):
        for level in (0, QUADS):
            for i in range(QUADS):
                for j in range(QUADS):
                    corners = []
                    for u, w in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        place = [0, 0, 0]
                        place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3] = level, u, w
                        corners.append(number.setdefault(tuple(place), len(number) + 1))
                    a, b, c, d = corners if level else corners[::-1]
                    triangles += [(a, b, c), (a, c, d)]
    points = ["v " + " ".join(f"{(x / QUADS - 0.5) * SIDE:.6g}" for x in place) for place in number]
    path.write_text("\n".join(points + [f"f {a} {b} {c}" for a, b, c in triangles]) + "\n")


def write_scene(folder):
    """A soft block under two graspers: small files, and all that a scene of organs has."""
    (folder / "scenes").mkdir()
    (folder / "organs").mkdir()
    write_block(folder / "organs/block.obj")
    material = {"youngModulus": 5200, "poissonRatio": 0.45, "density": 1060, "massDamping": 0, "stiffnessDamping": 0.01}
    scene = {"format": "calot-scene", "formatVersion": 1, "name": "conformance", "version": {"major": 1, "minor": 0},
             "summary": "A soft block, for readers of recordings.", "ticksPerStep": 10, "timeLimit": 0, "gravity": [0, -9.218, -3.355],
             "workspace": {"lower": [-0.1, -0.1, -0.1], "upper": [0.1, 0.1, 0.1]},
             "camera": {"position": [0, 0.05, -0.1], "target": [0, 0, 0], "up": [0, 1, 0], "verticalFieldOfView": 1.0},
             "hands": {"left": {"port": [0.05, 0.09, -0.03], "home": [0.02, 0.03, 0], "instrument": "grasper"},
                       "right": {"port": [-0.05, 0.09, -0.03], "home": [-0.005, 0.03, 0], "instrument": "grasper"}},
             "organs": [{"name": "block", "appearance": "liver", "role": "liver", "mesh": {"file": "organs/block.obj", "unit": "m"}, "tetrahedra": 100,
                         "material": material, "anchors": [{"sphere": {"centre": [0, -0.015, 0], "radius": 0.012}}]}]}
    path = folder / "scenes/conformance.json"
    path.write_text(json.dumps(scene, indent=1) + "\n")
    return path


def write_script(path):
    """Device samples: the right hand presses on the block and comes back; the left one is still. A few are invalid, a few held by the clutch."""
    down = [0.0, 0.894, 0.447]  # of W, in the camera's frame
    samples = []
    for n in range(240):
        depth = 0.02 * (1.0 - abs(n - 120) / 120)
        samples.append([n / 100, 0, 0.0, 0.0, 0.0, 1, 0, 0, 0, 0.2, 0, 1])
        buttons, valid = (128 if 200 <= n < 210 else 0), 0 if 60 <= n < 64 else 1
        samples.append([n / 100, 1, *(depth * d for d in down), 1, 0, 0, 0, 0.4, buttons, valid])
    path.write_text(json.dumps({"format": "calot-device-script", "formatVersion": 1, "name": "press", "rate": 100, "samples": samples}) + "\n")
    return path


def make(program):
    def run(*arguments):
        subprocess.run([program, *map(str, arguments)], check=True)

    (HERE / "recordings").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene, key = write_scene(folder), folder / "station.json"
        run("station", "init", "conformance", "-o", key)
        run("record", "--scene", scene, "--device", f"scripted:{write_script(folder / 'press.json')}", "--station-key", key, "--participant", "P-1", "--seconds", 2.3,
            "--handedness", "right", "-o", HERE / FILES["whole"], "--force")
        run("record", "--scene", scene, "--performer", "skilled", "--purpose", "golden", "--seconds", 0.5, "-o", HERE / FILES["golden"], "--force")
        killed = HERE / FILES["incomplete"]
        killed.unlink(missing_ok=True)
        writer = subprocess.Popen([program, "record", "--scene", scene, "--performer", "unskilled", "--seed", "3", "--paced", "-o", killed], stdout=subprocess.DEVNULL)
        while not killed.exists():
            time.sleep(0.001)
        time.sleep(0.9)
        writer.send_signal(signal.SIGKILL)
        writer.wait()


def sha(data):
    return hashlib.sha256(data).hexdigest()


def expected(path):
    r = calot.open(path)
    out = {"attributes": r.header, "complete": r.complete, "outcome": ["running", "completed", "time limit", "abandoned", "stopped", "technical failure"].index(r.outcome),
           "counts": {"ticks": r.ticks, "steps": r.steps, "events": len(r.events), "keyframes": len(r.keyframe_steps)}, "chain": r.chain_head.hex(), "datasets": {}, "units": {}}
    for name, values in r.items():
        if name == "/events":
            continue
        out["datasets"][name] = {"type": f"{values.dtype.kind}{values.dtype.itemsize}", "shape": list(values.shape), "first": values[0].tolist(), "last": values[-1].tolist(),
                                 "sha256": sha(values.tobytes())}
        out["units"][name] = r.units[name]
    out["events"] = [dict(zip(row.dtype.names, (v.tolist() for v in row))) for row in r.events]
    frames = [r.keyframe(i) for i in range(len(r.keyframe_steps))]
    out["keyframes"] = [{"step": step, "state": sha(state), "haptics": sha(haptics)} for step, state, haptics in frames]
    if r.header["device"]:
        out["device"] = {hand: {"rows": len(samples), "sha256": sha(samples.tobytes())} for hand, samples in r.device_samples.items()}
    if r.signature:
        out["signature"] = {"public_key": r.signature.public_key.hex(), "value": (r.signature.value or b"").hex(), "valid": r.signature.valid}
    return out


def main():
    if "--expected" not in sys.argv[2:]:
        make(sys.argv[1])
    said = {"files": FILES, "optional": ["units", "keyframes", "signature.valid"], "recordings": {name: expected(HERE / file) for name, file in FILES.items()}}
    (HERE / "expected.json").write_text(json.dumps(said, indent=None, separators=(",", ":")).replace('},"/', '},\n"/').replace('},"', '},\n"') + "\n")


if __name__ == "__main__":
    main()
