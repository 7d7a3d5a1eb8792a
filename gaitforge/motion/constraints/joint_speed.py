"""Joint speeds between samples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class JointSpeed(Family):
    """|q_{j+1} − q_j| ≤ share · q̇_max dt for the joints of `limbs` (all that move when None).

    Bounds the mean speed of an interval; the spline may be faster inside, which the dense check sees
    and `refine` answers with a smaller share.
    """

    name: ClassVar[str] = "joint_speed"
    unit: ClassVar[str] = "rad"
    enforced: ClassVar[str] = "as the mean over each interval"
    share: float = 0.8
    limbs: tuple[int, ...] | None = None

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One row a joint and interval."""
        grid, robot = trajectory.grid, trajectory.robot
        now = np.arange(grid.intervals)
        after = (now + 1) % grid.samples
        for i in trajectory.moving if self.limbs is None else self.limbs:
            joints = trajectory.joints[i]
            count = joints.shape[1]
            reach = self.share * robot.velocity[robot.joint_indices(robot.limbs[i])] * grid.dt
            labels = [(robot.limbs[i].name, int(k)) for k in now]
            rows = problem.add_rows(self.name, -reach, reach, (len(now), count), self.unit, labels)
            variables = np.hstack([joints[now], joints[after]])
            problem.add_term(self.name, kernel(("speed", count), 2 * count, 0, _instant), variables, np.zeros(0), rows)


def _instant(v: Any, p: Any) -> Any:
    half = v.shape[0] // 2
    return v[half:] - v[:half]
