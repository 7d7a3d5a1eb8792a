"""A body at its commanded height and tilt, on its line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.instant import Instant, SampleCost
from gaitforge.motion.trajectory import Trajectory, planar_motion


@dataclass(frozen=True)
class Body(SampleCost):
    """∫ w_z (z − z_0)² + w_θ ((roll − roll_0)² + (pitch − pitch_0)² + (yaw − yaw_0)²) + w_y d² dt

    z_0, roll_0, pitch_0: the commanded stance; d: the distance from the commanded line.
    """

    name: ClassVar[str] = "body"
    unit: ClassVar[str] = "m² s, rad² s"
    height: float = 100.0
    """per m² s"""
    orientation: float = 20.0
    """per rad² s"""
    drift: float = 10.0
    """per m² s"""

    def parameters(self, trajectory: Trajectory, limb: int | None) -> NDArray[np.float64]:
        """(K, 7) z_0, roll_0, pitch_0, yaw_0, direction of the line, a point of it (x, y)."""
        grid = trajectory.grid
        out = np.zeros((grid.samples, 7))
        out[:, :3] = trajectory.stance.body
        out[:, 4] = grid.command.heading
        if not grid.cyclic:
            origin = grid.start.base if grid.start is not None else np.zeros(6)
            if grid.start is not None and grid.start.rest and grid.end is not None:
                origin = grid.end.base
            out[:, 5:] = origin[:2]
            out[:, 3] = origin[5] + planar_motion(grid.command, np.arange(grid.samples) * grid.dt)[:, 2]
            out[:, 4] += origin[5]
        return out

    def instant(self, at: Instant, p: Any) -> Any:
        """The density of the cost at one sample."""
        import casadi as ca

        base = at.base
        drift = -ca.sin(p[4]) * (base[0] - p[5]) + ca.cos(p[4]) * (base[1] - p[6])
        turned = ca.sumsqr(base[3:6] - p[1:4])
        return self.height * (base[2] - p[0]) ** 2 + self.orientation * turned + self.drift * drift**2
