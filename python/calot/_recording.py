# SPDX-License-Identifier: GPL-3.0-or-later
"""A recording: its arrays, its re-simulated results, its moments."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Iterator, Mapping, Optional, Union

import numpy as np

from . import _calot
from ._arrays import EVENT, HANDS, RAW_SAMPLE, Array, Group, Result, array_of, row_type
from ._errors import InvalidError
from ._moment import Moment

Path = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Signature:
    """A station's signature: who signed, the signature (none: the writer was killed before it could sign), and whether it fits the content."""

    public_key: bytes
    value: Optional[bytes]
    valid: bool


class Tool(Group):
    """One hand's samples, a row a tick: position, orientation, instrument, jaw, buttons, valid, contact_set, force, torque."""

    @property
    def pose(self) -> Array:
        """Tip (m) and orientation w, x, y, z in W: (N, 7)."""
        return np.hstack([self["position"], self["orientation"]])


class Recording(Mapping[str, Array]):
    """A recording, checked when it is opened. It maps paths of data sets (schemas/recording.md) to read-only arrays."""

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        self._raw = _calot.Recording(self.path)
        #: The root attributes, without "/@".
        self.header: dict[str, Any] = self._raw.header
        self._loaded: Optional[dict[str, Array]] = None
        self._units: dict[str, str] = {}
        self._parts: dict[str, list[str]] = {}

    # What it is

    @property
    def scene(self) -> str:
        return str(self.header["scene_name"])

    @property
    def seed(self) -> int:
        return int(self.header["seed"])

    @property
    def participant(self) -> str:
        """Pseudonym, or empty."""
        return str(self.header["participant"])

    @property
    def operator(self) -> str:
        """Who acted: "human", "kinematics", or "performer" (synthetic) with its profile."""
        kind, profile = self.header["operator_kind"], self.header["performer_profile"]
        return f"{kind} {profile}".strip()

    @property
    def synthetic(self) -> bool:
        """Made by a performer or a controller."""
        return bool(self.header["operator_kind"] == "performer")

    @property
    def simulation_version(self) -> int:
        return int(self.header["simulation_version"])

    @property
    def duration(self) -> float:
        """Of simulated time (s)."""
        return self._raw.seconds

    @property
    def steps(self) -> int:
        return self._raw.steps

    @property
    def ticks(self) -> int:
        return self._raw.ticks

    @property
    def step_seconds(self) -> float:
        return float(self.header["tick_seconds"]) * int(self.header["ticks_per_step"])

    @property
    def complete(self) -> bool:
        """Has the attempt ended, and is all of it here?"""
        return self._raw.complete

    @property
    def outcome(self) -> str:
        return self._raw.outcome

    @property
    def structures(self) -> list[str]:
        """Organs, vessels and bodies of fat: structure i is bit i of `touching`."""
        return self._raw.names

    @property
    def chain_intact(self) -> bool:
        """Does the content chain, computed again from the content, agree with the file's?"""
        return self._raw.chain_intact

    @property
    def chain_head(self) -> bytes:
        """The last head of the content chain (BLAKE2b-256)."""
        return self._raw.chain_head

    @property
    def signature(self) -> Optional[Signature]:
        s = self._raw.signature
        return None if s is None else Signature(s["public_key"], s["value"], s["valid"])

    # Its arrays

    def _arrays(self) -> dict[str, Array]:
        if self._loaded is None:
            ticks, steps, events = self._raw.columns()
            arrays: dict[str, Array] = {}
            for path, kind, unit, width, vector, parts, data in ticks + steps:
                if width == 0:
                    continue
                arrays[path] = array_of(data, kind, -1, width) if vector else array_of(data, kind, -1)
                self._units[path] = unit
                self._parts[path] = parts
            arrays["/events"] = np.frombuffer(events, EVENT)
            self._loaded = arrays
        return self._loaded

    def __getitem__(self, path: str) -> Array:
        return self._arrays()[path]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays())

    def __len__(self) -> int:
        return len(self._arrays())

    @property
    def units(self) -> dict[str, str]:
        """Unit of each data set by its path; empty: none."""
        self._arrays()
        return dict(self._units)

    def parts(self, path: str) -> list[str]:
        """Whose value each element of a data set's row is: names of organs, vessels, structures; empty where it is one thing's."""
        self._arrays()
        return self._parts[path]

    def _group(self, prefix: str) -> dict[str, Array]:
        return {path[len(prefix):]: a for path, a in self._arrays().items() if path.startswith(prefix)}

    @property
    def tools(self) -> dict[str, Tool]:
        """Both hands' samples: `recording.tools["left"].position`."""
        return {hand: Tool(self._group(f"/ticks/{hand}/"), f"tool {hand}") for hand in HANDS}

    @property
    def camera(self) -> Group:
        """Endoscope at every tick: position and orientation."""
        return Group(self._group("/camera/"), "camera")

    @property
    def forces(self) -> dict[str, Array]:
        """Force on each hand at each tick, (N, 3), N in W. A golden recording has none: replay() gives them."""
        tools = self.tools
        missing = [hand for hand in HANDS if "force" not in tools[hand]]
        if missing:
            raise InvalidError(f"{self.path}: a golden recording holds no forces; those of replay() are the same to the last bit")
        return {hand: tools[hand]["force"] for hand in HANDS}

    @property
    def observables(self) -> Group:
        """What each step reported, by names without "/observables/": `recording.observables["left/contact_force"]`."""
        return Group(self._group("/observables/"), "observables")

    @property
    def events(self) -> Array:
        """Structured array: step, kind, hand, subject, position, value."""
        return self["/events"]

    @property
    def device_samples(self) -> dict[str, Array]:
        """Raw samples of each hand's device as structured arrays; empty where no device was the source."""
        return {hand: np.frombuffer(data, RAW_SAMPLE) for hand, data in zip(HANDS, self._raw.raw_samples())}

    @property
    def keyframe_steps(self) -> Array:
        return np.array(self._raw.keyframe_steps, np.uint64)

    def keyframe(self, index: int) -> tuple[int, bytes, bytes]:
        """A keyframe, decoded: the step after which it was taken, the State's bytes, those of the haptic states with their contact sets."""
        if index < 0:
            raise InvalidError(f"{self.path}: keyframes are numbered from 0 on")
        return self._raw.keyframe(index)

    @property
    def time(self) -> Array:
        """Start of each tick (s)."""
        return np.arange(self.ticks) * float(self.header["tick_seconds"])

    @property
    def step_time(self) -> Array:
        """End of each step (s)."""
        return (np.arange(self.steps) + 1) * self.step_seconds

    # Simulating it again

    def replay(self) -> Replay:
        """Re-simulates it, step by step. Each result was compared with the recording before it is given.

        Raises ReplayError at the first step that differs, or at the end where the content chain is broken.
        """
        return Replay(self)

    def verify(self, threads: int = 1) -> dict[str, Any]:
        """Re-simulates all of it in one call, as `calot replay` does. Raises ReplayError where anything differs."""
        return replay(self.path, threads)

    def seek(self, time: float) -> Moment:
        """The moment at a time (s): after the step that begins then, as `calot render --at` draws it."""
        if not 0.0 <= time <= self.duration:
            raise InvalidError(f"{self.path}: is {self.duration:.2f} s long, there is nothing at {time:.2f} s")
        return self.moment(min(int(np.floor(time / self.step_seconds + 1e-6)), self.steps - 1))

    def moment(self, step: int) -> Moment:
        """The moment after a step, re-simulated from the keyframe before it."""
        if step < 0:
            raise InvalidError(f"{self.path}: has {self.steps} steps, from 0 on: there is no step {step}")
        seeker: Optional[_calot.Seeker] = self.__dict__.get("_seeker")
        if seeker is None:
            seeker = self.__dict__["_seeker"] = _calot.Seeker(self.path)
        return Moment(seeker.seek(step))

    def __repr__(self) -> str:
        return f"<calot.Recording {self.path}: {self.scene}, {self.operator}, {self.duration:.2f} s{'' if self.complete else ', incomplete'}>"


