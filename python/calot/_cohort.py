# SPDX-License-Identifier: GPL-3.0-or-later
"""A cohort's tables as data frames."""
from __future__ import annotations

import os
from typing import Any, Iterable

import numpy as np

from . import _calot
from ._errors import InvalidError, RefusedError
from ._recording import Path

_OF_ATTEMPT = ("participant", "group", "scene", "operator", "profile", "synthetic", "key", "excluded")
_LIFTED = ("synthetic", "practice", "branch")


def _table(rows: list[dict[str, Any]], columns: list[str], frame: bool) -> Any:
    if not frame:
        return {name: _column([row[name] for row in rows]) for name in columns}
    try:
        import pandas
    except ImportError:
        raise ImportError("pandas is not installed: install python3-pandas for data frames, or ask with frame=False for a dict of arrays") from None
    return pandas.DataFrame([[row[name] for name in columns] for row in rows], columns=columns)


def _column(values: list[Any]) -> Any:
    if values and all(v is None or isinstance(v, float) for v in values):
        return np.array([np.nan if v is None else v for v in values])
    if values and all(isinstance(v, (str, bool, int)) for v in values):
        return np.array(values)
    return np.array(values, dtype=object)


def record_export(cohort: Path, kind: str, target: Path, attempts: list[str]) -> None:
    """Registers in a cohort an export of attempts (uuids) to a file or folder, so that a withdrawal lists it."""
    _calot.record_export(os.fspath(cohort), kind, os.fspath(target), [str(a) for a in attempts])


class Cohort:
    """A cohort's database, opened for reading. Tables are pandas.DataFrame, or with frame=False dicts of numpy arrays.

    Rows are those of the analysis set: the attempts that `calot study` analyses, with consent and withdrawal applied. include: rules to lift,
    of "synthetic", "practice" and "branch". analysed=False: every attempt of those who have not withdrawn; the column left_out has the rules
    that leave it out.
    """

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        self._raw = _calot.Cohort(self.path)

    def _attempts(self, analysed: bool, include: Iterable[str], key: str) -> list[dict[str, Any]]:
        lifted = set(include)
        if not lifted <= set(_LIFTED):
            raise InvalidError(f"include: {', '.join(sorted(lifted - set(_LIFTED)))}: {', '.join(_LIFTED)} are expected")

        def left_out(a: dict[str, Any]) -> set[str]:
            return set(a["left_out"]) - lifted - ({"group"} if a["synthetic"] else set())
        return [a for a in self._raw.attempts() if not (left_out(a) if analysed else a["withdrawn"]) and key in ("", a["key"])]

    def attempts(self, frame: bool = True, analysed: bool = True, include: Iterable[str] = (), key: str = "") -> Any:
        """A row an attempt: who, what, when, how it ended, and whether its recording was verified. key: of one comparability key."""
        rows = self._attempts(analysed, include, key)
        columns = [name for name in rows[0] if name != "withdrawn"] if rows else ["attempt", *_OF_ATTEMPT]
        return _table(rows, columns, frame)

    def values(self, frame: bool = True, analysed: bool = True, include: Iterable[str] = (), key: str = "", mix_keys: bool = False,
               phases: bool = False, name: str = "") -> Any:
        """A row a value: attempt, checkpoint, subject, value in its unit or why there is none; and whose attempt it is.

        name: of one checkpoint; empty: of all, those of single phases with phases=True. lower, upper: its interval, where one is stored.
        Attempts of several comparability keys are refused, as by `calot study`, unless key names one or mix_keys is set.
        """
        stored = self._raw.values()
        if name and all(c["name"] != name for c in _calot.checkpoints()) and all(v["name"] != name for v in stored):
            raise InvalidError(f"{self.path}: there is no checkpoint \"{name}\"; calot.checkpoints() lists those that there are")
        known = {a["attempt"]: a for a in self._attempts(analysed, include, key)}
        keys = sorted({a["key"] for a in known.values()})
        if analysed and len(keys) > 1 and not mix_keys:
            raise RefusedError(f"{self.path}: the attempts don't compare, they have {len(keys)} comparability keys ({'; '.join(keys)}); "
                               "choose one with key=, or mix them with mix_keys=True")
        aside = set() if phases or not analysed else set(_calot.phase_checkpoints())
        rows = [{**v, **{c: known[v["attempt"]][c] for c in _OF_ATTEMPT}} for v in stored
                if v["attempt"] in known and (v["name"] == name if name else v["name"] not in aside)]
        columns = ["attempt", "name", "subject", "version", "value", "unit", "lower", "upper", "availability", "reason", "note", "origin", "filter", "coverage",
                   "rate", "noise",
                   *_OF_ATTEMPT]
        return _table(rows, columns, frame)

    def participants(self, frame: bool = True) -> Any:
        """A row a participant: pseudonym, group, arm, site, experience and consent as dicts."""
        return _table(self._raw.participants(), ["participant", "group", "arm", "site", "experience", "consent"], frame)

    def __repr__(self) -> str:
        return f"<calot.Cohort {self.path}>"
