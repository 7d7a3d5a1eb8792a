"""What a plan says about an object in the robot's grasp: where it is to be, who touches it, how hard."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from gaitforge.task.handling import GraspKind

Array = NDArray[np.float64]


STANDS_M = 0.002
"""[m] above the lowest place of its way up to which an object that is lifted or lowered counts as standing"""


@dataclass(frozen=True, eq=False)
class Holding:
    """One object during one plan."""

    object: str
    """Name of the scene's object"""
    poses: Array
    """(N + 1, 6) or, where it does not move in the body frame, (1, 6): x, y, z [m], roll, pitch, yaw [rad] of its
    centre in base_link"""
    limbs: tuple[str, ...] = ()
    """Limbs whose tips may touch it"""
    efforts: Mapping[str, float] = field(default_factory=dict)
    """joint → the effort [N m] that it may use: what it is closed with is the squeeze"""
    mass: float = 0.0
    """[kg] of the object while it is the robot that bears it, once it has left what it stands on"""
    grasp: GraspKind = "friction"
    """What holds it in simulation"""

    @property
    def welded(self) -> bool:
        """Are a tip and the object one body: a weld holds from when the tips have closed to when they open."""
        return self.grasp == "weld" and self.mass > 0.0

    def at(self, share: Array) -> Array:
        """(n, 6) where the object is to be in base_link; `share` (n,) of the plan's duration, 0 … 1."""
        if len(self.poses) == 1:
            return np.tile(self.poses, (len(share), 1))
        knots = np.linspace(0.0, 1.0, len(self.poses))
        return np.asarray(CubicSpline(knots, self.poses, axis=0, bc_type="clamped")(share))

    def borne(self, heights: Array) -> NDArray[np.bool_]:
        """(n,) is the object, at `heights` (n,) [m] above the ground, off what it stands on.

        One that is lifted or lowered stands at the lowest end of its way; one that does not move in the body
        frame is borne all along.
        """
        if len(self.poses) == 1 or not self.mass:
            return np.full(len(heights), self.mass > 0.0)
        return np.asarray(heights - heights.min() >= STANDS_M)
