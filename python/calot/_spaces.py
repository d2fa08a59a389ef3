# SPDX-License-Identifier: GPL-3.0-or-later
"""Spaces of actions and observations: Gymnasium's where it is installed, else classes with what their users ask for."""
from __future__ import annotations

from typing import Any, Iterator, Mapping, Optional, Sequence

import numpy as np

from ._arrays import Array


class Box:
    """Arrays between two bounds."""

    def __init__(self, low: Any, high: Any, shape: Sequence[int], dtype: Any = np.float64, seed: Optional[int] = None) -> None:
        self.shape, self.dtype = tuple(shape), np.dtype(dtype)
        self.low, self.high = (np.broadcast_to(np.asarray(b, self.dtype), self.shape).copy() for b in (low, high))
        self._random = np.random.default_rng(seed)

    def contains(self, x: Any) -> bool:
        a = np.asarray(x)
        return bool(a.shape == self.shape and np.all(a >= self.low) and np.all(a <= self.high))

    __contains__ = contains

    def seed(self, seed: Optional[int] = None) -> None:
        self._random = np.random.default_rng(seed)

    def sample(self) -> Array:
        """Uniform where both bounds are finite, else standard normal."""
        finite = np.isfinite(self.low) & np.isfinite(self.high)
        low, high = np.where(finite, self.low, 0.0), np.where(finite, self.high, 1.0)
        return np.where(finite, self._random.uniform(low, high), self._random.standard_normal(self.shape)).astype(self.dtype)

    def __repr__(self) -> str:
        return f"Box(shape={self.shape}, {self.dtype})"


class Dict(Mapping[str, Any]):
    """Spaces by name."""

    def __init__(self, spaces: Mapping[str, Any]) -> None:
        self.spaces = dict(spaces)

    def __getitem__(self, name: str) -> Any:
        return self.spaces[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.spaces)

    def __len__(self) -> int:
        return len(self.spaces)

    def contains(self, x: Any) -> bool:
        return set(x) == set(self.spaces) and all(s.contains(x[n]) for n, s in self.spaces.items())

    def sample(self) -> dict[str, Any]:
        return {n: s.sample() for n, s in self.spaces.items()}

    def __repr__(self) -> str:
        return f"Dict({self.spaces})"


def space_classes() -> tuple[Any, Any]:
    """Box and Dict: Gymnasium's, or those above."""
    try:
        from gymnasium import spaces
    except ImportError:
        return Box, Dict
    return spaces.Box, spaces.Dict


def environment_base() -> Any:
    """gymnasium.Env where it is installed, so that its wrappers take an Environment."""
    try:
        from gymnasium import Env
    except ImportError:
        return object
    return Env
