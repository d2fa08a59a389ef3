# SPDX-License-Identifier: GPL-3.0-or-later
"""What can go wrong, as exceptions. The message is the line that the command line prints."""
from __future__ import annotations

from typing import Any, Mapping, Optional


class Error(Exception):
    """Base of all errors of Calot. `str(error)` is one line: where, what, and what to do."""

    exit_code: int = 1

    def __init__(self, message: str, file: str = "", place: str = "", advice: str = "") -> None:
        super().__init__(message)
        #: File, folder or database in which the error lies, and the place in it; may be empty.
        self.file, self.place = file, place
        #: What would resolve it; may be empty.
        self.advice = advice


class FailureError(Error):
    """The machine: disk full, no memory, another program in the way (exit code 1)."""

    exit_code = 1


class InvalidError(Error, ValueError):
    """The request: a name, a value or an output that cannot be (exit code 2)."""

    exit_code = 2


class RefusedError(Error):
    """The answer is no (exit code 3)."""

    exit_code = 3


class ReplayError(RefusedError):
    """A recording is not what its re-simulation gives, or its content chain is broken (exit code 3)."""

    def __init__(self, message: str, step: Optional[int] = None, tick: Optional[int] = None, component: str = "", field: str = "", detail: str = "",
                 **about: str) -> None:
        super().__init__(message, **about)
        #: First step that differs; none: the re-simulation agrees, and the content chain is broken.
        self.step = step
        #: Tick of the attempt, where it is a tick's value.
        self.tick = tick
        #: What differs: "force", "observables", "organ.liver" and so on; its field; both values where they are known.
        self.component, self.field, self.detail = component, field, detail


class DamagedError(Error):
    """The input: damaged, unreadable or missing (exit code 4)."""

    exit_code = 4


class UndecidedError(Error):
    """This build cannot decide: the input is of another version (exit code 5)."""

    exit_code = 5


_BY_CODE: Mapping[int, type[Error]] = {c.exit_code: c for c in (FailureError, InvalidError, RefusedError, DamagedError, UndecidedError)}


def error_of(message: str, details: dict[str, Any]) -> Error:
    """The exception of an error of the libraries; the extension module calls it."""
    code = details.pop("exit_code")
    if details.pop("diverged", False):
        return ReplayError(message, **details)
    return _BY_CODE[code](message, **details)
