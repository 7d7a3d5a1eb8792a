"""Joints that are stuck while their limb still stands on the ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class Locked(Family):
    """q = q_start for all joints of `limbs`: the foot bears load, and the limb is as rigid as the body."""

    name: ClassVar[str] = "locked"
    unit: ClassVar[str] = "rad"
    enforced: ClassVar[str] = "at samples after the first, for limbs that are on the ground at some time"
    limbs: tuple[str, ...] = ()

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One row a joint and sample."""
        start = trajectory.grid.start
        assert start is not None  # a limb is locked where it was
        for i in trajectory.moving:
            limb = trajectory.robot.limbs[i]
            if limb.name not in self.limbs:
                continue
            joints, rest = trajectory.joints[i][1:], start.joints[trajectory.robot.joint_indices(limb)]
            labels = [(limb.name, k + 1) for k in range(len(joints))]
            rows = problem.add_rows(self.name, rest, rest, joints.shape, self.unit, labels)
            count = joints.shape[1]
            problem.add_term(self.name, kernel(("locked", count), count, 0, _instant), joints, np.zeros(0), rows)


def _instant(v: Any, p: Any) -> Any:
    return v
