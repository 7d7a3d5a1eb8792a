"""The body advances by at least a share of what was commanded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class Progress(Family):
    """(p_N − p_0) · u ≥ share · v T along the commanded direction u; without it a plan gives speed away."""

    name: ClassVar[str] = "progress"
    unit: ClassVar[str] = "m"
    enforced: ClassVar[str] = "between the ends of an open segment"
    share: float = 0.98

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One row; none in a gait, whose travel is exact, or at rest."""
        grid, command = trajectory.grid, trajectory.grid.command
        if grid.cyclic or command.speed <= 0.0:
            return
        goal = self.share * command.speed * grid.duration
        heading = command.heading + 0.5 * command.yaw_rate * grid.duration
        direction = [np.cos(heading), np.sin(heading)]
        row = problem.add_rows(self.name, goal, np.inf, (1, 1), self.unit, ["end"])
        ends = np.concatenate([trajectory.base[0, :2], trajectory.base[-1, :2]])
        problem.add_term(self.name, kernel("progress", 4, 2, _instant), ends, direction, row)


def _instant(v: Any, p: Any) -> Any:
    import casadi as ca

    return ca.dot(v[2:4] - v[:2], p)
