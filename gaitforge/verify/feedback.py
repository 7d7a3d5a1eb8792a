"""Tool limbs that look where they should from where the body is, and not from where it was planned to be."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.aim import aim_joints
from gaitforge.motion.timeline import Aim, Timeline, TimelineSamples
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import poses_of
from gaitforge.verify.pointing import aim_rows

Array = NDArray[np.float64]
STEPS = 4
"""Gauss–Newton steps of one correction: the body is some millimetres off, and quadratic convergence does the rest."""


class World(Protocol):
    """What is measured in a simulated world."""

    def link_pose(self, link: str) -> tuple[Array, Array]:
        """Rotation (3, 3) and origin (3,) of a link's frame now."""
        ...


class AimFeedback:
    """Joint positions row by row; those of aimed limbs are corrected by the measured pose `rate_hz` times a second.

    A correction holds until the next one.  0 Hz: everything is as planned.
    """

    def __init__(
        self, world: World, robot: RobotModel, timeline: Timeline, plan: TimelineSamples, rate_hz: float
    ) -> None:
        self._world, self._robot, self._plan = world, robot, plan
        self._aims = timeline.aims if rate_hz > 0.0 else ()
        self._active = [aim_rows(plan.times, aim.start, aim.end) for aim in self._aims]
        self._pause = 1.0 / rate_hz if rate_hz > 0.0 else np.inf
        self._due = 0.0
        self._offset = np.zeros(len(robot.joint_names))

    def positions(self, row: int) -> Array:
        """(n_J,) what is commanded in the step after `row` [rad]."""
        due = bool(self._aims) and self._plan.times[row] >= self._due - 1e-9
        self._due += self._pause if due else 0.0
        for aim, active in zip(self._aims, self._active, strict=True):
            if not active[row]:
                self._offset[self._robot.joint_indices(self._robot.limb(aim.limb))] = 0.0
            elif due:
                self._correct(aim, self._plan.joint_positions[row])
        return np.asarray(self._plan.joint_positions[row] + self._offset)

    def _correct(self, aim: Aim, planned: Array) -> None:
        robot, limb = self._robot, self._robot.limb(aim.limb)
        tool = next(tool for tool in robot.tools if tool.name == aim.tool)
        R, origin = self._world.link_pose(robot.base_link)
        base, rows = poses_of(origin[None], R[None]), robot.joint_indices(limb)
        aimed = aim_joints(robot, limb, tool, base, aim.target, planned[rows], iterations=STEPS)
        self._offset[rows] = aimed[0] - planned[rows]
