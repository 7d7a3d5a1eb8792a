"""Standing for a load: the nominal footholds of the limbs that walk, moved under the centre of mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InfeasibleMotion
from gaitforge.footfall.margin import support_margins
from gaitforge.motion.manipulation.inverse import tip_joints
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
AMPLE = 0.03
"""[m] static margin without any one foot"""
SHARES = (1.0, 0.8, 0.6, 0.4, 0.2)
"""of the whole way, tried in this order: limbs reach only so far"""


def under_load(robot: RobotModel, walking: Sequence[str]) -> RobotModel:
    """The robot with `walking` limbs standing, in its nominal posture, around its centre of mass.

    All feet are moved along x by the same way; limbs that do not walk are where `held_posture` has them,
    and the robot's loads count.  What the motion optimiser pulls towards is then a stance that it can keep.
    A stance that is stable without any one of its feet stays as it is.
    """
    joints, base = robot.standing_on(walking), np.zeros(6)
    feet = robot.foot_positions(base, joints)
    indices = [robot.limb_names.index(name) for name in walking]
    if _margin_of_crawl(robot, base, joints, indices) >= AMPLE:
        return robot
    ahead = float(robot.center_of_mass(base, joints)[0] - feet[indices, 0].mean())
    for share in SHARES:
        try:
            posture = _moved(robot, indices, share * ahead)
        except InfeasibleMotion:
            continue
        return replace(robot, nominal=replace(robot.nominal, posture=posture))
    return robot


def _margin_of_crawl(robot: RobotModel, base: Array, joints: Array, indices: Sequence[int]) -> float:
    """[m] smallest margin of the centre of mass with any one of the feet lifted."""
    feet = np.tile(robot.foot_positions(base, joints)[None, :, :2], (len(indices), 1, 1))
    stance = np.zeros(feet.shape[:2], dtype=bool)
    stance[:, indices] = True
    stance[np.arange(len(indices)), indices] = False
    return float(support_margins(feet, stance, robot.center_of_mass(base, joints)[None, :2]).min())


def _moved(robot: RobotModel, indices: Sequence[int], ahead: float) -> Array:
    posture = np.array(robot.nominal.posture, dtype=float)
    feet = robot.foot_positions(np.zeros(6), posture)
    for i in indices:
        rows = robot.joint_indices(robot.limbs[i])
        place = feet[i] + np.array([ahead, 0.0, 0.0])
        posture[rows] = tip_joints(robot, robot.limbs[i], place[None], posture[rows])[0]
    return posture
