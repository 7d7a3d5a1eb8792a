"""What stands around the robot, as boxes that every simulator can build."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.task.scene import Scene, SceneObject

Array = NDArray[np.float64]
PIPE_SIDES = 16
"""PyBullet crashes on a body of more than 16 shapes."""


@dataclass(frozen=True)
class BoxShape:
    """A box in the frame of its object."""

    size: tuple[float, float, float]
    """Full edge lengths [m]"""
    xyz: tuple[float, float, float]
    """Centre [m]"""
    rpy: tuple[float, float, float]
    """[rad]"""


def boxes_of(item: SceneObject, sides: int = PIPE_SIDES) -> tuple[BoxShape, ...]:
    """The object's solid parts: a box is one, a pipe a ring of `sides` thin ones around its x axis.

    A pipe's boxes reach from its opening (x = 0 of its pose) to x = length; their outer faces touch
    the cylinder of the outer radius, so that the ring is never inside a gap of the true pipe.
    """
    if item.kind == "box":
        return (BoxShape(item.size, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),)
    wall = min(item.thickness, item.radius)
    width = 2.0 * item.radius * float(np.tan(np.pi / sides))
    middle = item.radius - 0.5 * wall
    angles = 2.0 * np.pi * np.arange(sides) / sides
    return tuple(
        BoxShape(
            (item.length, width, wall),
            (0.5 * item.length, -middle * float(np.sin(a)), middle * float(np.cos(a))),
            (float(a), 0.0, 0.0),
        )
        for a in angles
    )


def owner_of(scene: Scene, point: ArrayLike) -> SceneObject | None:
    """The object one of whose named points is at `point` (3,) [m], or None."""
    target = np.asarray(point, dtype=float)
    for item in scene.objects:
        if any(np.allclose(p, target, atol=1e-6) for p in item.points().values()):
            return item
    return None
