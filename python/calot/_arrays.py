# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays over the bytes that the extension module hands over: read-only, without a copy."""
from __future__ import annotations

from typing import Any, Iterable, Iterator, Mapping, Sequence

import numpy as np

from . import _calot

Array = np.ndarray[Any, np.dtype[Any]]

#: Rows of `/events` (schemas/recording.md).
EVENT = np.dtype([("step", "<u8"), ("kind", "<u2"), ("hand", "u1"), ("subject", "<u2"), ("position", "<f8", (3,)), ("value", "<f8")])
#: Rows of `/device/<hand>/samples`.
RAW_SAMPLE = np.dtype([("device_time", "<i8"), ("host_time", "<i8"), ("sequence", "<u8"), ("tick", "<u8"), ("position", "<f8", (3,)), ("orientation", "<f8", (4,)),
                       ("gripper", "<f8"), ("buttons", "u1"), ("valid", "u1"), ("used", "u1")])

HANDS = ("left", "right")
PHASES = ("none", "identification", "clipping", "cutting", "dissection", "done")
OUTCOMES = ("running", "completed", "time limit", "abandoned", "stopped", "technical failure")


def array_of(data: bytes, kind: str, *shape: int) -> Array:
    return np.frombuffer(data, np.dtype("<" + kind)).reshape(shape)


def row_type(columns: Iterable[tuple[str, str, int]]) -> np.dtype[Any]:
    """The type of a row of results: a field for each column of /observables, named without that prefix."""
    fields: list[Any] = []
    for path, kind, width in columns:
        name = path[len("/observables/"):]
        many = width != 1 or name.startswith(("organs/", "connective/", "vessels/", "fat/")) or name.endswith("/organ_force")
        fields.append((name, "<" + kind, (width,)) if many else (name, "<" + kind))
    return np.dtype(fields)


class Group(Mapping[str, Array]):
    """Arrays by name; names that are Python's can be attributes, too: `group.position`."""

    def __init__(self, arrays: Mapping[str, Array], what: str) -> None:
        self._arrays = dict(arrays)
        self._what = what

    def __getitem__(self, name: str) -> Array:
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __getattr__(self, name: str) -> Array:
        if name.startswith("__") or name not in self.__dict__.get("_arrays", {}):
            raise AttributeError(f"{self.__dict__.get('_what', 'group')} has no {name}; there are {', '.join(self.__dict__.get('_arrays', {}))}")
        return self._arrays[name]

    def __dir__(self) -> Sequence[str]:
        return [*super().__dir__(), *self._arrays]

    def __repr__(self) -> str:
        return f"<{self._what}: {', '.join(f'{n} {a.shape}' for n, a in self._arrays.items())}>"


class Result:
    """What one step came to."""

    __slots__ = ("step", "time", "_facts", "_kind", "_ticks")

    def __init__(self, facts: _calot.Facts, kind: np.dtype[Any], step_seconds: float, ticks: int) -> None:
        #: Number of the step, from 0 on, and the time at its end (s).
        self.step = facts.step
        self.time = (facts.step + 1) * step_seconds
        self._facts, self._kind, self._ticks = facts, kind, ticks

    @property
    def observables(self) -> Any:
        """Everything that the step reports (schemas/observables.md), as a row of a structured array."""
        return np.frombuffer(self._facts.row, self._kind)[0]

    def __getitem__(self, name: str) -> Any:
        """An observable by its name without "/observables/": `result["left/contact_force"]`."""
        return self.observables[name]

    @property
    def forces(self) -> Array:
        """Force on each hand at each tick, (T, 2, 3), N in W, as it was computed."""
        return array_of(self._facts.forces, "f8", self._ticks, 2, 2, 3)[:, :, 0]

    @property
    def torques(self) -> Array:
        """Torque on each hand at each tick, (T, 2, 3), N m in W."""
        return array_of(self._facts.forces, "f8", self._ticks, 2, 2, 3)[:, :, 1]

    @property
    def events(self) -> Array:
        """The step's events, with what is judged of them, as a structured array."""
        return np.frombuffer(self._facts.events, EVENT)

    @property
    def digest(self) -> Array:
        """XXH3-64 of each component of the State; empty where another program simulates."""
        return np.frombuffer(self._facts.digest, "<u8")

    @property
    def phase(self) -> str:
        """Of the procedure, as it is judged: "none" where the scene has none."""
        return PHASES[self._facts.phase]

    @property
    def errors(self) -> int:
        """Errors that were judged so far."""
        return self._facts.errors

    @property
    def critical_errors(self) -> int:
        return self._facts.critical_errors

    @property
    def critical_view(self) -> int:
        """Points of the critical view of safety, 0 to 6."""
        return self._facts.critical_view

    def __repr__(self) -> str:
        return f"<calot.Result of step {self.step}, {self.time:.3f} s>"
