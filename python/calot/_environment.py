# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene that a controller steps: the interface that Gymnasium expects, without needing it."""
from __future__ import annotations

import os
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Callable, Optional, Sequence, Union

import numpy as np

from . import _calot
from ._arrays import HANDS, OUTCOMES, PHASES, Array, Result, row_type
from ._assess import checked_participant, choose
from ._errors import InvalidError
from ._moment import Camera, Moment
from ._recording import Path
from ._spaces import environment_base, space_classes

#: Bits of an action's buttons.
CUT, COAGULATE, FIRE, LOCK, RETRACT_MORE, RETRACT_LESS = 1, 2, 4, 8, 16, 32

#: Names of the numbers of one hand's action, and their units.
ACTION = (("x", "m"), ("y", "m"), ("z", "m"), ("roll", "rad"), ("jaw", "rad"), ("buttons", ""))

_WIDEST_JAW = 1.6
_DONE = PHASES.index("done")
_Base: Any = environment_base()


@dataclass(frozen=True)
class Scene:
    """What a scene is: structures by name, ports and first positions of both hands (m, W), workspace corners, times (s)."""

    name: str
    major: int
    minor: int
    structures: tuple[str, ...]
    ports: Array
    homes: Array
    workspace: Array
    tick_seconds: float
    ticks_per_step: int
    time_limit: float
    procedure: bool
    #: Name, unit and shape of each part of an observation.
    observed: tuple[tuple[str, str, tuple[int, ...]], ...]

    def __init__(self, name: str, _about: Optional[dict[str, Any]] = None) -> None:
        about = dict(_calot.Attempt(name, 0).scene if _about is None else _about)
        for key in ("ports", "homes", "workspace"):
            about[key] = np.array(about[key])
            about[key].flags.writeable = False
        about["structures"], about["observed"] = tuple(about["structures"]), tuple(about["observed"])
        for key, value in about.items():
            object.__setattr__(self, key, value)

    @property
    def step_seconds(self) -> float:
        return self.tick_seconds * self.ticks_per_step


