"""A robot that stands higher, so that limp limbs hang clear of the ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.failure.hanging import lowest_point
from gaitforge.motion.stance import reaching_joints
from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
SPARE_M = 0.035
"""[m] that a hanging limb is off the ground in the mean: the body sinks and tilts by as much while it walks"""
LIGHT_M = 0.045
"""[m] that may be missing of it: friction holds a limb that is bent at its joints, so that it touches lightly"""
STRIDE_M = 0.04
"""[m] that feet reach further out than where they stand in the mean"""
NEAREST = 0.45
"""Share of the nominal distance from a foot to its hip, below which a robot would stand too narrow"""
HALVINGS = 7
"""of the ranges in which heights and shares are looked for: 1 mm, and 0.5 % of the distance"""


def hanging_height(robot: RobotModel, postures: Mapping[str, Array]) -> float:
    """[m] of the level body at which limbs with these joints (n,) [rad] hang clear of the ground."""
    return max(SPARE_M - lowest_point(robot, robot.limb(name), joints) for name, joints in postures.items())


def raised(robot: RobotModel, postures: Mapping[str, Array]) -> RobotModel | None:
    """The robot with a nominal stance high enough for limbs that hang in `postures`, its feet as far out as they reach.

    Where its legs are too short for that, by `LIGHT_M` at most, it stands as high as they go; None where they are
    shorter still.
    """
    wanted, standing = hanging_height(robot, postures), robot.nominal.body_height
    if wanted <= standing:
        return robot
    height = min(wanted, highest_stance(robot))
    if height < max(standing, wanted - LIGHT_M):
        return None
    posture = _widest(robot, height)
    return replace(robot, nominal=replace(robot.nominal, posture=posture, body_height=height))


def touches(robot: RobotModel, postures: Mapping[str, Array]) -> bool:
    """Whether limbs that hang in `postures` may touch the ground while the robot walks in its nominal stance."""
    return robot.nominal.body_height < hanging_height(robot, postures) - 1e-9


def highest_stance(robot: RobotModel) -> float:
    """[m] of the body above the ground where the feet are as near as `NEAREST`, and reach `STRIDE_M` further out."""
    low, high = robot.nominal.body_height, 2.0 * robot.nominal.body_height
    if _drawn_in(robot, low, NEAREST) is None:
        return low
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _drawn_in(robot, middle, NEAREST) is None else (middle, high)
    return low


def _widest(robot: RobotModel, height: float) -> Array:
    """(n_J,) the stance at a height that can be had with the feet as far out as they reach."""
    near, far = NEAREST, 1.0
    posture = _drawn_in(robot, height, near)
    assert posture is not None  # the height is not above the highest
    for _ in range(HALVINGS):
        middle = 0.5 * (near + far)
        wider = _drawn_in(robot, height, middle)
        if wider is None:
            far = middle
        else:
            near, posture = middle, wider
    return posture


def _drawn_in(robot: RobotModel, height: float, share: float) -> Array | None:
    """(n_J,) feet at a share of their nominal distance from the hips; None: not within reach, `STRIDE_M` included."""
    joints = np.array(robot.nominal.posture, dtype=float)
    for limb in robot.limbs:
        rows, parameters = robot.joint_indices(limb), limb_parameters(robot, limb)
        pose = evaluate_limb(joints[None, rows], parameters)
        hip, foot = pose.origins[0, 0, :2], pose.foot[0, :2]
        away = foot - hip
        out = away / max(float(np.linalg.norm(away)), 1e-9)
        near = joints[rows]
        for further in (STRIDE_M, 0.0):  # the stance itself last: it is what is left in `near`
            goal = np.array([*(hip + share * away + further * out), limb.foot.radius - height])
            near = reaching_joints(robot, limb, goal, near)
            if np.linalg.norm(evaluate_limb(near[None], parameters).foot[0] - goal) > 1e-4:
                return None
        joints[rows] = near
    return joints
