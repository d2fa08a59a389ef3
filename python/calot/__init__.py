# SPDX-License-Identifier: GPL-3.0-or-later
"""Calot: recordings, their re-simulation and assessment, cohorts and scenes (docs/reference/python.md).

The libraries of the command line: the same files, the same bits, the same messages.
"""
import atexit as _atexit

from . import _calot
from ._arrays import Group, Result
from ._assess import Assessment, Value, assess, checkpoints, record
from ._cohort import Cohort, record_export
from ._environment import COAGULATE, CUT, FIRE, LOCK, RETRACT_LESS, RETRACT_MORE, Environment, Scene, action
from ._errors import DamagedError, Error, FailureError, InvalidError, RefusedError, ReplayError, UndecidedError
from ._moment import Camera, Instrument, Moment, Surface
from ._recording import Recording, Replay, Signature, Tool, open, replay  # noqa: A004

__version__ = _calot.software.split()[-1]
simulation_version: int = _calot.simulation_version
step_result_version: int = _calot.step_result_version


def scenes() -> list[str]:
    """Names of the scenes that are installed."""
    return _calot.scenes()


def instruments() -> dict[str, int]:
    """Numbers of the instruments by their names, as recordings store them."""
    return _calot.instruments()


def result_units() -> dict[str, str]:
    """Unit of each observable by its name, as Result and Recording.observables have them; empty: none."""
    return _calot.result_units()


__all__ = [
    "COAGULATE", "CUT", "FIRE", "LOCK", "RETRACT_LESS", "RETRACT_MORE", "Assessment", "Camera", "Cohort", "DamagedError", "Environment", "Error", "FailureError", "Group", "Instrument",
    "InvalidError", "Moment", "Recording", "RefusedError", "Replay", "ReplayError", "Result", "Scene", "Signature", "Surface", "Tool", "UndecidedError", "Value",
    "action", "assess", "checkpoints", "instruments", "open", "record", "record_export", "replay", "result_units", "scenes", "simulation_version", "step_result_version"]

_atexit.register(_calot.end_rendering)
