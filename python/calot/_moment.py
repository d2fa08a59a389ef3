# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene after a step: surfaces, instruments, State, and its picture."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import _calot
from ._arrays import HANDS, Array, Group, array_of
from ._errors import InvalidError

_INSTRUMENTS = {number: name for name, number in _calot.instruments().items()}


@dataclass(frozen=True)
class Surface:
    """One structure's outer surface in W (m): vertices, the same at rest, and triangles as rows of three indices."""

    position: Array
    rest: Array
    triangles: Array


@dataclass(frozen=True)
class Instrument:
    """An instrument as it is simulated: tip (m) and orientation (w, x, y, z) in W, opening of its jaws (rad)."""

    name: str
    position: Array
    orientation: Array
    jaw: float
    touching: bool


@dataclass(frozen=True)
class Camera:
    """A camera in W: position (m); orientation w, x, y, z of the frame x right, y down, z forward; vertical field of view (rad)."""

    position: Array
    orientation: Array
    field_of_view: float

    @staticmethod
    def looking(position: Sequence[float], target: Sequence[float], up: Sequence[float] = (0.0, 1.0, 0.0), field_of_view: float = 1.0) -> Camera:
        """The camera at a position that looks at a target."""
        at = np.asarray(position, float)
        z = np.asarray(target, float) - at
        x = np.cross(z, np.asarray(up, float))
        if not np.linalg.norm(z) > 0.0 or not np.linalg.norm(x) > 1e-12 * np.linalg.norm(z):
            raise InvalidError("the camera: its target lies where it is, or straight along up; move one of them")
        z, x = z / np.linalg.norm(z), x / np.linalg.norm(x)
        return Camera(at, _quaternion_of(np.stack([x, np.cross(z, x), z], axis=1)), field_of_view)


def _quaternion_of(r: Array) -> Array:
    """w, x, y, z of a rotation matrix, from the largest of the four (Shepperd 1978)."""
    t = float(np.trace(r))
    squares = np.array([t, r[0, 0], r[1, 1], r[2, 2]])
    q = np.empty(4)
    i = int(np.argmax(squares))
    if i == 0:
        q[:] = 1.0 + t, r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    else:
        a, b, c = i - 1, i % 3, (i + 1) % 3
        q[0] = r[c, b] - r[b, c]
        q[1 + a] = 1.0 + r[a, a] - r[b, b] - r[c, c]
        q[1 + b] = r[a, b] + r[b, a]
        q[1 + c] = r[a, c] + r[c, a]
    return q / np.linalg.norm(q)


class Moment:
    """A scene after a step of a recording or of an attempt."""

    def __init__(self, raw: _calot.Moment) -> None:
        self._raw = raw

    @property
    def step(self) -> int:
        """The last step that was done; -1: none."""
        return self._raw.step - 1

    @property
    def time(self) -> float:
        """Since the attempt's start (s)."""
        return self._raw.time

    @property
    def surfaces(self) -> dict[str, Surface]:
        """Surfaces by the names of structures."""
        return {name: Surface(array_of(p, "f8", -1, 3), array_of(rest, "f8", -1, 3), array_of(t, "i4", -1, 3)) for name, p, rest, t in self._raw.surfaces}

    @property
    def instruments(self) -> dict[str, Instrument]:
        """Instruments by hand."""
        return {hand: Instrument(_INSTRUMENTS.get(kind, "none"), np.array(pose[:3]), np.array(pose[3:]), jaw, touching)
                for hand, (kind, pose, jaw, touching) in zip(HANDS, self._raw.instruments)}

    @property
    def camera(self) -> Camera:
        """The endoscope."""
        pose, field = self._raw.camera
        return Camera(np.array(pose[:3]), np.array(pose[3:]), field)

    @property
    def state(self) -> Group:
        """Every field of the State, flat, in the order of the digests: `moment.state["organ.liver/position"]`."""
        return Group({name: np.frombuffer(data, np.dtype("<" + kind)) for name, kind, data in self._raw.state()}, "state")

    def render(self, width: int = 640, height: int = 360, camera: Union[str, Camera] = "endoscope", quality: str = "film", mask: bool = True,
               cavity: bool = True, alpha: bool = False) -> Array:
        """The picture, (height, width, 3) bytes of red, green and blue, the top row first.

        camera: "endoscope", or a Camera. quality: "film" or "interactive" (faster). mask: the endoscope's round field. cavity: the abdominal wall behind
        everything. alpha: a fourth channel, 0 where nothing was drawn.
        """
        pose: Optional[list[float]] = None
        field: Optional[float] = None
        if isinstance(camera, Camera):
            pose, field = [*map(float, camera.position), *map(float, camera.orientation)], float(camera.field_of_view)
        elif camera != "endoscope":
            raise InvalidError(f"camera: {camera!r} is none; give \"endoscope\" or a calot.Camera")
        w, h, data = self._raw.render(width, height, quality, mask, cavity, pose, field)
        picture: Any = np.frombuffer(data, np.uint8).reshape(h, w, 4)
        wanted: Array = picture if alpha else np.ascontiguousarray(picture[:, :, :3])
        return wanted

    def __repr__(self) -> str:
        return f"<calot.Moment after step {self.step}, {self.time:.3f} s>"
