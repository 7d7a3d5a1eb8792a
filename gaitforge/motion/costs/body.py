"""A level body at its height, on its line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory, planar_motion


@dataclass(frozen=True)
class Body(Family):
    """∫ w_z (z − z_0)² + w_θ (roll² + pitch² + (yaw − yaw_0)²) + w_y d² dt, d the distance from the line."""

    name: ClassVar[str] = "body"
    unit: ClassVar[str] = "m² s, rad² s"
    height: float = 100.0
    """per m² s"""
    orientation: float = 20.0
    """per rad² s"""
    drift: float = 10.0
    """per m² s"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One place a sample."""
        grid = trajectory.grid
        samples = np.arange(grid.samples)
        parameters = np.zeros((grid.samples, 6))
        parameters[:, 0] = grid.dt
        parameters[:, 1] = trajectory.robot.nominal.body_height
        parameters[:, 4] = grid.command.heading
        if not grid.cyclic:
            origin = grid.start.base if grid.start is not None else np.zeros(6)
            if grid.start is not None and grid.start.rest and grid.end is not None:
                origin = grid.end.base
            parameters[:, 2:4] = origin[:2]
            path = np.array([planar_motion(grid.command, k * grid.dt) for k in samples])
            parameters[:, 5] = origin[5] + path[:, 2]
            parameters[:, 4] += origin[5]
        compiled = kernel(("body", self.height, self.orientation, self.drift), 6, 6, self._instant)
        problem.add_term(self.name, compiled, trajectory.base, parameters)

    def _instant(self, v: Any, p: Any) -> Any:
        import casadi as ca

        drift = -ca.sin(p[4]) * (v[0] - p[2]) + ca.cos(p[4]) * (v[1] - p[3])
        tilt = ca.sumsqr(v[3:5]) + (v[5] - p[5]) ** 2
        return p[0] * (self.height * (v[2] - p[1]) ** 2 + self.orientation * tilt + self.drift * drift**2)
