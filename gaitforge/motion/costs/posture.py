"""Joints near a posture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.instant import Block, Instant, SampleCost
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class Posture(SampleCost):
    """∫ w |q − q_stance|² dt, heavier in stance (a light one leaves the reduced Hessian indefinite)."""

    name: ClassVar[str] = "posture"
    unit: ClassVar[str] = "rad² s"
    reads: ClassVar[tuple[Block, ...]] = ("joints",)
    stance: float = 3.0
    """per rad² s"""
    swing: float = 1.0
    """per rad² s"""

    def parameters(self, trajectory: Trajectory, limb: int | None) -> NDArray[np.float64]:
        """(K, 1 + n) weight and goal: the commanded stance, the held posture for a limb that never stands."""
        assert limb is not None
        grid, robot = trajectory.grid, trajectory.robot
        rows = robot.joint_indices(robot.limbs[limb])
        out = np.empty((grid.samples, 1 + len(rows)))
        out[:, 0] = np.where(grid.ground[:, limb], self.stance, self.swing)
        walks = grid.contact[:, limb].any()
        out[:, 1:] = trajectory.stance.joints[:, rows] if walks else robot.nominal.held_posture[rows]
        return out

    def instant(self, at: Instant, p: Any) -> Any:
        """The density of the cost at one sample of one limb."""
        import casadi as ca

        return p[0] * ca.sumsqr(at.joints - p[1:])
