"""How near to the ground the limbs come with anything but their feet."""

from __future__ import annotations

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.bodies import BASE, bodies_of, limb_capsules, radii
from gaitforge.robot.kinematics import LimbPoses, evaluate_limbs
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
STANDING_M = 0.01
"""[m] what is lower than this in the nominal posture is part of the foot, or drawn too wide: nobody asks for more"""

_known: WeakKeyDictionary[RobotModel, NDArray[np.bool_]] = WeakKeyDictionary()


class LowPoint(NamedTuple):
    """An end of a capsule of a limb, and the lowest that its surface comes."""

    limb: int
    joint: int
    """whose body it is on"""
    point: tuple[float, float, float]
    """[m] in the frame of that body"""
    radius: float
    height: float
    """[m] above the ground, negative below it"""


def low_points(robot: RobotModel, poses: dict[int, LimbPoses], base: Array, below: float) -> tuple[LowPoint, ...]:
    """Ends of capsules of limbs that come lower than `below` [m] along base poses (n, 6), feet left out."""
    capsules, watched = limb_capsules(robot), _watched(robot)
    heights = _heights(robot, poses, base).min(axis=2)
    return tuple(
        LowPoint(c.limb, c.joint, (float(p[0]), float(p[1]), float(p[2])), c.radius, float(heights[end, i]))
        for end, i in np.argwhere(watched & (heights < below)).tolist()
        for c in (capsules[i],)
        for p in ((c.a, c.b)[end],)
    )


def _heights(robot: RobotModel, poses: dict[int, LimbPoses], base: Array) -> Array:
    """(2, C, n) [m] of the lowest points about both ends of every capsule; infinite for those of the base."""
    capsules, up = limb_capsules(robot), matrices(base[:, 3:6])[:, 2]
    heights = np.full((2, len(capsules), len(base)), np.inf)
    for limb, joint, members, points in bodies_of(capsules):
        if limb != BASE:
            pose = poses[limb]
            down = np.einsum("ni,nij->jn", up, pose.turns[:, joint])
            of_joint = base[:, 2] + np.einsum("ni,ni->n", up, pose.origins[:, joint])
            heights[:, members] = (of_joint + points @ down).reshape(-1, 2, len(base)).swapaxes(0, 1)
    return heights - radii(capsules)[:, None]


def _watched(robot: RobotModel) -> NDArray[np.bool_]:
    """(2, C) ends of capsules on limbs that are well above the ground where the robot stands."""
    if robot not in _known:
        level = np.array([[0.0, 0.0, robot.nominal.body_height, 0.0, 0.0, 0.0]])
        stands = _heights(robot, evaluate_limbs(robot, robot.nominal.posture[None]), level)[..., 0]
        _known[robot] = stands > STANDING_M
    return _known[robot]
