# SPDX-License-Identifier: GPL-3.0-or-later
"""A cohort's tables as data frames."""
from __future__ import annotations

import os
from typing import Any

import numpy as np

from . import _calot
from ._errors import InvalidError
from ._recording import Path

_OF_ATTEMPT = ("participant", "group", "scene", "operator", "profile", "synthetic", "key", "excluded")


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

    What is excluded from studies, by hand or by withdrawal, is left out unless asked for; what was withdrawn is always left out.
    """

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        self._raw = _calot.Cohort(self.path)

    def _attempts(self, excluded: bool) -> list[dict[str, Any]]:
        return [a for a in self._raw.attempts() if not a["withdrawn"] and (excluded or not a["excluded"])]

    def attempts(self, frame: bool = True, excluded: bool = False) -> Any:
        """A row an attempt: who, what, when, how it ended, and whether its recording was verified."""
        rows = self._attempts(excluded)
        columns = [name for name in rows[0] if name != "withdrawn"] if rows else ["attempt", *_OF_ATTEMPT]
        return _table(rows, columns, frame)

    def values(self, frame: bool = True, excluded: bool = False, name: str = "") -> Any:
        """A row a value: attempt, checkpoint, subject, value in its unit or why there is none; and whose attempt it is.

        name: of one checkpoint; empty: of all. lower, upper: its interval, where one is stored.
        """
        if name and all(c["name"] != name for c in _calot.checkpoints()) and all(v["name"] != name for v in self._raw.values()):
            raise InvalidError(f"{self.path}: there is no checkpoint \"{name}\"; calot.checkpoints() lists those that there are")
        known = {a["attempt"]: a for a in self._attempts(excluded)}
        rows = [{**v, **{c: known[v["attempt"]][c] for c in _OF_ATTEMPT}} for v in self._raw.values() if v["attempt"] in known and name in ("", v["name"])]
        columns = ["attempt", "name", "subject", "version", "value", "unit", "lower", "upper", "availability", "reason", "note", "origin", "filter", "coverage",
                   *_OF_ATTEMPT]
        return _table(rows, columns, frame)

    def participants(self, frame: bool = True) -> Any:
        """A row a participant: pseudonym, group, arm, site, experience and consent as dicts."""
        return _table(self._raw.participants(), ["participant", "group", "arm", "site", "experience", "consent"], frame)

    def __repr__(self) -> str:
        return f"<calot.Cohort {self.path}>"
