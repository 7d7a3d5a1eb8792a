"""Joints near a posture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class Posture(Family):
    """∫ w |q − q_nominal|² dt, heavier in stance (a light one leaves the reduced Hessian indefinite)."""

    name: ClassVar[str] = "posture"
    unit: ClassVar[str] = "rad² s"
    stance: float = 3.0
    """per rad² s"""
    swing: float = 1.0
    """per rad² s"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One place a limb and sample."""
        grid, robot = trajectory.grid, trajectory.robot
        for i in trajectory.moving:
            rows = robot.joint_indices(robot.limbs[i])
            weight = np.where(grid.ground[:, i], self.stance, self.swing) * grid.dt
            walks = bool(grid.contact[:, i].any())
            goal = robot.nominal.posture[rows] if walks else robot.nominal.held_posture[rows]
            parameters = np.hstack([weight[:, None], np.tile(goal, (grid.samples, 1))])
            compiled = kernel(("posture", len(rows)), len(rows), 1 + len(rows), _instant)
            problem.add_term(self.name, compiled, trajectory.joints[i], parameters)


def _instant(v: Any, p: Any) -> Any:
    import casadi as ca

    return p[0] * ca.sumsqr(v - p[1:])