class Environment(_Base):  # type: ignore[misc]
    """An attempt at a scene, one step (10 ms) a call.

    An action has shape (2, 6): for the left and the right hand the tip's position x, y, z at the step's end (m, in the scene's frame W), the roll about the
    shaft (rad), the opening of the jaws (rad), and the buttons as a sum of CUT, COAGULATE, FIRE, LOCK,
    RETRACT_MORE and RETRACT_LESS, which ask the assistant as they go down (rounded to a whole number). The shaft passes through the hand's port. Between two actions the hands move evenly.

    reward, done: called with each step's Result; without them the reward is 0.0, and an attempt is done when its procedure is, or the simulation ran away.
    seconds: of attempt time after which it is truncated; 0: the scene's own limit alone.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 100}
    render_mode = "rgb_array"
    spec = None

    def __init__(self, scene: str, seed: int = 1, reward: Optional[Callable[[Result], float]] = None, done: Optional[Callable[[Result], bool]] = None,
                 seconds: float = 0.0) -> None:
        self.scene = Scene(scene)
        self._name, self._seed, self._reward, self._done, self._limit = scene, seed, reward, done, seconds
        self._step_seconds, self._ticks = self.scene.step_seconds, self.scene.ticks_per_step
        self._attempt: Optional[_calot.Attempt] = None
        self._wish: Optional[dict[str, Any]] = None
        self._result: Optional[Result] = None
        #: Units of the observations, by name.
        self.units = {name: unit for name, unit, _ in self.scene.observed}
        self._parts: list[tuple[str, slice, tuple[int, ...]]] = []
        at = 0
        for part, _, shape in self.scene.observed:
            self._parts.append((part, slice(at, at + int(np.prod(shape))), shape))
            at = self._parts[-1][1].stop
        box, dictionary = space_classes()
        low = [[*self.scene.workspace[0], -np.pi, 0.0, 0.0]] * 2
        high = [[*self.scene.workspace[1], np.pi, _WIDEST_JAW, 63.0]] * 2
        self.action_space: Any = box(np.array(low), np.array(high), shape=(2, len(ACTION)), dtype=np.float64)
        self.observation_space: Any = dictionary({part: box(-np.inf, np.inf, shape=shape, dtype=np.float64) for part, _, shape in self._parts})

    # Gymnasium's interface

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None) -> tuple[dict[str, Array], dict[str, Any]]:
        """Begins an attempt; one that runs is stopped, and its recording closed. seed: from here on; none: that of the last one."""
        self.finish("stopped")
        if seed is not None:
            self._seed = seed
        self._attempt = _calot.Attempt(self._name, self._seed)
        self._kind = row_type(self._attempt.columns)
        self._result = None
        if self._wish is not None:
            wish, self._wish = self._wish, None
            self._attempt.record(**wish)
        return self._first(), {"seed": self._seed}

    def step(self, action: Any) -> tuple[dict[str, Array], float, bool, bool, dict[str, Any]]:
        """Does one step. Gives observation, reward, terminated, truncated, and info with the step's Result."""
        attempt = self._running()
        outcome = attempt.step(action)
        facts = attempt.facts
        result = self._result = Result(facts, self._kind, self._step_seconds, self._ticks)
        terminated, truncated = OUTCOMES[outcome] == "technical failure", OUTCOMES[outcome] == "time limit"
        if terminated or truncated:
            self.finish()
        elif bool(self._done(result)) if self._done is not None else facts.phase == _DONE:
            terminated = True
            self.finish("completed")
        elif self._limit > 0.0 and result.time >= self._limit:
            truncated = True
            self.finish("stopped")
        reward = float(self._reward(result)) if self._reward is not None else 0.0
        return self._observed(facts), reward, terminated, truncated, {"result": result}

    def render(self, width: int = 640, height: int = 360, camera: Union[str, Camera] = "endoscope", quality: str = "interactive") -> Array:
        """The scene now, (height, width, 3) bytes of red, green and blue."""
        return self.moment().render(width, height, camera, quality)

    def close(self) -> None:
        """Ends the attempt, and closes its recording."""
        self.finish("stopped")

    # Beyond it

    def run(self, actions: Any) -> Array:
        """Steps through actions of shape (N, 2, 6) in one call: rows of results, fewer than N where the attempt was over before."""
        attempt = self._running()
        _, rows = attempt.run(actions)
        if OUTCOMES[attempt.outcome] != "running":
            self.finish()
        return np.frombuffer(rows, self._kind)

    def record(self, path: Path, participant: str = "", controller: str = "python", version: str = "1", purpose: str = "training", station: str = "",
               handedness: str = "unknown", force: bool = False) -> None:
        """Records the attempt, from its first step on: the present one if it has no step yet, else the one that the next reset begins.

        The recording is any source's, marked as synthetic: operator_kind "performer", performer_profile "controller:" and the controller's name.
        """
        wish: dict[str, Any] = {"path": os.fspath(path), "controller": controller, "version": version, "participant": checked_participant(participant), "station": station,
                "purpose": choose("purpose", purpose, ("training", "study", "demo", "golden")),
                "handedness": choose("handedness", handedness, ("right", "left", "unknown")), "force": force}
        if self._attempt is not None and self._attempt.steps == 0 and not self._attempt.ended:
            self._attempt.record(**wish)
        else:
            self._wish = wish

    def finish(self, outcome: str = "completed") -> None:
        """Ends the attempt with an outcome, and closes its recording. Nothing happens where none runs."""
        choose("outcome", outcome, OUTCOMES[1:])
        if self._attempt is not None and not self._attempt.ended:
            self._attempt.end(OUTCOMES.index(outcome))

    def mount(self, hand: str, instrument: str) -> None:
        """Mounts an instrument from the next step on: "grasper", "hook", "clip-applier", "scissors", "probe" or "none"."""
        choose("hand", hand, HANDS)
        self._running().mount(HANDS.index(hand), instrument)

    def look(self, camera: Camera) -> None:
        """Moves the endoscope, from the next step on. Its field of view is the scene's."""
        self._running().look([*map(float, camera.position), *map(float, camera.orientation)])

    def moment(self) -> Moment:
        """Surfaces, instruments and picture of the scene now. It has no State: a recording's moments have."""
        return Moment(self._begun().moment())

    @property
    def hands(self) -> Array:
        """The action that leaves the hands where they are, (2, 6); a copy."""
        return np.array(self._begun().action).reshape(2, len(ACTION))

    @property
    def outcome(self) -> str:
        """How the attempt stands or ended: "running", "completed", "time limit", "stopped", ..."""
        return OUTCOMES[self._begun().outcome]

    @property
    def seed(self) -> int:
        return self._seed

    @property
    def result(self) -> Optional[Result]:
        """Of the last step; none before the first."""
        return self._result

    @property
    def unwrapped(self) -> Environment:
        return self

    def __enter__(self) -> Environment:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()

    def _begun(self) -> _calot.Attempt:
        if self._attempt is None:
            raise InvalidError("there is no attempt yet: reset() begins one")
        return self._attempt

    def _running(self) -> _calot.Attempt:
        attempt = self._begun()
        if attempt.ended:
            raise InvalidError(f"the attempt is over ({OUTCOMES[attempt.outcome]}): reset() begins another one")
        return attempt

    def _observed(self, facts: _calot.Facts) -> dict[str, Array]:
        numbers = np.frombuffer(bytearray(facts.observation))
        return {part: numbers[place].reshape(shape) for part, place, shape in self._parts}

    def _first(self) -> dict[str, Array]:
        """Before the first step: hands at home, no forces."""
        instruments = self.moment().instruments
        both: Callable[[Callable[[Any], Any]], Array] = lambda of: np.array([of(instruments[hand]) for hand in HANDS])
        seen = {name: np.zeros(shape) for name, _, shape in self._parts}
        seen["tip"], seen["orientation"], seen["jaw"] = both(lambda i: i.position), both(lambda i: i.orientation), both(lambda i: i.jaw)
        seen["insertion"] = np.linalg.norm(seen["tip"] - self.scene.ports, axis=1)
        return seen


def action(left: Sequence[float], right: Sequence[float]) -> Array:
    """An action of two positions, or of up to six numbers a hand; what is left out is 0."""
    made = np.zeros((2, len(ACTION)))
    for row, numbers in zip(made, (left, right)):
        row[: len(numbers)] = numbers
    return made
