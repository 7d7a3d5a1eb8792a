"""A plan as the starting point of another solve: on a finer grid, or for a segment that is much like it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.trajectory import Discretisation, Guess, planar_motion
from gaitforge.robot.kinematics import feet_in_world
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
MakeGuess = Callable[[Discretisation], Guess]


def guess_like(
    robot: RobotModel, plan: MotionPlan, grid: Discretisation, otherwise: Guess, moving: tuple[int, ...]
) -> Guess:
    """Poses on the splines of `plan` at the same shares of its duration; limbs not in `moving` as in `otherwise`.

    The bounds of the problem stay about those of `otherwise`.
    """
    share = np.arange(grid.samples) / grid.intervals
    base, planned = plan.base_spline(share * plan.duration), plan.joint_spline(share * plan.duration)
    if grid.cyclic:
        base = _in_moving_frame(base, plan, share)
    joints = otherwise.joints.copy()
    for i in moving:
        rows = robot.joint_indices(robot.limbs[i])
        joints[:, rows] = planned[:, rows]
    return Guess(base, joints, feet_in_world(robot, base, joints), otherwise.centre)


def _in_moving_frame(base: Array, plan: MotionPlan, share: Array) -> Array:
    """Base poses in the segment's frame, in the frame that moves with the command."""
    moved = planar_motion(plan.command, share * plan.duration)
    c, s = np.cos(moved[:, 2]), np.sin(moved[:, 2])
    x, y = (base[:, :2] - moved[:, :2]).T
    out = base.copy()
    out[:, 0], out[:, 1] = c * x + s * y, -s * x + c * y
    out[:, 5] -= moved[:, 2]
    return out
