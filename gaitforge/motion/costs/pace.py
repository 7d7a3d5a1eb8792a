"""A body that goes at the speed that it is told, and not in waves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class Pace(Family):
    """∫ w |v − v_0|² dt over a gait's cycle, v and v_0 the base's actual and commanded velocity in the plane.

    In the frame that moves as commanded, in which a gait's samples are written, v − v_0 is the rate of change
    of x and y; between samples it is their difference.  Transitions and stands speed up and slow down: no term.
    """

    name: ClassVar[str] = "pace"
    unit: ClassVar[str] = "m²/s"
    enforced: ClassVar[str] = "between neighbouring samples of a gait"
    weight: float = 40.0
    """per (m/s)² s"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One place an interval."""
        grid = trajectory.grid
        if not grid.cyclic:
            return
        after = grid.neighbours(np.arange(grid.samples))[1]
        places = np.hstack([trajectory.base[:, :2], trajectory.base[after, :2]])
        parameters = np.full((grid.samples, 1), self.weight / grid.dt)  # |Δ/dt|² dt
        problem.add_term(self.name, kernel("pace", 4, 1, _instant), places, parameters)


def _instant(v: Any, p: Any) -> Any:
    import casadi as ca

    return p[0] * ca.sumsqr(v[2:] - v[:2])
