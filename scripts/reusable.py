#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Says whether a recording is what this build would record again: exit 0, or 1 with the reason on stdout.

Compares what the recording itself holds: simulation version, scene and assets byte for byte, performer's profile and version,
seed, and whether it is complete and was neither stopped nor failed.
"""
import argparse
import hashlib
import json
import pathlib
import re
import sys

import h5py


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def reason_against(path, root, scene, performer, seed):
    """Why it cannot be used again, or None."""
    if not path.exists():
        return "new"
    try:
        with h5py.File(path, "r") as file:
            version = re.search(r"simulationVersion = (\d+)", (root / "sim/scene/version.h").read_text()).group(1)
            if int(file.attrs["simulation_version"]) != int(version):
                return f"simulation version {file.attrs['simulation_version']} there, {version} here"
            profile = json.loads((root / f"assets/performers/{performer}.json").read_text())
            if text(file.attrs["performer_profile"]) != performer:
                return "another performer"
            if text(file.attrs["performer_version"]) != str(profile["version"]):
                return f"performer's version {text(file.attrs['performer_version'])} there, {profile['version']} here"
            if int(file.attrs["seed"]) != seed:
                return "another seed"
            if not len(file["status"]) or not int(file["status"][-1]["completed"]):
                return "incomplete"
            if int(file["status"][-1]["outcome"]) in (4, 5):
                return "stopped from outside, or failed"
            stored = [(root / f"assets/scenes/{scene}.json", file["scene/description"])]
            stored += [(root / "assets" / text(asset.attrs["name"]), asset) for asset in file["scene/assets"].values()]
            for source, dataset in stored:
                if not source.exists() or hashlib.sha256(source.read_bytes()).hexdigest() != text(dataset.attrs["sha256"]):
                    return f"the scene's {source.name} has changed"
    except (OSError, KeyError, ValueError, IndexError) as error:
        return f"not readable: {error}"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("--root", type=pathlib.Path, required=True, help="the repository")
    parser.add_argument("--scene", required=True)
    parser.add_argument("--performer", required=True)
    parser.add_argument("--seed", type=int, required=True)
    arguments = parser.parse_args()
    reason = reason_against(arguments.recording, arguments.root, arguments.scene, arguments.performer, arguments.seed)
    if reason:
        print(reason)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
