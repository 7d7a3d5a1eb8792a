"""The trunk stays above the ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from gaitforge.motion.instant import Instant, SampleConstraint
from gaitforge.robot.kinematics import rpy_rotation


@dataclass(frozen=True)
class TrunkHeight(SampleConstraint):
    """z + e_z · R p ≥ margin for the corners p of the trunk's shapes.

    Added by refinement, where the dense check found the trunk in the ground.
    """

    name: ClassVar[str] = "trunk_height"
    unit: ClassVar[str] = "m"
    reads = ("base",)
    corners: tuple[tuple[float, float, float], ...] = ()
    """[m] in base_link"""
    margin: float = 0.005
    """[m]"""

    def instant(self, at: Instant, p: Any) -> Any:
        """Heights of the corners."""
        import casadi as ca

        up = rpy_rotation(at.base[3:6])[2, :]
        return ca.vertcat(*(at.base[2] + ca.dot(up.T, ca.DM(list(corner))) for corner in self.corners))

    def bounds(self) -> tuple[ArrayLike, ArrayLike]:
        """At least the margin."""
        return self.margin, np.inf
