"""What stands around the robot: pipes and boxes, with named points that a tool may look at."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class SceneObject:
    """A pipe or a box, fixed in the world unless it has a mass: then `xyz` and `rpy` are where it starts.

    A pipe's axis is the x axis of its pose, its opening the centre of the end at −x (the end that
    faces a robot walking along +x); `xyz` is the opening.  A box is centred at `xyz`.
    """

    name: str
    kind: Literal["pipe", "box"]
    xyz: tuple[float, float, float]
    """[m] in the world frame"""
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """[rad], fixed axes x, y, z"""
    radius: float = 0.1
    """[m] outer radius of a pipe"""
    length: float = 0.5
    """[m] of a pipe"""
    thickness: float = 0.005
    """[m] wall of a pipe"""
    size: tuple[float, float, float] = (0.1, 0.1, 0.1)
    """[m] full edge lengths of a box"""
    mass: float = 0.0
    """[kg]; 0 = does not move"""

    @property
    def movable(self) -> bool:
        """Is it a body that can be pushed, lifted and dropped."""
        return self.mass > 0.0

    def points(self) -> dict[str, NDArray[np.float64]]:
        """Named points of the object [m], world frame."""
        if self.kind == "pipe":
            return {"opening": np.array(self.xyz, dtype=float)}
        return {"center": np.array(self.xyz, dtype=float)}


@dataclass(frozen=True)
class Scene:
    """All objects around the robot."""

    objects: tuple[SceneObject, ...] = ()

    def point_names(self) -> tuple[str, ...]:
        """Every name that `point` understands, e.g. ``pipe.opening``."""
        return tuple(f"{o.name}.{p}" for o in self.objects for p in o.points())

    def point(self, name: str) -> NDArray[np.float64]:
        """The named point [m], world frame; KeyError when there is none."""
        owner, _, which = name.partition(".")
        for item in self.objects:
            if item.name == owner and which in item.points():
                return item.points()[which]
        raise KeyError(name)
