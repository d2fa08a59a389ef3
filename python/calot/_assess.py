# SPDX-License-Identifier: GPL-3.0-or-later
"""Checkpoints of an attempt, and recording with a performer."""
from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from typing import Any, Iterator, Optional, Union

from . import _calot
from ._errors import InvalidError
from ._recording import Path


@dataclass(frozen=True)
class Value:
    """One figure. `value` is in `unit`; where there is none, `availability` and `reason` say why."""

    name: str
    subject: str
    version: int
    value: Optional[float]
    unit: str
    origin: str
    filter: str
    availability: str
    reason: str
    note: str
    coverage: Optional[float]
    rate: Optional[float]
    noise: Optional[float]


@dataclass(frozen=True)
class Assessment:
    """What assessing a recording gave: the replay's report, and every value in the order of `calot assess`."""

    report: dict[str, Any]
    values: list[Value]

    def __iter__(self) -> Iterator[Value]:
        return iter(self.values)

    def __len__(self) -> int:
        return len(self.values)

    def value(self, name: str, subject: str = "") -> Value:
        """The value of a checkpoint. subject: "" (attempt), a hand, an organ, a phase."""
        for v in self.values:
            if (v.name, v.subject) == (name, subject):
                return v
        subjects = [v.subject for v in self.values if v.name == name]
        known = f"it has {', '.join(map(repr, subjects))}" if subjects else "calot.checkpoints() lists those that there are"
        raise InvalidError(f"there is no value \"{name}\" of {subject!r}; {known}")


def assess(path: Path, threads: int = 1, cutoff: float = 6.0, apart: bool = False, cohort: Optional[Path] = None) -> Assessment:
    """`calot assess`: re-simulates a recording and computes its checkpoints; with `cohort`, stores them there.

    Raises ReplayError where it diverges, DamagedError where it cannot be read. Of another simulation version that no engine here decides there are the
    values of its observables, with a warning.
    """
    report, values = _calot.assess(os.fspath(path), threads, float(cutoff), apart, None if cohort is None else os.fspath(cohort))
    if report["verdict"] != "bit-exact":
        warnings.warn(f"{report['file']}: {report['message']}", stacklevel=2)
    return Assessment(report, [Value(**v) for v in values])


def checkpoints() -> list[dict[str, Any]]:
    """Every checkpoint that this build knows: name, title, unit, version, direction, aggregation, definition."""
    return _calot.checkpoints()


def record(output: Path, scene: str, performer: str = "skilled", seed: int = 1, seconds: float = 0.0, participant: str = "", purpose: str = "training",
           mode: str = "practice", force: bool = False) -> dict[str, Union[str, float]]:
    """`calot record` with a performer. seconds: of attempt time; 0: until it is done. Gives the outcome and how long it took (s)."""
    choose("purpose", purpose, ("training", "study", "demo", "golden"))
    choose("mode", mode, ("practice", "assessment"))
    if not 0.0 <= seconds <= 36000.0:
        raise InvalidError(f"seconds: {seconds} lies outside 0 to 36000")
    checked_participant(participant)
    outcome, took = _calot.record(os.fspath(output), scene, performer, seed, seconds, participant, purpose, mode, force)
    return {"outcome": outcome, "seconds": took}


def choose(what: str, word: str, words: tuple[str, ...]) -> str:
    if word not in words:
        raise InvalidError(f"{what}: {word!r} is none; there are {', '.join(words)}")
    return word


def checked_participant(participant: str) -> str:
    if len(participant.encode()) > 64:
        raise InvalidError("participant: longer than 64 characters")
    return participant
