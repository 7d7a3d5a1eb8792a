"""Limbs stay above the ground with all but their feet."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.shins import LowPoint
from gaitforge.motion.trajectory import Trajectory
from gaitforge.robot.kinematics import limb_forward, parameter_size, rpy_rotation


@dataclass(frozen=True)
class LimbHeight(Family):
    """z + e_z · R (o_k + R_k p) ≥ radius + margin for points p on bodies that a limb's joints move.

    Added by refinement, where the dense check found a limb in the ground with something else than its foot: a leg
    that is bent the wrong way lies on its shin.  At ends that neighbours have fixed nothing is asked.
    """

    name: ClassVar[str] = "limb_height"
    unit: ClassVar[str] = "m"
    enforced: ClassVar[str] = "at samples, for points that refinement found in the ground"
    points: tuple[LowPoint, ...] = ()
    margin: float = 0.003
    """[m]"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One row a point and sample."""
        grid, robot = trajectory.grid, trajectory.robot
        free = np.arange(grid.samples)
        if grid.start is not None:
            free = free[1:]
        if grid.end is not None:
            free = free[:-1]
        for low in self.points:
            joints = trajectory.joints[low.limb][free]
            count = joints.shape[1]
            parameters = np.concatenate([trajectory.parameters[low.limb], low.point])
            build = partial(_height, count=count, joint=low.joint)
            compiled = kernel(("limb_height", count, low.joint), 3 + count, len(parameters), build)
            labels = [(robot.limbs[low.limb].name, int(k)) for k in free]
            rows = problem.add_rows(self.name, low.radius + self.margin, np.inf, (len(free), 1), self.unit, labels)
            variables = np.hstack([trajectory.base[free, 2:5], joints])
            problem.add_term(self.name, compiled, variables, parameters, rows)


def _height(v: Any, p: Any, count: int, joint: int) -> Any:
    """Of one point, with z, roll, pitch of the base and the limb's joints for variables."""
    import casadi as ca

    size = parameter_size(count)
    state = limb_forward(v[3 : 3 + count], p[:size])
    up = rpy_rotation(ca.vertcat(v[1:3], 0))[2, :]
    return v[0] + ca.dot(up.T, state.origins[joint] + state.turns[joint] @ p[size : size + 3])