class Replay(Iterator[Result]):
    """Iterates over the results of a recording's steps as re-simulation gives them."""

    def __init__(self, recording: Recording) -> None:
        self._raw = _calot.Replay(recording.path)
        self._kind = row_type(self._raw.columns)
        self._seconds = recording.step_seconds
        self._ticks = int(recording.header["ticks_per_step"])

    def __next__(self) -> Result:
        return self.advance(1)

    def advance(self, steps: int) -> Result:
        """Does up to so many steps in one call and gives the last one's result. Raises StopIteration at the end."""
        facts = self._raw.advance(steps)
        if facts is None:
            raise StopIteration
        return Result(facts, self._kind, self._seconds, self._ticks)


def open(path: Path) -> Recording:  # noqa: A001  (calot.open, as in other libraries of files)
    """Opens a recording. Raises DamagedError where it cannot be read."""
    return Recording(path)


def replay(path: Path, threads: int = 1, anyway: bool = False, apart: bool = False) -> dict[str, Any]:
    """`calot replay`: re-simulates a recording and compares every digest, force, observable, event and keyframe.

    threads: segments that are verified at a time; 0: one a processor. anyway: of another simulation version, too. apart: in a confined program.
    """
    return _calot.replay(os.fspath(path), threads, anyway, apart)
